/*
 * Map from integers to things: linear probing over a table at most half full.
 *
 * Removal moves later entries of the same run back, so that there are no
 * tombstones and a look-up always ends at the first free slot.
 */
#include "base/intmap.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

enum { FIRST_SLOTS = 16 };

void intmap_init(struct intmap *map)
{
    map->slots = NULL;
    map->n_slots = 0;
    map->count = 0;
}

void intmap_fini(struct intmap *map)
{
    free(map->slots);
    intmap_init(map);
}

/* Where a search for key begins: keys are often consecutive, so their bits are spread. */
static size_t home_slot(const struct intmap *map, uint64_t key)
{
    key ^= key >> 33;
    key *= UINT64_C(0xff51afd7ed558ccd);
    key ^= key >> 33;
    return (size_t)key & (map->n_slots - 1);
}

/* The slot that holds key, or the free one where it would go. */
static struct intmap_slot *find_slot(const struct intmap *map, uint64_t key)
{
    size_t at = home_slot(map, key);
    while (map->slots[at].value != NULL && map->slots[at].key != key) {
        at = (at + 1) & (map->n_slots - 1);
    }
    return &map->slots[at];
}

static void grow(struct intmap *map)
{
    struct intmap old = *map;
    map->n_slots = old.n_slots == 0 ? FIRST_SLOTS : old.n_slots * 2;
    map->slots = mem_new(map->n_slots * sizeof *map->slots);
    for (size_t i = 0; i < old.n_slots; i++) {
        if (old.slots[i].value != NULL) {
            *find_slot(map, old.slots[i].key) = old.slots[i];
        }
    }
    free(old.slots);
}

void *intmap_find(const struct intmap *map, uint64_t key)
{
    return map->count == 0 ? NULL : find_slot(map, key)->value;
}

void *intmap_put(struct intmap *map, uint64_t key, void *value)
{
    assert(value != NULL);
    if (map->count >= map->n_slots / 2) {
        grow(map);
    }
    struct intmap_slot *slot = find_slot(map, key);
    void *replaced = slot->value;
    if (replaced == NULL) {
        map->count++;
    }
    slot->key = key;
    slot->value = value;
    return replaced;
}

/* Closes the gap at hole by moving back every later entry of the run that may stand there. */
static void close_gap(struct intmap *map, size_t hole)
{
    const size_t mask = map->n_slots - 1;
    for (size_t at = (hole + 1) & mask; map->slots[at].value != NULL; at = (at + 1) & mask) {
        size_t distance_from_home = (at - home_slot(map, map->slots[at].key)) & mask;
        if (distance_from_home < ((at - hole) & mask)) {
            continue;
        }
        map->slots[hole] = map->slots[at];
        hole = at;
    }
    map->slots[hole].value = NULL;
}

void *intmap_remove(struct intmap *map, uint64_t key)
{
    if (map->count == 0) {
        return NULL;
    }
    struct intmap_slot *slot = find_slot(map, key);
    void *value = slot->value;
    if (value == NULL) {
        return NULL;
    }
    map->count--;
    close_gap(map, (size_t)(slot - map->slots));
    return value;
}
