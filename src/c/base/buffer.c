/*
 * A growing run of bytes: doubling growth with checked sizes.
 */
#include "base/buffer.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"

enum { SMALLEST_CAPACITY = 64 };

void buffer_init(struct buffer *buffer)
{
    buffer->bytes = NULL;
    buffer->length = 0;
    buffer->capacity = 0;
}

void buffer_fini(struct buffer *buffer)
{
    free(buffer->bytes);
    buffer_init(buffer);
}

void buffer_clear(struct buffer *buffer)
{
    buffer->length = 0;
}

/* The capacity that holds needed bytes (at most PTRDIFF_MAX): the next doubling, or just needed. */
static size_t grown_capacity(size_t capacity, size_t needed)
{
    if (capacity < SMALLEST_CAPACITY) {
        capacity = SMALLEST_CAPACITY;
    }
    while (capacity < needed) {
        if (capacity > PTRDIFF_MAX / 2) {
            return needed;
        }
        capacity *= 2;
    }
    return capacity;
}

int buffer_reserve(struct buffer *buffer, size_t extra)
{
    if (extra <= buffer->capacity - buffer->length) {
        return 0;
    }
    if (extra > PTRDIFF_MAX - buffer->length) {
        return ERR_MEMORY;
    }
    size_t capacity = grown_capacity(buffer->capacity, buffer->length + extra);
    uint8_t *bytes = buffer->bytes == NULL ? malloc(capacity) : realloc(buffer->bytes, capacity);
    if (bytes == NULL) {
        return ERR_MEMORY;
    }
    buffer->bytes = bytes;
    buffer->capacity = capacity;
    return 0;
}

uint8_t *buffer_extend(struct buffer *buffer, size_t count)
{
    /* The first allocation happens even for count 0, so that success is never NULL. */
    if (buffer_reserve(buffer, buffer->capacity == 0 && count == 0 ? 1 : count) != 0) {
        return NULL;
    }
    uint8_t *first = buffer->bytes + buffer->length;
    buffer->length += count;
    return first;
}

int buffer_append(struct buffer *buffer, const void *bytes, size_t count)
{
    if (count == 0) {
        return 0;
    }
    uint8_t *first = buffer_extend(buffer, count);
    if (first == NULL) {
        return ERR_MEMORY;
    }
    memcpy(first, bytes, count);
    return 0;
}

uint8_t *buffer_take(struct buffer *buffer, size_t *length)
{
    uint8_t *bytes = buffer->bytes;
    if (length != NULL) {
        *length = buffer->length;
    }
    buffer_init(buffer);
    return bytes;
}
