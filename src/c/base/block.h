/*
 * Reference-counted bytes.
 *
 * One message payload is received or encoded once and then shared by every
 * queue it waits in.  Counts are not atomic: a block belongs to one server or
 * to one library lock.
 */
#ifndef IPC_BASE_BLOCK_H
#define IPC_BASE_BLOCK_H

#include <stddef.h>
#include <stdint.h>

struct block {
    size_t references;
    size_t length;
    uint8_t *bytes; /* behind the struct itself, or a malloc block that it adopted */
};

/* length uninitialised bytes with one reference; NULL when memory is out. */
struct block *block_new(size_t length);

/* A copy of the bytes with one reference; NULL when memory is out. */
struct block *block_copy(const void *bytes, size_t length);

/* Takes over a malloc block; NULL (and bytes still the caller's) when memory is out. */
struct block *block_adopt(uint8_t *bytes, size_t length);

/* Takes the bytes out of an adopted block that nobody else refers to: they are the caller's malloc block
 * then, and the block has none.  NULL: it is no such block. */
uint8_t *block_take(struct block *block);

struct block *block_ref(struct block *block);

/* Gives one reference back; the last one frees.  NULL is fine. */
void block_unref(struct block *block);

#endif
