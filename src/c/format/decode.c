/*
 * Decoding: from bytes on the wire to a value in memory.
 *
 * Every read is checked against the end of the bytes, every count against what
 * the bytes can hold, before anything is read or allocated.  The length of an
 * array is compared with its dimensions as soon as these are there: at once, or
 * at the end of the structure when some follow the array.
 *
 * What is not overwritten in any case is zeroed before, so that padding is zero
 * and a failure at any point leaves a value that can be released.
 */
#include "format/format.h"

#include <stdlib.h>

#include "format/binary.h"
#include "format/counts.h"
#include "format/handle.h"
#include "format/release.h"
#include "format/walk.h"

struct decoder {
    const struct program *program;
    uintptr_t limit; /* address behind the last byte; UINTPTR_MAX if unknown */
    bool swap;
    struct frame_stack stack;
    struct counts arrays;    /* lengths of the arrays that may hold pointers, in order */
    struct counts unchecked; /* lengths of arrays whose dimensions are still to come */
};

static inline size_t rest(const struct decoder *d, const uint8_t *at)
{
    return (size_t)(d->limit - (uintptr_t)at);
}

static void *allocate_zeroed(size_t size)
{
    if (size > 64) {
        return calloc(1, size);
    }
    void *block = malloc(size > 0 ? size : 1);
    if (block != NULL) {
        clear_few(block, size);
    }
    return block;
}

static inline int read_string(const struct decoder *d, const uint8_t **at, uint8_t *to)
{
    if (rest(d, *at) < 5) {
        return ERR_CONTENT; /* even an empty one has a filler byte */
    }
    const uint32_t length = count_load(*at, d->swap);
    if (length == 0 && !format_keeps_empty_strings()) {
        *at += 5;
        return 0;
    }
    if (length > INT32_MAX || length > rest(d, *at) - 4) {
        return ERR_CONTENT;
    }
    uint8_t *text = malloc((size_t)length + 1);
    if (text == NULL) {
        return ERR_MEMORY;
    }
    copy_few(text, *at + 4, length);
    text[length] = '\0';
    pointer_store(to, text);
    *at += length == 0 ? 5 : 4 + (size_t)length;
    return 0;
}

static int read_format(const struct decoder *d, const uint8_t **at, uint8_t *to)
{
    struct binary_source source = {.at = *at, .limit = d->limit, .swap = d->swap};
    struct format *format;
    int error = binary_decode(&source, &format);
    if (error == 0) {
        pointer_store(to, format);
        *at = source.at;
    }
    return error;
}

static int read_reference(const struct decoder *d, const uint8_t **at, uint8_t *to)
{
    if (rest(d, *at) < 4) {
        return ERR_CONTENT;
    }
    struct format_reference *reference = allocate_zeroed(sizeof *reference);
    if (reference == NULL) {
        return ERR_MEMORY;
    }
    pointer_store(to, reference);
    reference->number = (int)count_load(*at, d->swap);
    *at += 4;
    uint8_t *name = (uint8_t *)&reference->name;
    return read_string(d, at, name);
}

/* The count of an array, checked in every way that is possible now. */
static inline int read_count(struct decoder *d, const uint8_t **at, const struct op *op,
                             const uint8_t *element, uint32_t *count)
{
    if (rest(d, *at) < 4) {
        return ERR_CONTENT;
    }
    *count = count_load(*at, d->swap);
    *at += 4;
    if (*count > INT32_MAX || (uint64_t)*count * op->least > rest(d, *at) ||
        (uint64_t)*count * op->size > INT32_MAX) {
        return ERR_CONTENT;
    }
    if (op->dimensions_follow) {
        int error = counts_reserve(&d->unchecked);
        if (error == 0) {
            counts_push(&d->unchecked, *count);
        }
        return error;
    }
    uint32_t expected;
    if (program_count(d->program, op, element, &expected) != 0 || expected != *count) {
        return ERR_CONTENT;
    }
    return 0;
}

/* A block for the elements of an array, stored in its field and remembered. */
static int allocate_elements(struct decoder *d, const struct op *op, uint8_t *element,
                             uint32_t count, uint8_t **block)
{
    int error = op->flat ? 0 : counts_reserve(&d->arrays);
    if (error != 0) {
        return error;
    }
    *block = allocate_zeroed((size_t)count * op->size);
    if (*block == NULL) {
        return ERR_MEMORY;
    }
    pointer_store(element + op->offset, *block);
    if (!op->flat) {
        counts_push(&d->arrays, count);
    }
    return 0;
}

static inline int read_block(struct decoder *d, const uint8_t **at, const struct op *op,
                             uint8_t *element)
{
    uint32_t count;
    int error = read_count(d, at, op, element, &count);
    if (error != 0 || count == 0) {
        return error;
    }
    const size_t size = (size_t)count * op->size;
    uint8_t *block = malloc(size > 0 ? size : 1);
    if (block == NULL) {
        return ERR_MEMORY;
    }
    pointer_store(element + op->offset, block);
    if (op->unit == 1) {
        copy_few(block, *at, size);
    } else {
        copy_swapped(block, *at, size / op->unit, op->unit);
    }
    *at += size;
    return 0;
}

static inline int read_array(struct decoder *d, const uint8_t **at, const struct op *op,
                             uint8_t *element, uint8_t **block, size_t *n_elements)
{
    uint32_t count;
    int error = read_count(d, at, op, element, &count);
    if (error != 0 || count == 0) {
        return error;
    }
    *n_elements = count;
    return allocate_elements(d, op, element, count, block);
}

/* The target of a pointer: its flag byte, and a block for it unless it is NULL. */
static inline int read_pointer(const struct decoder *d, const uint8_t **at, const struct op *op,
                               uint8_t *element, uint8_t **target)
{
    if (rest(d, *at) < 1) {
        return ERR_CONTENT;
    }
    if (*(*at)++ == 0) {
        return 0;
    }
    if (op->least > rest(d, *at)) {
        return ERR_CONTENT;
    }
    *target = allocate_zeroed(op->size);
    if (*target == NULL) {
        return ERR_MEMORY;
    }
    pointer_store(element + op->offset, *target);
    return 0;
}

static int check_count(struct decoder *d, const struct op *op, const uint8_t *element)
{
    const uint32_t count = d->unchecked.items[--d->unchecked.length];
    uint32_t expected;
    if (program_count(d->program, op, element, &expected) != 0 || expected != count) {
        return ERR_CONTENT;
    }
    return 0;
}

/* Decodes into the zeroed value at element and moves *start behind what was read. */
static int walk(struct decoder *d, const uint8_t **start, uint8_t *element)
{
    const struct op *const ops = d->program->ops;
    const struct op *op = ops;
    const uint8_t *at = *start;
    size_t left = 1;
    for (;;) {
        uint8_t *target = NULL; /* what a body is to work on next */
        size_t n_targets = 1;
        int error = 0;
        switch ((enum opcode)op->code) {
        case OP_COPY:
            if (rest(d, at) < op->length) {
                return ERR_CONTENT;
            }
            copy_few(element + op->offset, at, op->length);
            at += op->length;
            op++;
            continue;
        case OP_COPY_4:
            if (rest(d, at) < 4) {
                return ERR_CONTENT;
            }
            memcpy(element + op->offset, at, 4);
            at += 4;
            op++;
            continue;
        case OP_COPY_8:
            if (rest(d, at) < 8) {
                return ERR_CONTENT;
            }
            memcpy(element + op->offset, at, 8);
            at += 8;
            op++;
            continue;
        case OP_SWAP:
            if (rest(d, at) / op->unit < op->length) {
                return ERR_CONTENT;
            }
            copy_swapped(element + op->offset, at, op->length, op->unit);
            at += (size_t)op->length * op->unit;
            op++;
            continue;
        case OP_ENUMERATION:
            if (rest(d, at) < 4) {
                return ERR_CONTENT;
            }
            enumeration_store(element + op->offset, op->unit, count_load(at, d->swap));
            at += 4;
            op++;
            continue;
        case OP_STRING:
            error = read_string(d, &at, element + op->offset);
            break;
        case OP_FORMAT:
        case OP_REFERENCE: {
            const uint8_t *moved = at; /* so that at itself can stay in a register */
            error = op->code == OP_FORMAT ? read_format(d, &moved, element + op->offset)
                                          : read_reference(d, &moved, element + op->offset);
            at = moved;
            break;
        }
        case OP_POINTER:
            error = frame_reserve(&d->stack);
            if (error == 0) {
                error = read_pointer(d, &at, op, element, &target);
            }
            break;
        case OP_BLOCK:
            error = read_block(d, &at, op, element);
            break;
        case OP_ARRAY:
            error = frame_reserve(&d->stack);
            if (error == 0) {
                error = read_array(d, &at, op, element, &target, &n_targets);
            }
            break;
        case OP_LOOP:
        case OP_CALL:
            target = element + op->offset;
            n_targets = op->code == OP_LOOP ? op->length : 1;
            break;
        case OP_CHECK:
            error = check_count(d, op, element);
            break;
        case OP_NEXT:
            error = read_pointer(d, &at, op, element, &target);
            if (error != 0) {
                return error;
            }
            if (target != NULL) {
                element = target;
                op -= op->body;
                continue;
            }
            /* fall through */
        case OP_END: {
            if (--left > 0) {
                element += op->size;
                op -= op->body;
                continue;
            }
            if (d->stack.count == 0) {
                *start = at;
                return 0;
            }
            const struct frame *frame = &d->stack.frames[--d->stack.count];
            op = frame->op + 1;
            element = frame->element;
            left = frame->left;
            continue;
        }
        }
        if (error == 0 && target == NULL) {
            op++;
            continue;
        }
        /* Memory was allocated only when there was a frame: releasing needs as many. */
        if (error == 0) {
            error = frame_push(&d->stack, op, element, left, NULL);
        }
        if (error != 0) {
            return error;
        }
        op = ops + op->body;
        element = target;
        left = n_targets;
    }
}

/* Decodes by the program; on failure nothing stays allocated and value is all zero. */
static int decode(const struct format *format, const struct format_source *source, uintptr_t limit,
                  void *value, size_t *used)
{
    struct decoder decoder;
    decoder.program = format_program(format, source->order);
    decoder.limit = limit;
    decoder.swap = source->order != byte_order_of_host();
    frame_stack_init(&decoder.stack);
    counts_init(&decoder.arrays);
    counts_init(&decoder.unchecked);
    for (uint32_t i = 0; i < format->holes.count; i++) {
        clear_few((uint8_t *)value + format->holes.items[i].offset, format->holes.items[i].length);
    }
    const uint8_t *at = source->bytes;
    int error = walk(&decoder, &at, value);
    if (error != 0) {
        release_partial(format, value, &decoder.arrays, &decoder.stack);
        memset(value, 0, format->type->size);
    } else if (used != NULL) {
        *used = (size_t)(at - source->bytes);
    }
    counts_fini(&decoder.unchecked);
    counts_fini(&decoder.arrays);
    frame_stack_fini(&decoder.stack);
    return error;
}

/* The address behind the bytes. */
static uintptr_t limit_of(const struct format_source *source)
{
    if (source->length == SIZE_MAX) {
        return UINTPTR_MAX;
    }
    return (uintptr_t)source->bytes + source->length;
}

/* Decodes a value that has a size into memory for it. */
static inline int decode_into(const struct format *format, const struct format_source *source,
                              void *value, size_t *used)
{
    const struct type *type = format->type;
    if (!type->simple || source->order != byte_order_of_host()) {
        return decode(format, source, limit_of(source), value, used);
    }
    copy_few(value, source->bytes, type->size);
    if (used != NULL) {
        *used = type->size;
    }
    return 0;
}

int format_decode(const struct format *format, const struct format_source *source, void *value,
                  size_t *used)
{
    if (used != NULL) {
        *used = 0;
    }
    int error = format_check(format, value);
    if (error != 0) {
        return error < 0 ? error : 0;
    }
    if (source->length < format->type->wire_least) {
        memset(value, 0, format->type->size);
        return ERR_CONTENT;
    }
    return decode_into(format, source, value, used);
}

int format_decode_new(const struct format *format, const struct format_source *source, void **value,
                      size_t *used)
{
    *value = NULL;
    if (used != NULL) {
        *used = 0;
    }
    int error = format_check(format, value);
    if (error != 0) {
        return error < 0 ? error : 0;
    }
    if (source->length < format->type->wire_least) {
        return ERR_CONTENT;
    }
    void *block = malloc(format->type->size);
    if (block == NULL) {
        return ERR_MEMORY;
    }
    error = decode_into(format, source, block, used);
    if (error != 0) {
        free(block);
    } else {
        *value = block;
    }
    return error;
}
