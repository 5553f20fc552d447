/*
 * Pool of records of one size.
 *
 * Records are made many at a time and kept for the next user when they are given
 * back, so that queues that grow and shrink do not allocate.
 */
#ifndef IPC_CENTRAL_POOL_H
#define IPC_CENTRAL_POOL_H

#include <stddef.h>

struct pool_record; /* a free record */
struct pool_chunk;

struct pool {
    size_t size; /* of a record */
    struct pool_record *free;
    struct pool_chunk *chunks;
};

void pool_init(struct pool *pool, size_t record_size);

/* Frees all records. */
void pool_fini(struct pool *pool);

/* A record with whatever is in it; never NULL. */
void *pool_take(struct pool *pool);

void pool_give(struct pool *pool, void *record);

#endif
