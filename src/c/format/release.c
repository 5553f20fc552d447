/*
 * Releasing: everything that a value points to, by the program that visits only
 * what is allocated.
 *
 * A block is freed when its body has ended; the pointer to it is set to NULL
 * before, so a value that is released twice is released once.
 */
#include "format/release.h"

#include <stdlib.h>

#include "format/handle.h"

struct releaser {
    const struct program *program;
    struct frame_stack *stack;
    const uint32_t *counts; /* of the next array; NULL: dimensions are to be trusted */
    int error;              /* the first one; the rest is released all the same */
};

/* Takes the pointer at a place and leaves NULL there. */
static uint8_t *take(uint8_t *at)
{
    uint8_t *block = pointer_load(at);
    pointer_store(at, NULL);
    return block;
}

static void release_format(uint8_t *at)
{
    void *format = take(at);
    format_unref(format);
}

static void release_reference(uint8_t *at)
{
    void *block = take(at);
    struct format_reference *reference = block;
    if (reference != NULL) {
        free(reference->name);
    }
    free(reference);
}

/* Takes an array and its number of elements; NULL if there is nothing to visit. */
static uint8_t *take_array(struct releaser *r, const struct op *op, uint8_t *element, size_t *left)
{
    uint32_t count;
    if (pointer_load(element + op->offset) == NULL) {
        return NULL;
    }
    int error = 0;
    if (r->counts != NULL) {
        count = *r->counts++;
    } else {
        error = program_count(r->program, op, element, &count);
    }
    if (error != 0) {
        r->error = r->error != 0 ? r->error : error;
        return NULL;
    }
    *left = count;
    uint8_t *block = take(element + op->offset);
    if (count > 0) {
        return block;
    }
    free(block);
    return NULL;
}

static void walk(struct releaser *r, uint8_t *element)
{
    const struct op *const ops = r->program->ops;
    const struct op *op = ops;
    size_t left = 1;
    void *owned = NULL; /* the block that the elements stand in */
    for (;;) {
        uint8_t *target = NULL;
        size_t n_targets = 1;
        void *target_block = NULL;
        switch ((enum opcode)op->code) {
        case OP_STRING:
        case OP_BLOCK:
            free(take(element + op->offset));
            break;
        case OP_FORMAT:
            release_format(element + op->offset);
            break;
        case OP_REFERENCE:
            release_reference(element + op->offset);
            break;
        case OP_POINTER:
            target = take(element + op->offset);
            target_block = target;
            break;
        case OP_ARRAY:
            target = take_array(r, op, element, &n_targets);
            target_block = target;
            break;
        case OP_LOOP:
        case OP_CALL:
            target = element + op->offset;
            n_targets = op->code == OP_LOOP ? op->length : 1;
            break;
        case OP_COPY:
        case OP_COPY_4:
        case OP_COPY_8:
        case OP_SWAP:
        case OP_ENUMERATION:
        case OP_CHECK:
            break; /* not in this program */
        case OP_NEXT:
            target = take(element + op->offset);
            if (target != NULL) {
                free(owned);
                owned = target;
                element = target;
                op -= op->body;
                continue;
            }
            /* fall through */
        case OP_END:
            if (--left > 0) {
                element += op->size;
                op -= op->body;
                continue;
            }
            free(owned);
            if (r->stack->count == 0) {
                return;
            }
            const struct frame *frame = &r->stack->frames[--r->stack->count];
            op = frame->op + 1;
            element = frame->element;
            left = frame->left;
            owned = frame->extra;
            continue;
        }
        if (target == NULL) {
            op++;
            continue;
        }
        int error = frame_push(r->stack, op, element, left, owned);
        if (error != 0) {
            r->error = error;
            return;
        }
        op = ops + op->body;
        element = target;
        left = n_targets;
        owned = target_block;
    }
}

void release_partial(const struct format *format, void *value, const struct counts *arrays,
                     struct frame_stack *stack)
{
    struct releaser releaser = {
        .program = &format->programs[PROGRAM_OWNED], .stack = stack, .counts = arrays->items};
    stack->count = 0;
    walk(&releaser, value);
}

int format_release(const struct format *format, void *value)
{
    int error = format_check(format, value);
    if (error != 0) {
        return error < 0 ? error : 0;
    }
    if (format->type->flat) {
        return 0;
    }
    struct frame_stack stack;
    frame_stack_init(&stack);
    struct releaser releaser = {.program = &format->programs[PROGRAM_OWNED], .stack = &stack};
    walk(&releaser, value);
    frame_stack_fini(&stack);
    return releaser.error;
}
