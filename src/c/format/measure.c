/*
 * Measuring: how many bytes a value has on the wire.
 */
#include "format/format.h"

#include <string.h>

#include "format/binary.h"
#include "format/handle.h"
#include "format/walk.h"

struct measurer {
    const struct program *program;
    uint64_t length;
    struct frame_stack stack;
};

static int add(struct measurer *m, uint64_t length)
{
    m->length += length;
    return m->length > INT32_MAX ? ERR_LIMIT : 0;
}

static int add_string(struct measurer *m, const uint8_t *at)
{
    const char *text = (const char *)pointer_load(at);
    return add(m, 4 + (text == NULL || *text == '\0' ? 1 : (uint64_t)strlen(text)));
}

static int add_format(struct measurer *m, const uint8_t *at)
{
    const void *format = pointer_load(at);
    return add(m, binary_measure(format));
}

static int add_reference(struct measurer *m, const uint8_t *at)
{
    const void *target = pointer_load(at);
    if (target == NULL) {
        return ERR_NULL;
    }
    const struct format_reference *reference = target;
    const uint8_t *name = (const uint8_t *)&reference->name;
    int error = add(m, 4);
    return error != 0 ? error : add_string(m, name);
}

/* The count and the elements of an array that need no visit. */
static int add_array(struct measurer *m, const struct op *op, const uint8_t *element,
                     uint32_t *count)
{
    int error = program_count(m->program, op, element, count);
    if (error != 0) {
        return error;
    }
    if (*count > 0 && pointer_load(element + op->offset) == NULL) {
        return ERR_NULL;
    }
    return add(m, 4 + (op->flat ? (uint64_t)*count * op->least : 0));
}

static int walk(struct measurer *m, uint8_t *element)
{
    const struct op *const ops = m->program->ops;
    const struct op *op = ops;
    size_t left = 1;
    void *marker = element; /* a node of the list that is being followed */
    for (;;) {
        uint8_t *target = NULL;
        size_t n_targets = 1;
        uint32_t count;
        int error = 0;
        switch ((enum opcode)op->code) {
        case OP_COPY:
        case OP_COPY_4:
        case OP_COPY_8:
            error = add(m, op->length);
            break;
        case OP_SWAP:
            error = add(m, (uint64_t)op->length * op->unit);
            break;
        case OP_ENUMERATION:
            error = add(m, 4);
            break;
        case OP_STRING:
            error = add_string(m, element + op->offset);
            break;
        case OP_FORMAT:
            error = add_format(m, element + op->offset);
            break;
        case OP_REFERENCE:
            error = add_reference(m, element + op->offset);
            break;
        case OP_POINTER:
            error = add(m, 1);
            target = pointer_load(element + op->offset);
            break;
        case OP_BLOCK:
            error = add_array(m, op, element, &count);
            break;
        case OP_ARRAY:
            error = add_array(m, op, element, &count);
            if (error == 0 && count > 0 && !op->flat) {
                target = pointer_load(element + op->offset);
                n_targets = count;
            }
            break;
        case OP_LOOP:
        case OP_CALL:
            target = element + op->offset;
            n_targets = op->code == OP_LOOP ? op->length : 1;
            break;
        case OP_CHECK:
            break;
        case OP_NEXT:
            error = add(m, 1);
            target = pointer_load(element + op->offset);
            if (error != 0 || target == marker) {
                return error != 0 ? error : ERR_DEPTH;
            }
            if (target != NULL) {
                left++;
                if ((left & (left - 1)) == 0) {
                    marker = target;
                }
                element = target;
                op -= op->body;
                continue;
            }
            left = 1;
            /* fall through */
        case OP_END:
            if (--left > 0) {
                element += op->size;
                op -= op->body;
                continue;
            }
            if (m->stack.count == 0) {
                return 0;
            }
            const struct frame *frame = &m->stack.frames[--m->stack.count];
            op = frame->op + 1;
            element = frame->element;
            left = frame->left;
            marker = frame->extra;
            continue;
        }
        if (error == 0 && target != NULL) {
            error = frame_push(&m->stack, op, element, left, marker);
        }
        if (error != 0) {
            return error;
        }
        if (target != NULL) {
            op = ops + op->body;
            element = target;
            left = n_targets;
            marker = target;
        } else {
            op++;
        }
    }
}

int format_measure(const struct format *format, const void *value, size_t *length)
{
    *length = 0;
    int error = format_check(format, value);
    if (error != 0) {
        return error < 0 ? error : 0;
    }
    if (format->type->flat) {
        *length = format->type->wire_least;
        return 0;
    }
    struct measurer measurer;
    measurer.program = &format->programs[PROGRAM_NATIVE];
    measurer.length = 0;
    frame_stack_init(&measurer.stack);
    error = walk(&measurer, (uint8_t *)(uintptr_t)value); /* only read */
    frame_stack_fini(&measurer.stack);
    if (error == 0) {
        *length = (size_t)measurer.length;
    }
    return error;
}
