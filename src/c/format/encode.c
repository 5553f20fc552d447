/*
 * Encoding: from a value in memory to bytes on the wire.
 *
 * One pass writes in place at the end of a buffer.  Room is asked for as it is
 * needed, so that a string is measured once and large arrays are copied once;
 * the ends of the room stay in registers.
 */
#include "format/format.h"

#include "format/binary.h"
#include "format/handle.h"
#include "format/walk.h"

enum { FILLER = 0x5a };

/* Where to write next, and the end of the room; at is NULL after a failure. */
struct room {
    uint8_t *at;
    uint8_t *end;
};

struct encoder {
    const struct program *program;
    struct buffer *out;
    size_t start; /* length of the buffer before */
    bool swap;
    int error; /* why there is no room */
    struct frame_stack stack;
};

static struct room fail(struct encoder *e, int error)
{
    e->error = error;
    return (struct room){NULL, NULL};
}

/* Room for count more bytes, and some to spare as long as the content is small. */
static struct room grow(struct encoder *e, struct room room, uint64_t count)
{
    const size_t written = (size_t)(room.at - e->out->bytes);
    const size_t spare = written - e->start < 64 * 1024 ? 3 * (written - e->start) + 128 : 0;
    e->out->length = written;
    if (written - e->start + count > INT32_MAX) {
        return fail(e, ERR_LIMIT);
    }
    if (buffer_reserve(e->out, (size_t)count + spare) != 0) {
        return fail(e, ERR_MEMORY);
    }
    return (struct room){e->out->bytes + written, e->out->bytes + e->out->capacity};
}

static inline struct room need(struct encoder *e, struct room room, uint64_t count)
{
    return (uint64_t)(room.end - room.at) >= count ? room : grow(e, room, count);
}

static inline struct room write_string(struct encoder *e, struct room room, const char *text)
{
    const size_t length = text == NULL ? 0 : strlen(text);
    room = need(e, room, (uint64_t)length + 5);
    if (room.at == NULL) {
        return room;
    }
    count_store(room.at, (uint32_t)length, e->swap);
    if (length == 0) {
        room.at[4] = FILLER;
        room.at += 5;
    } else {
        copy_few(room.at + 4, (const uint8_t *)text, length);
        room.at += 4 + length;
    }
    return room;
}

static struct room write_format(struct encoder *e, struct room room, const struct format *format)
{
    room = need(e, room, binary_measure(format));
    if (room.at != NULL) {
        room.at = binary_encode(format, room.at, e->swap);
    }
    return room;
}

static struct room write_reference(struct encoder *e, struct room room,
                                   const struct format_reference *reference)
{
    if (reference == NULL) {
        return fail(e, ERR_NULL);
    }
    room = need(e, room, 4);
    if (room.at == NULL) {
        return room;
    }
    count_store(room.at, (uint32_t)reference->number, e->swap);
    room.at += 4;
    return write_string(e, room, reference->name);
}

/* The count of an array, and room for the least that its elements need. */
static inline struct room write_count(struct encoder *e, struct room room, const struct op *op,
                                      const uint8_t *element, uint32_t *count)
{
    int error = program_count(e->program, op, element, count);
    if (error == 0 && *count > 0 && pointer_load(element + op->offset) == NULL) {
        error = ERR_NULL;
    }
    if (error != 0) {
        return fail(e, error);
    }
    room = need(e, room, 4 + (uint64_t)*count * op->least);
    if (room.at == NULL) {
        return room;
    }
    count_store(room.at, *count, e->swap);
    room.at += 4;
    return room;
}

static inline struct room write_block(struct encoder *e, struct room room, const struct op *op,
                                      const uint8_t *element)
{
    uint32_t count;
    room = write_count(e, room, op, element, &count);
    if (room.at == NULL || count == 0) {
        return room;
    }
    const size_t size = (size_t)count * op->size;
    const uint8_t *from = pointer_load(element + op->offset);
    if (op->unit == 1) {
        copy_few(room.at, from, size);
    } else {
        copy_swapped(room.at, from, size / op->unit, op->unit);
    }
    room.at += size;
    return room;
}

/* The flag byte of a pointer. */
static inline struct room write_flag(struct encoder *e, struct room room, const void *target)
{
    room = need(e, room, 1);
    if (room.at != NULL) {
        *room.at++ = target == NULL ? 0 : FILLER;
    }
    return room;
}

/* Writes the value at element and returns the end of what was written. */
static struct room walk(struct encoder *e, struct room room, uint8_t *element)
{
    const struct op *const ops = e->program->ops;
    const struct op *op = ops;
    size_t left = 1;
    void *marker = element; /* a node of the list that is being followed */
    for (;;) {
        uint8_t *target = NULL; /* what a body is to work on next */
        size_t n_targets = 1;
        switch ((enum opcode)op->code) {
        case OP_COPY:
            room = need(e, room, op->length);
            if (room.at == NULL) {
                return room;
            }
            copy_few(room.at, element + op->offset, op->length);
            room.at += op->length;
            op++;
            continue;
        case OP_COPY_4:
            room = need(e, room, 4);
            if (room.at == NULL) {
                return room;
            }
            memcpy(room.at, element + op->offset, 4);
            room.at += 4;
            op++;
            continue;
        case OP_COPY_8:
            room = need(e, room, 8);
            if (room.at == NULL) {
                return room;
            }
            memcpy(room.at, element + op->offset, 8);
            room.at += 8;
            op++;
            continue;
        case OP_SWAP:
            room = need(e, room, (uint64_t)op->length * op->unit);
            if (room.at == NULL) {
                return room;
            }
            copy_swapped(room.at, element + op->offset, op->length, op->unit);
            room.at += (size_t)op->length * op->unit;
            op++;
            continue;
        case OP_ENUMERATION:
            room = need(e, room, 4);
            if (room.at == NULL) {
                return room;
            }
            count_store(room.at, enumeration_load(element + op->offset, op->unit), e->swap);
            room.at += 4;
            op++;
            continue;
        case OP_STRING:
            room = write_string(e, room, (const char *)pointer_load(element + op->offset));
            break;
        case OP_FORMAT:
            room = write_format(e, room, (const void *)pointer_load(element + op->offset));
            break;
        case OP_REFERENCE:
            room = write_reference(e, room, (const void *)pointer_load(element + op->offset));
            break;
        case OP_POINTER:
            target = pointer_load(element + op->offset);
            room = write_flag(e, room, target);
            break;
        case OP_BLOCK:
            room = write_block(e, room, op, element);
            break;
        case OP_ARRAY: {
            uint32_t count;
            room = write_count(e, room, op, element, &count);
            if (room.at != NULL && count > 0) {
                target = pointer_load(element + op->offset);
            }
            n_targets = count;
            break;
        }
        case OP_LOOP:
            target = element + op->offset;
            n_targets = op->length;
            break;
        case OP_CALL:
            target = element + op->offset;
            break;
        case OP_CHECK:
            break;
        case OP_NEXT:
            target = pointer_load(element + op->offset);
            room = write_flag(e, room, target);
            if (room.at == NULL) {
                return room;
            }
            if (target != NULL) {
                if (target == marker) {
                    return fail(e, ERR_DEPTH); /* a list that bites its tail */
                }
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
        case OP_END: {
            if (--left > 0) {
                element += op->size;
                op -= op->body;
                continue;
            }
            if (e->stack.count == 0) {
                return room;
            }
            const struct frame *frame = &e->stack.frames[--e->stack.count];
            op = frame->op + 1;
            element = frame->element;
            left = frame->left;
            marker = frame->extra;
            continue;
        }
        }
        if (room.at == NULL) {
            return room;
        }
        if (target == NULL) {
            op++;
            continue;
        }
        int error = frame_push(&e->stack, op, element, left, marker);
        if (error != 0) {
            return fail(e, error);
        }
        op = ops + op->body;
        element = target;
        left = n_targets;
        marker = target;
    }
}

int format_encode(const struct format *format, const void *value, enum byte_order order,
                  struct buffer *out)
{
    int error = format_check(format, value);
    if (error != 0) {
        return error < 0 ? error : 0;
    }
    const struct type *type = format->type;
    const bool swap = order != byte_order_of_host();
    if (out->capacity - out->length < type->wire_least &&
        buffer_reserve(out, type->wire_least) != 0) {
        return ERR_MEMORY;
    }
    if (type->simple && !swap) {
        copy_few(out->bytes + out->length, value, type->size);
        out->length += type->size;
        return 0;
    }
    struct encoder encoder;
    encoder.program = format_program(format, order);
    encoder.out = out;
    encoder.start = out->length;
    encoder.swap = swap;
    encoder.error = 0;
    frame_stack_init(&encoder.stack);
    struct room room = {out->bytes + out->length, out->bytes + out->capacity};
    room = walk(&encoder, room, (uint8_t *)(uintptr_t)value); /* only read */
    frame_stack_fini(&encoder.stack);
    if (room.at != NULL && (size_t)(room.at - out->bytes) - encoder.start > INT32_MAX) {
        room.at = NULL;
        encoder.error = ERR_LIMIT;
    }
    out->length = room.at == NULL ? encoder.start : (size_t)(room.at - out->bytes);
    return room.at == NULL ? encoder.error : 0;
}
