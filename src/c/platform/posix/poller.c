/*
 * Readiness of many descriptors: epoll where there is one, poll elsewhere.
 */
#define _POSIX_C_SOURCE 200809L
#include "platform/platform.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

#if defined(__linux__)

#include <sys/epoll.h>

enum { ROOM = 256 };

struct poller {
    int fd;
};

struct poller *poller_new(void)
{
    const int fd = epoll_create1(EPOLL_CLOEXEC);
    if (fd < 0) {
        return NULL;
    }
    struct poller *poller = mem_new(sizeof *poller);
    poller->fd = fd;
    return poller;
}

void poller_free(struct poller *poller)
{
    if (poller != NULL) {
        close(poller->fd);
        free(poller);
    }
}

int poller_descriptor(const struct poller *poller)
{
    return poller->fd;
}

static int control(struct poller *poller, int operation, int fd, int wanted, void *owner)
{
    struct epoll_event event;
    event.events = (wanted & READY_READ ? (uint32_t)EPOLLIN : 0u) |
                   (wanted & READY_WRITE ? (uint32_t)EPOLLOUT : 0u);
    event.data.ptr = owner;
    return epoll_ctl(poller->fd, operation, fd, &event) == 0 ? 0 : ERR_IO;
}

int poller_add(struct poller *poller, int fd, int wanted, void *owner)
{
    return control(poller, EPOLL_CTL_ADD, fd, wanted, owner);
}

int poller_change(struct poller *poller, int fd, int wanted, void *owner)
{
    return control(poller, EPOLL_CTL_MOD, fd, wanted, owner);
}

void poller_remove(struct poller *poller, int fd)
{
    (void)control(poller, EPOLL_CTL_DEL, fd, 0, NULL); /* a closed descriptor has left by itself */
}

int poller_wait(struct poller *poller, struct poller_event *events, int room, int64_t timeout_ms)
{
    struct epoll_event found[ROOM];
    const int limit_ms = timeout_ms < 0 ? -1 : timeout_ms > INT_MAX ? INT_MAX : (int)timeout_ms;
    const int n = epoll_wait(poller->fd, found, room < ROOM ? room : ROOM, limit_ms);
    if (n < 0) {
        return errno == EINTR ? 0 : ERR_IO;
    }
    for (int i = 0; i < n; i++) {
        events[i].owner = found[i].data.ptr;
        events[i].found = (found[i].events & EPOLLIN ? READY_READ : 0) |
                          (found[i].events & EPOLLOUT ? READY_WRITE : 0) |
                          (found[i].events & (EPOLLERR | EPOLLHUP) ? READY_ERROR : 0);
    }
    return n;
}

#else

#include <poll.h>

struct poller {
    struct pollfd *items;
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

static short to_poll(int wanted)
{
    return (short)((wanted & READY_READ ? POLLIN : 0) | (wanted & READY_WRITE ? POLLOUT : 0));
}

int poller_add(struct poller *poller, int fd, int wanted, void *owner)
{
    if (poller->n_items == poller->capacity) {
        poller->capacity = poller->capacity == 0 ? 64 : poller->capacity * 2;
        poller->items = mem_resize(poller->items, poller->capacity, sizeof *poller->items);
        poller->owners = mem_resize(poller->owners, poller->capacity, sizeof *poller->owners);
    }
    poller->items[poller->n_items].fd = fd;
    poller->items[poller->n_items].events = to_poll(wanted);
    poller->items[poller->n_items].revents = 0;
    poller->owners[poller->n_items++] = owner;
    return 0;
}

int poller_change(struct poller *poller, int fd, int wanted, void *owner)
{
    const size_t i = find(poller, fd);
    if (i == poller->n_items) {
        return ERR_UNKNOWN;
    }
    poller->items[i].events = to_poll(wanted);
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
    const int limit_ms = timeout_ms < 0 ? -1 : timeout_ms > INT_MAX ? INT_MAX : (int)timeout_ms;
    if (poll(poller->items, (nfds_t)poller->n_items, limit_ms) < 0) {
        return errno == EINTR ? 0 : ERR_IO;
    }
    int n = 0;
    for (size_t seen = 0; seen < poller->n_items && n < room; seen++) {
        poller->next = (poller->next + 1) % poller->n_items;
        const short found = poller->items[poller->next].revents;
        if (found != 0) {
            events[n].owner = poller->owners[poller->next];
            events[n++].found = (found & POLLIN ? READY_READ : 0) |
                                (found & POLLOUT ? READY_WRITE : 0) |
                                (found & (POLLERR | POLLHUP | POLLNVAL) ? READY_ERROR : 0);
        }
    }
    return n;
}

#endif
