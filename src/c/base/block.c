/*
 * Reference-counted bytes.
 *
 * A block made here is one allocation, the bytes right behind the struct.  An
 * adopted block keeps the bytes where they are; the two are told apart by where
 * the bytes pointer leads.
 */
#include "base/block.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

struct block *block_new(size_t length)
{
    if (length > PTRDIFF_MAX - sizeof(struct block)) {
        return NULL;
    }
    struct block *block = malloc(sizeof *block + length);
    if (block == NULL) {
        return NULL;
    }
    block->references = 1;
    block->length = length;
    block->bytes = (uint8_t *)(block + 1);
    return block;
}

struct block *block_copy(const void *bytes, size_t length)
{
    struct block *block = block_new(length);
    if (block != NULL && length > 0) {
        memcpy(block->bytes, bytes, length);
    }
    return block;
}

struct block *block_adopt(uint8_t *bytes, size_t length)
{
    /* One byte more, so that the place behind the struct is never another block's first byte. */
    struct block *block = malloc(sizeof *block + 1);
    if (block == NULL) {
        return NULL;
    }
    block->references = 1;
    block->length = length;
    block->bytes = bytes;
    return block;
}

static bool is_adopted(const struct block *block)
{
    return block->bytes != (const uint8_t *)(block + 1);
}

uint8_t *block_take(struct block *block)
{
    if (block->references > 1 || !is_adopted(block)) {
        return NULL;
    }
    uint8_t *bytes = block->bytes;
    block->bytes = NULL;
    block->length = 0;
    return bytes;
}

struct block *block_ref(struct block *block)
{
    block->references++;
    return block;
}

void block_unref(struct block *block)
{
    if (block == NULL) {
        return;
    }
    assert(block->references > 0);
    if (--block->references > 0) {
        return;
    }
    if (is_adopted(block)) {
        free(block->bytes);
    }
    free(block);
}
