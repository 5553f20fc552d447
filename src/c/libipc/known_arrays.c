/*
 * The table of byte arrays that were handed out.
 */
#include "libipc/known_arrays.h"

#include <stdlib.h>
#include <string.h>

#include "base/limits.h"
#include "base/memory.h"

struct known_array {
    struct list in_order;
    struct array_mark mark;
};

struct array_mark known_arrays_mark(const void *bytes, size_t length, enum byte_order order)
{
    const size_t n_bytes = length < MARK_BYTES ? length : MARK_BYTES;
    struct array_mark mark = {(uintptr_t)bytes, 0, length, order, {0}, {0}};
    mark.usable = memory_usable_size((void *)mark.address);
    memcpy(mark.first, bytes, n_bytes);
    memcpy(mark.last, (const uint8_t *)bytes + length - n_bytes, n_bytes);
    return mark;
}

/* Whether the array is still what its mark says.  The block's size comes first: nothing is read
 * beyond the end of a smaller one. */
static bool is_as_marked(const struct array_mark *mark)
{
    if (memory_usable_size((void *)mark->address) != mark->usable) {
        return false;
    }
    const struct array_mark now =
        known_arrays_mark((const void *)mark->address, mark->length, mark->order);
    return memcmp(now.first, mark->first, MARK_BYTES) == 0 &&
           memcmp(now.last, mark->last, MARK_BYTES) == 0;
}

static void forget(struct library *library, struct known_array *known)
{
    (void)intmap_remove(&library->known_arrays, known->mark.address);
    list_remove(&known->in_order);
    free(known);
}

void known_arrays_add(struct library *library, const struct array_mark *mark)
{
    struct known_array *known = intmap_find(&library->known_arrays, mark->address);
    if (known == NULL) {
        if (library->known_arrays.count >= LIMIT_KNOWN_ARRAYS) {
            forget(library, LIST_OWNER(library->known_order.next, struct known_array, in_order));
        }
        known = mem_new(sizeof *known);
        list_append(&library->known_order, &known->in_order);
        (void)intmap_put(&library->known_arrays, mark->address, known); /* replaces nothing */
    }
    known->mark = *mark;
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
    if (!is_as_marked(&known->mark)) {
        forget(library, known);
        return source;
    }
    source.length = known->mark.length;
    source.order = known->mark.order;
    return source;
}
