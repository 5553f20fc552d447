/*
 * What the loops over programs share: the stack of what they are in the middle
 * of, and copies of few bytes.
 *
 * The stack is explicit, so that neither a long list nor deeply nested data of a
 * peer can exhaust the C stack.  The first frames need no allocation.
 */
#ifndef IPC_FORMAT_WALK_H
#define IPC_FORMAT_WALK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/byteorder.h"
#include "format/program.h"

/* Where to go on when a body has ended. */
struct frame {
    const struct op *op; /* the operation that entered the body */
    uint8_t *element;
    size_t left; /* elements, this one included; in the loop of a list: nodes so far */
    void *extra; /* the walker's own */
};

enum { N_FIRST_FRAMES = 16 };

struct frame_stack {
    struct frame *frames;
    size_t count;
    size_t capacity;
    struct frame first[N_FIRST_FRAMES];
};

static inline void frame_stack_init(struct frame_stack *stack)
{
    stack->frames = stack->first;
    stack->count = 0;
    stack->capacity = N_FIRST_FRAMES;
}

static inline void frame_stack_fini(struct frame_stack *stack)
{
    if (stack->frames != stack->first) {
        free(stack->frames);
    }
}

/* Makes room for one more frame: 0, ERR_DEPTH beyond LIMIT_DATA_DEPTH frames, ERR_MEMORY. */
int frame_stack_grow(struct frame_stack *stack);

static inline int frame_reserve(struct frame_stack *stack)
{
    return stack->count < stack->capacity ? 0 : frame_stack_grow(stack);
}

static inline int frame_push(struct frame_stack *stack, const struct op *op, uint8_t *element,
                             size_t left, void *extra)
{
    int error = frame_reserve(stack);
    if (error != 0) {
        return error;
    }
    stack->frames[stack->count++] =
        (struct frame){.op = op, .element = element, .left = left, .extra = extra};
    return 0;
}

/* Copies of few bytes without a call: as two that may overlap. */
static inline void copy_few(uint8_t *to, const uint8_t *from, size_t count)
{
    if (count > 64) {
        memcpy(to, from, count);
    } else if (count >= 32) {
        uint64_t a[4], b[4];
        memcpy(a, from, 32);
        memcpy(b, from + count - 32, 32);
        memcpy(to, a, 32);
        memcpy(to + count - 32, b, 32);
    } else if (count >= 16) {
        uint64_t a[2], b[2];
        memcpy(a, from, 16);
        memcpy(b, from + count - 16, 16);
        memcpy(to, a, 16);
        memcpy(to + count - 16, b, 16);
    } else if (count >= 8) {
        uint64_t a, b;
        memcpy(&a, from, 8);
        memcpy(&b, from + count - 8, 8);
        memcpy(to, &a, 8);
        memcpy(to + count - 8, &b, 8);
    } else if (count >= 4) {
        uint32_t a, b;
        memcpy(&a, from, 4);
        memcpy(&b, from + count - 4, 4);
        memcpy(to, &a, 4);
        memcpy(to + count - 4, &b, 4);
    } else if (count > 0) {
        uint8_t a = from[0], b = from[count / 2], c = from[count - 1];
        to[0] = a;
        to[count / 2] = b;
        to[count - 1] = c;
    }
}

/* Zeroes a small struct without a call. */
static inline void clear_few(uint8_t *at, size_t count)
{
    const uint64_t zero[4] = {0, 0, 0, 0};
    if (count > 64) {
        memset(at, 0, count);
    } else if (count >= 32) {
        memcpy(at, zero, 32);
        memcpy(at + count - 32, zero, 32);
    } else if (count >= 16) {
        memcpy(at, zero, 16);
        memcpy(at + count - 16, zero, 16);
    } else if (count >= 8) {
        memcpy(at, zero, 8);
        memcpy(at + count - 8, zero, 8);
    } else if (count >= 4) {
        memcpy(at, zero, 4);
        memcpy(at + count - 4, zero, 4);
    } else {
        for (size_t i = 0; i < count; i++) {
            at[i] = 0;
        }
    }
}

/* Copies numbers of unit bytes, reversing each. */
void copy_swapped(uint8_t *to, const uint8_t *from, size_t n_numbers, unsigned unit);

static inline uint8_t *pointer_load(const uint8_t *at)
{
    void *pointer;
    memcpy(&pointer, at, sizeof pointer);
    return pointer;
}

static inline void pointer_store(uint8_t *at, const void *pointer)
{
    memcpy(at, &pointer, sizeof pointer);
}

/* An enumeration of size bytes in memory. */
uint32_t enumeration_load(const uint8_t *at, unsigned size);
void enumeration_store(uint8_t *at, unsigned size, uint32_t value);

static inline uint32_t count_load(const uint8_t *at, bool swap)
{
    uint32_t count;
    memcpy(&count, at, sizeof count);
    return swap ? swap32(count) : count;
}

static inline void count_store(uint8_t *at, uint32_t count, bool swap)
{
    if (swap) {
        count = swap32(count);
    }
    memcpy(at, &count, sizeof count);
}

#endif
