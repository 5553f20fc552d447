/*
 * The slow paths of what the loops over programs share.
 */
#include "format/walk.h"

#include <stdlib.h>

#include "base/limits.h"

int frame_stack_grow(struct frame_stack *stack)
{
    if (stack->capacity >= LIMIT_DATA_DEPTH) {
        return ERR_DEPTH;
    }
    size_t capacity = stack->capacity * 4;
    if (capacity > LIMIT_DATA_DEPTH) {
        capacity = LIMIT_DATA_DEPTH;
    }
    struct frame *old = stack->frames == stack->first ? NULL : stack->frames;
    struct frame *frames = realloc(old, capacity * sizeof *frames);
    if (frames == NULL) {
        return ERR_MEMORY;
    }
    if (old == NULL) {
        memcpy(frames, stack->first, sizeof stack->first);
    }
    stack->frames = frames;
    stack->capacity = capacity;
    return 0;
}

static void copy_swapped_2(uint8_t *to, const uint8_t *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint16_t number;
        memcpy(&number, from + i * sizeof number, sizeof number);
        number = swap16(number);
        memcpy(to + i * sizeof number, &number, sizeof number);
    }
}

static void copy_swapped_4(uint8_t *to, const uint8_t *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t number;
        memcpy(&number, from + i * sizeof number, sizeof number);
        number = swap32(number);
        memcpy(to + i * sizeof number, &number, sizeof number);
    }
}

static void copy_swapped_8(uint8_t *to, const uint8_t *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t number;
        memcpy(&number, from + i * sizeof number, sizeof number);
        number = swap64(number);
        memcpy(to + i * sizeof number, &number, sizeof number);
    }
}

void copy_swapped(uint8_t *to, const uint8_t *from, size_t n_numbers, unsigned unit)
{
    switch (unit) {
    case 2:
        copy_swapped_2(to, from, n_numbers);
        break;
    case 4:
        copy_swapped_4(to, from, n_numbers);
        break;
    case 8:
        copy_swapped_8(to, from, n_numbers);
        break;
    default:
        if (n_numbers > 0) {
            memcpy(to, from, n_numbers);
        }
    }
}

uint32_t enumeration_load(const uint8_t *at, unsigned size)
{
    uint16_t two;
    uint32_t four;
    switch (size) {
    case 1:
        return at[0];
    case 2:
        memcpy(&two, at, sizeof two);
        return two;
    default:
        memcpy(&four, at, sizeof four);
        return four;
    }
}

void enumeration_store(uint8_t *at, unsigned size, uint32_t value)
{
    uint16_t two = (uint16_t)value;
    switch (size) {
    case 1:
        at[0] = (uint8_t)value;
        break;
    case 2:
        memcpy(at, &two, sizeof two);
        break;
    default:
        memcpy(at, &value, sizeof value);
    }
}
