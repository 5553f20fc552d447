/*
 * Sources, and lists of them.
 */
#include "libipc/source.h"

#include <stdlib.h>

#include "base/memory.h"

enum { FEW = sizeof(((struct source_list *)NULL)->few_items) / sizeof(struct ready_item) };

void source_init(struct source *source, const struct source_kind *kind, int fd)
{
    list_init(&source->in_library);
    source->kind = kind;
    source->fd = fd;
    source->due_ns = NO_DEADLINE;
}

static void grow(struct source_list *list)
{
    const size_t capacity = list->capacity * 2;
    struct ready_item *items = mem_resize(NULL, capacity, sizeof *items);
    struct source **sources = mem_resize(NULL, capacity, sizeof(*sources));
    for (size_t i = 0; i < list->count; i++) {
        items[i] = list->items[i];
        sources[i] = list->sources[i];
    }
    source_list_fini(list);
    list->items = items;
    list->sources = sources;
    list->capacity = capacity;
}

static void append(struct source_list *list, struct source *source, int fd, int wanted)
{
    if (list->count == list->capacity) {
        grow(list);
    }
    struct ready_item *item = &list->items[list->count];
    item->fd = fd;
    item->wanted = (short)wanted;
    item->found = 0;
    list->sources[list->count++] = source;
}

void source_list_add(struct source_list *list, struct list *sources)
{
    struct list *position = sources->next;
    for (; position != sources; position = position->next) {
        struct source *source = source_at(position);
        const int wanted = source->kind->wanted(source);
        if (wanted != NOT_WANTED) {
            append(list, source, source->fd, wanted);
        } else if (source->due_ns != NO_DEADLINE) {
            append(list, source, -1, 0); /* only for its time */
        }
    }
}

void source_list_init(struct source_list *list, const struct library *library)
{
    list->items = list->few_items;
    list->sources = list->few_sources;
    list->count = 0;
    list->capacity = FEW;
    append(list, NULL, library->waker.read_fd, READY_READ);
}

void source_list_forget(struct source_list *list, const struct source *source)
{
    for (size_t i = 0; i < list->count; i++) {
        if (list->sources[i] == source) {
            list->sources[i] = NULL;
        }
    }
}

void source_list_fini(struct source_list *list)
{
    if (list->items != list->few_items) {
        free(list->items);
        free(list->sources);
    }
}
