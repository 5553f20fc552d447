/*
 * Waiting for a few descriptors, and waking one who waits, on POSIX systems.
 */
#define _POSIX_C_SOURCE 200809L
#include "platform/platform.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/select.h>
#include <unistd.h>

#include "base/error.h"

enum { FEW = 16 };

static int remaining_ms(uint64_t deadline_ns, int64_t timeout_ms)
{
    if (timeout_ms <= 0) {
        return timeout_ms < 0 ? -1 : 0;
    }
    const uint64_t now = clock_ns();
    if (now >= deadline_ns) {
        return 0;
    }
    const uint64_t left_ms = (deadline_ns - now + 999999u) / 1000000u;
    return left_ms > INT_MAX ? INT_MAX : (int)left_ms;
}

/* poll until something is found or the time is over, or, if it should, until a signal comes. */
static int poll_until(struct pollfd *polled, size_t n, int64_t timeout_ms, bool or_signal)
{
    const uint64_t deadline = timeout_ms > 0 ? clock_ns() + (uint64_t)timeout_ms * 1000000u : 0;
    for (;;) {
        const int left_ms = remaining_ms(deadline, timeout_ms);
        const int found = poll(polled, (nfds_t)n, left_ms);
        if (found > 0 || (found == 0 && left_ms != INT_MAX)) {
            return found;
        }
        if (found < 0 && errno != EINTR) {
            return ERR_IO;
        }
        if (found < 0 && or_signal) {
            return 0;
        }
    }
}

static short to_poll(short wanted)
{
    return (short)((wanted & READY_READ ? POLLIN : 0) | (wanted & READY_WRITE ? POLLOUT : 0));
}

static short from_poll(short events)
{
    return (short)((events & POLLIN ? READY_READ : 0) | (events & POLLOUT ? READY_WRITE : 0) |
                   (events & (POLLERR | POLLHUP) ? READY_ERROR : 0) |
                   (events & POLLNVAL ? READY_INVALID : 0));
}

static int wait_for(struct ready_item *items, size_t n_items, int64_t timeout_ms, bool or_signal)
{
    struct pollfd few[FEW];
    struct pollfd *polled = n_items <= FEW ? few : malloc(n_items * sizeof *polled);
    if (polled == NULL) {
        return ERR_IO;
    }
    for (size_t i = 0; i < n_items; i++) {
        polled[i].fd = items[i].fd;
        polled[i].events = to_poll(items[i].wanted);
        polled[i].revents = 0;
    }
    const int found = poll_until(polled, n_items, timeout_ms, or_signal);
    for (size_t i = 0; i < n_items; i++) {
        items[i].found = found > 0 ? from_poll(polled[i].revents) : 0;
    }
    if (polled != few) {
        free(polled);
    }
    return found;
}

int ready_wait(struct ready_item *items, size_t n_items, int64_t timeout_ms)
{
    return wait_for(items, n_items, timeout_ms, false);
}

int ready_wait_or_signal(struct ready_item *items, size_t n_items, int64_t timeout_ms)
{
    return wait_for(items, n_items, timeout_ms, true);
}

void ready_set_add(void *set, int fd)
{
    if (fd >= 0 && fd < FD_SETSIZE) {
        FD_SET((unsigned)fd, (fd_set *)set); /* a macro that shifts by it, to some systems */
    }
}

static int prepare(int fd)
{
    const int flags = fcntl(fd, F_GETFL);
    return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 &&
                   fcntl(fd, F_SETFD, FD_CLOEXEC) == 0
               ? 0
               : ERR_IO;
}

int waker_open(struct waker *waker)
{
    int ends[2];
    if (pipe(ends) < 0) {
        waker->read_fd = waker->write_fd = -1;
        return ERR_IO;
    }
    waker->read_fd = ends[0];
    waker->write_fd = ends[1];
    if (prepare(ends[0]) != 0 || prepare(ends[1]) != 0) {
        waker_close(waker);
        return ERR_IO;
    }
    return 0;
}

void waker_close(struct waker *waker)
{
    if (waker->read_fd >= 0) {
        close(waker->read_fd);
        close(waker->write_fd);
    }
    waker->read_fd = waker->write_fd = -1;
}

void waker_wake(const struct waker *waker)
{
    const int saved = errno;
    const char byte = 0;
    ssize_t n;
    do {
        n = write(waker->write_fd, &byte, 1);
    } while (n < 0 && errno == EINTR); /* a full pipe wakes as well */
    errno = saved;
}

void waker_clear(const struct waker *waker)
{
    char bytes[64];
    ssize_t n;
    do {
        n = read(waker->read_fd, bytes, sizeof bytes);
    } while (n == (ssize_t)sizeof bytes || (n < 0 && errno == EINTR));
}
