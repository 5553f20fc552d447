/*
 * Map from integers to things: open addressing, no allocation in the steady state.
 */
#ifndef IPC_BASE_INTMAP_H
#define IPC_BASE_INTMAP_H

#include <stddef.h>
#include <stdint.h>

struct intmap_slot {
    uint64_t key;
    void *value; /* NULL: the slot is free */
};

struct intmap {
    struct intmap_slot *slots;
    size_t n_slots; /* a power of two, or 0 */
    size_t count;
};

void intmap_init(struct intmap *map);
void intmap_fini(struct intmap *map);

/* The value under key, NULL if there is none. */
void *intmap_find(const struct intmap *map, uint64_t key);

/* Sets the (non-NULL) value under key and returns the value it replaces, or NULL. */
void *intmap_put(struct intmap *map, uint64_t key, void *value);

/* Removes key and returns its value, or NULL. */
void *intmap_remove(struct intmap *map, uint64_t key);

#endif
