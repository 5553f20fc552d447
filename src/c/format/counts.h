/*
 * A growing list of element counts, the first of them without allocation.
 */
#ifndef IPC_FORMAT_COUNTS_H
#define IPC_FORMAT_COUNTS_H

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

enum { N_FIRST_COUNTS = 16 };

struct counts {
    uint32_t *items;
    size_t length;
    size_t capacity;
    uint32_t first[N_FIRST_COUNTS];
};

static inline void counts_init(struct counts *counts)
{
    counts->items = counts->first;
    counts->length = 0;
    counts->capacity = N_FIRST_COUNTS;
}

static inline void counts_fini(struct counts *counts)
{
    if (counts->items != counts->first) {
        free(counts->items);
    }
}

/* Makes room for one more: 0 or ERR_MEMORY. */
static inline int counts_reserve(struct counts *counts)
{
    if (counts->length < counts->capacity) {
        return 0;
    }
    uint32_t *old = counts->items == counts->first ? NULL : counts->items;
    if (counts->capacity > SIZE_MAX / 2 / sizeof *old) {
        return ERR_MEMORY;
    }
    uint32_t *items = realloc(old, counts->capacity * 2 * sizeof *items);
    if (items == NULL) {
        return ERR_MEMORY;
    }
    if (old == NULL) {
        memcpy(items, counts->first, sizeof counts->first);
    }
    counts->items = items;
    counts->capacity *= 2;
    return 0;
}

/* Appends a count for which room was made. */
static inline void counts_push(struct counts *counts, uint32_t count)
{
    counts->items[counts->length++] = count;
}

#endif
