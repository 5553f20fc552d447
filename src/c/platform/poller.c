/*
 * Readiness of many descriptors where the system has no epoll: each wait looks at all of them.
 */
#include "platform/platform.h"

#if !defined(__linux__)

#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"

struct poller {
    struct ready_item *items;
    void **owners;
    size_t n_items;
    size_t capacity;
    size_t next; /* where the next look starts, so that nobody starves */
};

struct poller *poller_new(void)
{
    return mem_new(sizeof(struct poller));
}

void poller_free(struct poller *poller)
{
    if (poller != NULL) {
        free(poller->items);
        free(poller->owners);
        free(poller);
    }
}

int poller_descriptor(const struct poller *poller)
{
    (void)poller;
    return -1;
}

static size_t find(const struct poller *poller, int fd)
{
    size_t i = 0;
    while (i < poller->n_items && poller->items[i].fd != fd) {
        i++;
    }
    return i;
}

int poller_add(struct poller *poller, int fd, int wanted, void *owner)
{
    if (fd < 0) {
        return ERR_UNKNOWN;
    }
    if (poller->n_items == poller->capacity) {
        poller->capacity = poller->capacity == 0 ? 64 : poller->capacity * 2;
        poller->items = mem_resize(poller->items, poller->capacity, sizeof *poller->items);
        poller->owners = mem_resize(poller->owners, poller->capacity, sizeof *poller->owners);
    }
    poller->items[poller->n_items].fd = fd;
    poller->items[poller->n_items].wanted = (short)wanted;
    poller->items[poller->n_items].found = 0;
    poller->owners[poller->n_items++] = owner;
    return 0;
}

int poller_change(struct poller *poller, int fd, int wanted, void *owner)
{
    const size_t i = find(poller, fd);
    if (i == poller->n_items) {
        return ERR_UNKNOWN;
    }
    poller->items[i].wanted = (short)wanted;
    poller->owners[i] = owner;
    return 0;
}

void poller_remove(struct poller *poller, int fd)
{
    const size_t i = find(poller, fd);
    if (i < poller->n_items) {
        poller->items[i] = poller->items[--poller->n_items];
        poller->owners[i] = poller->owners[poller->n_items];
    }
}

int poller_wait(struct poller *poller, struct poller_event *events, int room, int64_t timeout_ms)
{
    if (ready_wait_or_signal(poller->items, poller->n_items, timeout_ms) < 0) {
        return ERR_IO;
    }
    int n = 0;
    for (size_t seen = 0; seen < poller->n_items && n < room; seen++) {
        poller->next = (poller->next + 1) % poller->n_items;
        const int found = poller->items[poller->next].found;
        if (found != 0) {
            events[n].owner = poller->owners[poller->next];
            events[n++].found = found & READY_INVALID ? found | READY_ERROR : found;
        }
    }
    return n;
}

#endif
