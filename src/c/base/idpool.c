/*
 * Pool of small numbers: an array of slots with the free ones chained through it.
 */
#include "base/idpool.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

enum { FIRST_CAPACITY = 16 };

static const uint32_t no_slot = UINT32_MAX;

void idpool_init(struct idpool *pool)
{
    pool->slots = NULL;
    pool->n_slots = 0;
    pool->capacity = 0;
    pool->first_free = no_slot;
    pool->in_use = 0;
}

void idpool_fini(struct idpool *pool)
{
    free(pool->slots);
    idpool_init(pool);
}

/* A number that was never given out. */
static uint32_t new_number(struct idpool *pool)
{
    if (pool->n_slots == pool->capacity) {
        assert(pool->capacity <= UINT32_MAX / 2);
        pool->capacity = pool->capacity == 0 ? FIRST_CAPACITY : pool->capacity * 2;
        pool->slots = mem_resize(pool->slots, pool->capacity, sizeof *pool->slots);
    }
    pool->slots[pool->n_slots].generation = 0;
    return pool->n_slots++;
}

uint32_t idpool_take(struct idpool *pool, void *thing)
{
    assert(thing != NULL);
    uint32_t number = pool->first_free;
    if (number == no_slot) {
        number = new_number(pool);
    } else {
        pool->first_free = pool->slots[number].next_free;
    }
    pool->slots[number].thing = thing;
    pool->slots[number].next_free = no_slot;
    pool->in_use++;
    return number;
}

void *idpool_get(const struct idpool *pool, int64_t number)
{
    if (number < 0 || number >= pool->n_slots) {
        return NULL;
    }
    return pool->slots[number].thing;
}

void idpool_release(struct idpool *pool, uint32_t number)
{
    assert(number < pool->n_slots && pool->slots[number].thing != NULL);
    struct idpool_slot *slot = &pool->slots[number];
    slot->thing = NULL;
    slot->generation++;
    slot->next_free = pool->first_free;
    pool->first_free = number;
    pool->in_use--;
}

/* A handle is generation and number + 1. */
#define NUMBER_BITS (sizeof(uintptr_t) * 4)
#define NUMBER_MASK (((uintptr_t)1 << NUMBER_BITS) - 1)

uintptr_t idpool_handle(const struct idpool *pool, uint32_t number)
{
    assert(number < pool->n_slots && pool->slots[number].thing != NULL);
    const uintptr_t generation = pool->slots[number].generation;
    return generation << NUMBER_BITS | ((uintptr_t)number + 1);
}

void *idpool_find(const struct idpool *pool, uintptr_t handle)
{
    const uintptr_t number = (handle & NUMBER_MASK) - 1;
    void *thing = number < pool->n_slots ? pool->slots[number].thing : NULL;
    return thing != NULL && idpool_handle(pool, (uint32_t)number) == handle ? thing : NULL;
}
