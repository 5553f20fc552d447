/*
 * Frame reader: finds the frames in a stream of bytes.
 */
#include "wire/reader.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"

enum {
    FIRST_CAPACITY = 4096,    /* enough for a quiet module */
    MAX_CAPACITY = 64 * 1024, /* of a busy one: many frames with one read */
    LARGE = 16 * 1024,        /* bodies above it are collected in their own block */
    LARGE_FIRST = 256 * 1024  /* of such a block at first */
};

void reader_init(struct reader *reader, enum frame_origin origin)
{
    memset(reader, 0, sizeof *reader);
    reader->origin = origin;
    reader->limit_class_data = LIMIT_CLASS_DATA;
    reader->limit_data = LIMIT_DATA;
}

void reader_fini(struct reader *reader)
{
    free(reader->bytes);
    free(reader->large_bytes);
    block_unref(reader->handed);
}

static size_t body_length(const struct frame *frame)
{
    return (size_t)frame->class_length + frame->data_length;
}

/* --------------------------------------------------------- the small buffer */

/* How many bytes in a row the frame that is under way needs; a header if it has none yet. */
static size_t wanted_capacity(const struct reader *reader)
{
    size_t wanted = FRAME_HEADER_SIZE;
    if (reader->end - reader->start >= FRAME_HEADER_SIZE) {
        struct frame frame;
        frame_read_header(&frame, reader->bytes + reader->start);
        if (body_length(&frame) <= LARGE) {
            wanted += body_length(&frame);
        }
    }
    return wanted;
}

static int grow(struct reader *reader, size_t capacity)
{
    uint8_t *bytes = realloc(reader->bytes, capacity);
    if (bytes == NULL) {
        return ERR_MEMORY;
    }
    reader->bytes = bytes;
    reader->capacity = capacity;
    return 0;
}

/* Moves what is left to the front, so that the longest possible read follows. */
static void compact(struct reader *reader)
{
    if (reader->start > 0) {
        memmove(reader->bytes, reader->bytes + reader->start, reader->end - reader->start);
        reader->end -= reader->start;
        reader->start = 0;
    }
}

static uint8_t *small_space(struct reader *reader, size_t *room)
{
    size_t capacity = reader->capacity == 0 ? FIRST_CAPACITY : reader->capacity;
    if (reader->capacity > 0 && reader->end == reader->capacity && capacity < MAX_CAPACITY) {
        capacity *= 2; /* the last read left no room: there is probably more */
    }
    while (capacity < wanted_capacity(reader)) {
        capacity *= 2;
    }
    compact(reader);
    if (capacity > reader->capacity && grow(reader, capacity) != 0) {
        return NULL;
    }
    *room = reader->capacity - reader->end;
    return reader->bytes + reader->end;
}

/* ---------------------------------------------------------- large frames */

static uint8_t *large_space(struct reader *reader, size_t *room)
{
    const size_t total = body_length(&reader->large);
    if (reader->large_filled == reader->large_capacity) {
        size_t capacity = reader->large_capacity * 2;
        capacity = capacity < total ? capacity : total;
        uint8_t *bytes = realloc(reader->large_bytes, capacity);
        if (bytes == NULL) {
            return NULL;
        }
        reader->large_bytes = bytes;
        reader->large_capacity = capacity;
    }
    *room = reader->large_capacity - reader->large_filled;
    return reader->large_bytes + reader->large_filled;
}

/* Moves what has arrived of a large frame's body out of the small buffer. */
static int start_large(struct reader *reader, const struct frame *frame)
{
    const size_t total = body_length(frame);
    const size_t there = reader->end - reader->start - FRAME_HEADER_SIZE;
    const size_t taken = there < total ? there : total;
    size_t capacity = total < LARGE_FIRST ? total : LARGE_FIRST;
    capacity = capacity < taken ? taken : capacity;
    reader->large_bytes = malloc(capacity);
    if (reader->large_bytes == NULL) {
        return ERR_MEMORY;
    }
    memcpy(reader->large_bytes, reader->bytes + reader->start + FRAME_HEADER_SIZE, taken);
    reader->start += FRAME_HEADER_SIZE + taken;
    reader->large = *frame;
    reader->large_capacity = capacity;
    reader->large_filled = taken;
    return 0;
}

static int finish_large(struct reader *reader, struct frame *frame)
{
    if (reader->large_filled < body_length(&reader->large)) {
        return 0;
    }
    struct block *block = block_adopt(reader->large_bytes, reader->large_filled);
    if (block == NULL) {
        return ERR_MEMORY;
    }
    reader->large_bytes = NULL;
    reader->handed = block;
    *frame = reader->large;
    frame->block = block;
    frame->class_data = block->bytes;
    frame->data = block->bytes + frame->class_length;
    return 1;
}

/* ------------------------------------------------------------------ stream */

uint8_t *reader_space(struct reader *reader, size_t *room)
{
    return reader->large_bytes != NULL ? large_space(reader, room) : small_space(reader, room);
}

void reader_filled(struct reader *reader, size_t count)
{
    if (reader->large_bytes != NULL) {
        reader->large_filled += count;
    } else {
        reader->end += count;
    }
}

int reader_take_raw(struct reader *reader, size_t count, const uint8_t **bytes)
{
    if (reader->end - reader->start < count) {
        return 0;
    }
    *bytes = reader->bytes + reader->start;
    reader->start += count;
    return 1;
}

static int next_small(struct reader *reader, struct frame *frame)
{
    const size_t there = reader->end - reader->start;
    if (there < FRAME_HEADER_SIZE) {
        return 0;
    }
    const uint8_t *at = reader->bytes + reader->start;
    frame_read_header(frame, at);
    reader->violation =
        frame_violation(frame, reader->origin, reader->limit_class_data, reader->limit_data);
    if (reader->violation != NULL) {
        reader->violating = *frame;
        return ERR_PROTOCOL;
    }
    const size_t body = body_length(frame);
    if (body > LARGE) {
        const int error = start_large(reader, frame);
        return error != 0 ? error : finish_large(reader, frame);
    }
    if (there < FRAME_HEADER_SIZE + body) {
        return 0;
    }
    frame->class_data = at + FRAME_HEADER_SIZE;
    frame->data = frame->class_data + frame->class_length;
    reader->start += FRAME_HEADER_SIZE + body;
    return 1;
}

int reader_next(struct reader *reader, struct frame *frame)
{
    if (reader->handed != NULL) {
        block_unref(reader->handed);
        reader->handed = NULL;
    }
    return reader->large_bytes != NULL ? finish_large(reader, frame) : next_small(reader, frame);
}

int reader_is_empty(const struct reader *reader)
{
    return reader->large_bytes == NULL && reader->start == reader->end;
}
