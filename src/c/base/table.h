/*
 * Table from names to things.
 *
 * Names are byte strings.  A folding table ignores the case of A to Z, as
 * message and module names do; an exact one does not, as named formats do.
 * Iteration is in order of insertion.  The table owns copies of its names and
 * borrows the values.
 */
#ifndef IPC_BASE_TABLE_H
#define IPC_BASE_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/list.h"

enum table_kind { TABLE_EXACT, TABLE_FOLDING };

struct table_entry {
    struct list order;        /* in table.entries */
    struct table_entry *next; /* in its slot */
    uint32_t hash;
    void *value;
    size_t length;
    char name[]; /* with a NUL behind it */
};

struct table {
    enum table_kind kind;
    size_t count;
    size_t n_slots; /* a power of two, or 0 */
    struct table_entry **slots;
    struct list entries;
};

void table_init(struct table *table, enum table_kind kind);

/* Frees the table and its names, not the values. */
void table_fini(struct table *table);

/* The value under name, NULL if there is none. */
void *table_find(const struct table *table, const char *name);
void *table_find_text(const struct table *table, const char *name, size_t length);

/* Sets the value under name and returns the value it replaces (the old spelling stays), NULL if new. */
void *table_put(struct table *table, const char *name, void *value);

/* Removes name and returns its value, NULL if there was none. */
void *table_remove(struct table *table, const char *name);

/* First and following entry in order of insertion, NULL at the end. */
struct table_entry *table_first(const struct table *table);
struct table_entry *table_next(const struct table *table, const struct table_entry *entry);

/* Whether two names are the same to a table of that kind. */
bool table_same_name(enum table_kind kind, const char *a, const char *b);

#endif
