/*
 * Pool of records of one size: a list of free ones over chunks of many.
 */
#include "central/model/pool.h"

#include <stdlib.h>

#include "base/memory.h"

enum { CHUNK_BYTES = 16 * 1024 };

struct pool_record {
    struct pool_record *next;
};

/* Aligned like everything, so that the records behind it are, too. */
struct pool_chunk {
    union {
        struct pool_chunk *next;
        long double number;
    } head;
};

static size_t rounded(size_t size)
{
    const size_t unit = sizeof(struct pool_chunk);
    return (size + unit - 1) / unit * unit;
}

void pool_init(struct pool *pool, size_t record_size)
{
    pool->size = rounded(record_size);
    pool->free = NULL;
    pool->chunks = NULL;
}

void pool_fini(struct pool *pool)
{
    while (pool->chunks != NULL) {
        struct pool_chunk *chunk = pool->chunks;
        pool->chunks = chunk->head.next;
        free(chunk);
    }
    pool->free = NULL;
}

static void add_chunk(struct pool *pool)
{
    const size_t n_records = CHUNK_BYTES / pool->size + 1;
    struct pool_chunk *chunk = mem_resize(NULL, sizeof *chunk + n_records * pool->size, 1);
    chunk->head.next = pool->chunks;
    pool->chunks = chunk;
    char *at = (char *)(chunk + 1);
    for (size_t i = 0; i < n_records; i++) {
        pool_give(pool, at + i * pool->size);
    }
}

void *pool_take(struct pool *pool)
{
    if (pool->free == NULL) {
        add_chunk(pool);
    }
    struct pool_record *record = pool->free;
    pool->free = record->next;
    return record;
}

void pool_give(struct pool *pool, void *record)
{
    struct pool_record *freed = record;
    freed->next = pool->free;
    pool->free = freed;
}
