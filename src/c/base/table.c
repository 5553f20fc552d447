/*
 * Table from names to things: chained hashing, with a list through all entries
 * that keeps the order of insertion.
 */
#include "base/table.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { FIRST_SLOTS = 16 };

static unsigned char fold(unsigned char c)
{
    return c >= 'A' && c <= 'Z' ? (unsigned char)(c + ('a' - 'A')) : c;
}

/* FNV-1a over the name as the table sees it. */
static uint32_t hash_name(enum table_kind kind, const char *name, size_t length)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)name[i];
        hash = (hash ^ (kind == TABLE_FOLDING ? fold(c) : c)) * 16777619u;
    }
    return hash;
}

static bool same_text(enum table_kind kind, const char *a, const char *b, size_t length)
{
    if (kind == TABLE_EXACT) {
        return memcmp(a, b, length) == 0;
    }
    for (size_t i = 0; i < length; i++) {
        if (fold((unsigned char)a[i]) != fold((unsigned char)b[i])) {
            return false;
        }
    }
    return true;
}

bool table_same_name(enum table_kind kind, const char *a, const char *b)
{
    size_t length = strlen(a);
    return strlen(b) == length && same_text(kind, a, b, length);
}

void table_init(struct table *table, enum table_kind kind)
{
    table->kind = kind;
    table->count = 0;
    table->n_slots = 0;
    table->slots = NULL;
    list_init(&table->entries);
}

void table_fini(struct table *table)
{
    struct table_entry *following;
    for (struct table_entry *entry = table_first(table); entry != NULL; entry = following) {
        following = table_next(table, entry);
        free(entry);
    }
    free(table->slots);
    table_init(table, table->kind);
}

/* The link that leads to the entry of that name, or the end of its chain. */
static struct table_entry **find_link(const struct table *table, const char *name, size_t length,
                                      uint32_t hash)
{
    struct table_entry **link = &table->slots[hash & (table->n_slots - 1)];
    while (*link != NULL) {
        const struct table_entry *entry = *link;
        if (entry->hash == hash && entry->length == length &&
            same_text(table->kind, entry->name, name, length)) {
            break;
        }
        link = &(*link)->next;
    }
    return link;
}

void *table_find_text(const struct table *table, const char *name, size_t length)
{
    if (table->count == 0) {
        return NULL;
    }
    const struct table_entry *entry =
        *find_link(table, name, length, hash_name(table->kind, name, length));
    return entry == NULL ? NULL : entry->value;
}

void *table_find(const struct table *table, const char *name)
{
    return table_find_text(table, name, strlen(name));
}

static void grow(struct table *table)
{
    free(table->slots);
    table->n_slots = table->n_slots == 0 ? FIRST_SLOTS : table->n_slots * 2;
    table->slots = mem_new(table->n_slots * sizeof(struct table_entry *));
    for (struct table_entry *entry = table_first(table); entry != NULL;
         entry = table_next(table, entry)) {
        struct table_entry **slot = &table->slots[entry->hash & (table->n_slots - 1)];
        entry->next = *slot;
        *slot = entry;
    }
}

static struct table_entry *new_entry(const char *name, size_t length, uint32_t hash)
{
    struct table_entry *entry = mem_new(sizeof *entry + length + 1);
    entry->hash = hash;
    entry->length = length;
    memcpy(entry->name, name, length);
    return entry;
}

void *table_put(struct table *table, const char *name, void *value)
{
    if (table->count >= table->n_slots) {
        grow(table);
    }
    size_t length = strlen(name);
    uint32_t hash = hash_name(table->kind, name, length);
    struct table_entry **link = find_link(table, name, length, hash);
    if (*link != NULL) {
        void *replaced = (*link)->value;
        (*link)->value = value;
        return replaced;
    }
    *link = new_entry(name, length, hash);
    (*link)->value = value;
    list_append(&table->entries, &(*link)->order);
    table->count++;
    return NULL;
}

void *table_remove(struct table *table, const char *name)
{
    if (table->count == 0) {
        return NULL;
    }
    size_t length = strlen(name);
    struct table_entry **link =
        find_link(table, name, length, hash_name(table->kind, name, length));
    struct table_entry *entry = *link;
    if (entry == NULL) {
        return NULL;
    }
    void *value = entry->value;
    *link = entry->next;
    list_remove(&entry->order);
    free(entry);
    table->count--;
    return value;
}

static struct table_entry *entry_at(const struct table *table, struct list *at)
{
    return at == &table->entries ? NULL : LIST_OWNER(at, struct table_entry, order);
}

struct table_entry *table_first(const struct table *table)
{
    return entry_at(table, table->entries.next);
}

struct table_entry *table_next(const struct table *table, const struct table_entry *entry)
{
    return entry_at(table, entry->order.next);
}
