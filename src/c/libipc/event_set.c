/*
 * The set of descriptors for other event loops.
 */
#include "libipc/event_set.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/context.h"
#include "libipc/inbox.h"
#include "libipc/wait.h"

bool event_set_is_waiting(const struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_live(context) && inbox_first(context) != NULL) {
            return true;
        }
    }
    return false;
}

static bool is_listed(const struct ready_item *items, size_t n_items, int fd)
{
    for (size_t i = 0; i < n_items; i++) {
        if (items[i].fd == fd) {
            return true;
        }
    }
    return false;
}

/* A number that was closed and opened again has left the kernel's set, so each is set anew. */
static void set_all(struct library *library, const struct ready_item *items, size_t n_items)
{
    for (size_t i = 0; i < library->n_event_fds; i++) {
        if (!is_listed(items, n_items, library->event_fds[i])) {
            poller_remove(library->event_set, library->event_fds[i]);
        }
    }
    library->event_fds =
        mem_resize(library->event_fds, n_items + 1, sizeof *library->event_fds);
    for (size_t i = 0; i < n_items; i++) {
        library->event_fds[i] = items[i].fd;
        if (poller_change(library->event_set, items[i].fd, items[i].wanted, NULL) != 0) {
            /* Regular files cannot be waited for; they are always ready. */
            (void)poller_add(library->event_set, items[i].fd, items[i].wanted, NULL);
        }
    }
    library->n_event_fds = n_items;
}

void event_set_tell(struct library *library)
{
    if (library->event_set != NULL && event_set_is_waiting(library)) {
        waker_wake(&library->waker);
    }
}

void event_set_update(struct library *library)
{
    if (library->event_set == NULL) {
        return;
    }
    struct ready_item *items;
    const size_t n_items = wait_list(library, &items);
    set_all(library, items, n_items);
    free(items);
    event_set_tell(library);
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
