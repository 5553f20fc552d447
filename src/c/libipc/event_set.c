/*
 * The set of descriptors for other event loops.
 */
#include "libipc/event_set.h"

#include <stdlib.h>

#include "base/memory.h"

static bool is_listed(const struct source_list *list, int fd)
{
    for (size_t i = 0; i < list->count; i++) {
        if (list->items[i].fd == fd) {
            return true;
        }
    }
    return false;
}

/* A number that was closed and opened again has left the kernel's set, so each is set anew. */
static void set_all(struct library *library, const struct source_list *list)
{
    for (size_t i = 0; i < library->n_event_fds; i++) {
        if (!is_listed(list, library->event_fds[i])) {
            poller_remove(library->event_set, library->event_fds[i]);
        }
    }
    library->event_fds =
        mem_resize(library->event_fds, list->count + 1, sizeof *library->event_fds);
    library->n_event_fds = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct ready_item *item = &list->items[i];
        if (item->fd < 0) {
            continue;
        }
        library->event_fds[library->n_event_fds++] = item->fd;
        if (poller_change(library->event_set, item->fd, item->wanted, NULL) != 0) {
            /* Regular files cannot be waited for; they are always ready. */
            (void)poller_add(library->event_set, item->fd, item->wanted, NULL);
        }
    }
}

void event_set_list(struct library *library, struct source_list *list)
{
    source_list_init(list, library);
    source_list_add(list, &library->sources);
    source_list_add(list, &library->watched_fds);
}

void event_set_update(struct library *library)
{
    if (library->event_set == NULL) {
        return;
    }
    struct source_list list;
    event_set_list(library, &list);
    set_all(library, &list);
    source_list_fini(&list);
}

int event_set_descriptor(struct library *library)
{
    if (library->event_set == NULL) {
        library->event_set = poller_new();
    }
    if (library->event_set == NULL) {
        return -1;
    }
    event_set_update(library);
    return poller_descriptor(library->event_set);
}
