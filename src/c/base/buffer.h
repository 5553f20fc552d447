/*
 * A growing run of bytes.
 *
 * Bytes are appended at the end.  Growth doubles.  A buffer may hold data whose
 * size a user or a peer chose, so running out of memory is an ordinary error.
 */
#ifndef IPC_BASE_BUFFER_H
#define IPC_BASE_BUFFER_H

#include <stddef.h>
#include <stdint.h>

struct buffer {
    uint8_t *bytes; /* owned; NULL while capacity is 0 */
    size_t length;
    size_t capacity;
};

void buffer_init(struct buffer *buffer);
void buffer_fini(struct buffer *buffer);

/* Forgets the content, keeps the memory. */
void buffer_clear(struct buffer *buffer);

/* Makes room for extra more bytes: 0 or ERR_MEMORY (content untouched). */
int buffer_reserve(struct buffer *buffer, size_t extra);

/* Lengthens by count uninitialised bytes and returns the first of them; NULL when memory is out. */
uint8_t *buffer_extend(struct buffer *buffer, size_t count);

/* Appends count bytes: 0 or ERR_MEMORY. */
int buffer_append(struct buffer *buffer, const void *bytes, size_t count);

/* Moves the content out, a malloc block that the caller frees (NULL if nothing was ever appended);
 * length may be NULL. */
uint8_t *buffer_take(struct buffer *buffer, size_t *length);

#endif
