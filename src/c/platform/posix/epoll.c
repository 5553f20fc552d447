/*
 * Readiness of many descriptors by epoll, where there is one; see poller.c for others.
 */
#define _POSIX_C_SOURCE 200809L
#include "platform/platform.h"

#if defined(__linux__)

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

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

#endif
