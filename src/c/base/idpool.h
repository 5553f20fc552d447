/*
 * Pool of small numbers that stand for things.
 *
 * Numbers start at 0; a freed number is given out again, the latest freed
 * first.  Each number has a generation that grows at every release, so that a
 * handle made of number and generation is recognised as stale for ever.
 */
#ifndef IPC_BASE_IDPOOL_H
#define IPC_BASE_IDPOOL_H

#include <stddef.h>
#include <stdint.h>

struct idpool_slot {
    void *thing; /* NULL while the number is free */
    uint32_t generation;
    uint32_t next_free;
};

struct idpool {
    struct idpool_slot *slots;
    uint32_t n_slots; /* numbers ever given out */
    uint32_t capacity;
    uint32_t first_free; /* UINT32_MAX: none */
    uint32_t in_use;
};

void idpool_init(struct idpool *pool);
void idpool_fini(struct idpool *pool);

/* Gives a number to a (non-NULL) thing. */
uint32_t idpool_take(struct idpool *pool, void *thing);

/* The thing of a number, NULL for numbers that are free or were never given out. */
void *idpool_get(const struct idpool *pool, int64_t number);

/* Frees the number of a thing. */
void idpool_release(struct idpool *pool, uint32_t number);

/* The number of a thing together with its generation, in disguise; never 0. */
uintptr_t idpool_handle(const struct idpool *pool, uint32_t number);

/* The thing of a handle, NULL if it has gone, or for what never was a handle. */
void *idpool_find(const struct idpool *pool, uintptr_t handle);

#endif
