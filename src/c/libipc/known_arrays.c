/*
 * The table of byte arrays that were handed out.
 */
#include "libipc/known_arrays.h"

#include <stdlib.h>

#include "base/limits.h"
#include "base/memory.h"

struct known_array {
    struct list in_order;
    uintptr_t address;
    size_t usable; /* of its malloc block: another value tells that it was freed and reused */
    size_t length;
    enum byte_order order;
};

static size_t usable_size(uintptr_t address)
{
    return memory_usable_size((void *)address);
}

static void forget(struct library *library, struct known_array *known)
{
    (void)intmap_remove(&library->known_arrays, known->address);
    list_remove(&known->in_order);
    free(known);
}

void known_arrays_add(struct library *library, const void *bytes, size_t length,
                      enum byte_order order)
{
    if (bytes == NULL) {
        return;
    }
    struct known_array *known = intmap_find(&library->known_arrays, (uintptr_t)bytes);
    if (known == NULL) {
        if (library->known_arrays.count >= LIMIT_KNOWN_ARRAYS) {
            forget(library, LIST_OWNER(library->known_order.next, struct known_array, in_order));
        }
        known = mem_new(sizeof *known);
        known->address = (uintptr_t)bytes;
        list_append(&library->known_order, &known->in_order);
        (void)intmap_put(&library->known_arrays, known->address, known); /* replaces nothing */
    }
    known->usable = usable_size(known->address);
    known->length = length;
    known->order = order;
}

void known_arrays_remove(struct library *library, const void *bytes)
{
    struct running *running = library->running;
    for (; running != NULL; running = running->outer) {
        if (running->content == bytes) {
            running->content = NULL;
        }
    }
    struct known_array *known = intmap_find(&library->known_arrays, (uintptr_t)bytes);
    if (known != NULL) {
        forget(library, known);
    }
}

struct format_source known_arrays_find(struct library *library, const void *bytes)
{
    struct format_source source = {bytes, SIZE_MAX, byte_order_of_host()};
    const struct running *running = library->running;
    for (; running != NULL; running = running->outer) {
        if (running->content == bytes) {
            source.length = running->content_length;
            source.order = running->content_order;
            return source;
        }
    }
    struct known_array *known = intmap_find(&library->known_arrays, (uintptr_t)bytes);
    if (known == NULL) {
        return source;
    }
    if (known->usable != usable_size(known->address)) {
        forget(library, known);
        return source;
    }
    source.length = known->length;
    source.order = known->order;
    return source;
}
