/*
 * Waiting for a few descriptors, and waking one who waits, on Windows.
 *
 * The system waits for sockets only.  Standard input, for which programs ask as descriptor 0, is
 * looked at every few milliseconds where somebody waits for it.
 */
#include "platform/sockets.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

enum { FEW = 16, STANDARD_INPUT = 0, LOOK_MS = 10 };

/* ------------------------------------------------------------ standard input */

/* Whether a key was pressed; what else a console tells is nobody's business. */
static short look_at_console(HANDLE console)
{
    INPUT_RECORD record;
    DWORD n = 0;
    while (PeekConsoleInputA(console, &record, 1, &n) != 0 && n > 0) {
        if (record.EventType == KEY_EVENT && record.Event.KeyEvent.bKeyDown) {
            return READY_READ;
        }
        (void)ReadConsoleInputA(console, &record, 1, &n);
    }
    return 0;
}

static short look_at_pipe(HANDLE pipe)
{
    DWORD n = 0;
    if (PeekNamedPipe(pipe, NULL, 0, NULL, &n, NULL) != 0) {
        return n > 0 ? READY_READ : 0;
    }
    return GetLastError() == ERROR_BROKEN_PIPE ? READY_READ : READY_INVALID;
}

static short look_at_input(void)
{
    const HANDLE input = GetStdHandle(STD_INPUT_HANDLE);
    DWORD mode;
    switch (GetFileType(input)) {
    case FILE_TYPE_CHAR:
        return GetConsoleMode(input, &mode) != 0 ? look_at_console(input) : READY_READ;
    case FILE_TYPE_PIPE:
        return look_at_pipe(input);
    case FILE_TYPE_DISK:
        return READY_READ; /* as files are */
    default:
        return READY_INVALID;
    }
}

/* -------------------------------------------------------------------- waiting */

/* What is waited for: the sockets among the items, and perhaps standard input. */
struct wait {
    WSAPOLLFD few[FEW];
    WSAPOLLFD *polled; /* few, or owned */
    ULONG n_polled;
    struct ready_item *input; /* NULL: nobody wants it */
};

static short to_poll(short wanted)
{
    return (short)((wanted & READY_READ ? POLLRDNORM : 0) |
                   (wanted & READY_WRITE ? POLLWRNORM : 0));
}

static short from_poll(short events)
{
    return (short)((events & POLLRDNORM ? READY_READ : 0) |
                   (events & POLLWRNORM ? READY_WRITE : 0) |
                   (events & (POLLERR | POLLHUP) ? READY_ERROR : 0) |
                   (events & POLLNVAL ? READY_INVALID : 0));
}

static int wait_init(struct wait *wait, struct ready_item *items, size_t n_items)
{
    wait->n_polled = 0;
    wait->input = NULL;
    wait->polled = n_items <= FEW ? wait->few : malloc(n_items * sizeof *wait->polled);
    if (wait->polled == NULL) {
        return ERR_IO;
    }
    for (size_t i = 0; i < n_items; i++) {
        items[i].found = 0;
        if (items[i].fd == STANDARD_INPUT) {
            wait->input = items[i].wanted & READY_READ ? &items[i] : wait->input;
        } else if (items[i].fd > STANDARD_INPUT) {
            WSAPOLLFD *polled = &wait->polled[wait->n_polled++];
            polled->fd = socket_of(items[i].fd);
            polled->events = to_poll(items[i].wanted);
            polled->revents = 0;
        }
    }
    return 0;
}

/* Waits once: how many are ready. */
static int wait_once(struct wait *wait, int timeout_ms)
{
    int found = 0;
    if (wait->input != NULL) {
        wait->input->found = look_at_input();
        found = wait->input->found != 0 ? 1 : 0;
        timeout_ms = found > 0 ? 0 : timeout_ms < 0 || timeout_ms > LOOK_MS ? LOOK_MS : timeout_ms;
    }
    if (wait->n_polled == 0) { /* WSAPoll does not wait for nothing */
        Sleep(timeout_ms < 0 ? INFINITE : (DWORD)timeout_ms);
        return found;
    }
    const int n = WSAPoll(wait->polled, wait->n_polled, timeout_ms);
    return n < 0 ? sockets_failure() : n + found;
}

static int remaining_ms(uint64_t deadline_ns, int64_t timeout_ms)
{
    if (timeout_ms <= 0) {
        return timeout_ms < 0 ? -1 : 0;
    }
    const uint64_t now = clock_ns();
    const uint64_t left_ms = now < deadline_ns ? (deadline_ns - now + 999999u) / 1000000u : 0;
    return left_ms > INT_MAX ? INT_MAX : (int)left_ms;
}

/* The system's waits may end a little early, so that the time is asked. */
static int wait_until(struct wait *wait, int64_t timeout_ms)
{
    const uint64_t deadline = timeout_ms > 0 ? clock_ns() + (uint64_t)timeout_ms * 1000000u : 0;
    for (;;) {
        const int left_ms = remaining_ms(deadline, timeout_ms);
        const int found = wait_once(wait, left_ms);
        if (found != 0 || left_ms == 0) {
            return found;
        }
    }
}

int ready_wait(struct ready_item *items, size_t n_items, int64_t timeout_ms)
{
    struct wait wait;
    if (wait_init(&wait, items, n_items) != 0) {
        return ERR_IO;
    }
    const int found = wait_until(&wait, timeout_ms);
    ULONG next = 0;
    for (size_t i = 0; i < n_items && found > 0; i++) {
        if (items[i].fd > STANDARD_INPUT) {
            items[i].found = from_poll(wait.polled[next++].revents);
        }
    }
    if (wait.polled != wait.few) {
        free(wait.polled);
    }
    return found;
}

/* No signal ends a wait here: Windows runs handlers in threads of their own. */
int ready_wait_or_signal(struct ready_item *items, size_t n_items, int64_t timeout_ms)
{
    return ready_wait(items, n_items, timeout_ms);
}

void ready_set_add(void *fd_set_pointer, int fd)
{
    fd_set *set = fd_set_pointer;
    if (fd >= 0 && set->fd_count < FD_SETSIZE) {
        set->fd_array[set->fd_count++] = socket_of(fd);
    }
}

/* --------------------------------------------------------------------- waking */

/* Whether the connection that was accepted is the one that was made here. */
static bool are_ends_of_one(int one, int other)
{
    struct sockaddr_in own;
    struct sockaddr_in peer;
    int own_length = sizeof own;
    int peer_length = sizeof peer;
    return getsockname(socket_of(one), (struct sockaddr *)&own, &own_length) == 0 &&
           getpeername(socket_of(other), (struct sockaddr *)&peer, &peer_length) == 0 &&
           own.sin_port == peer.sin_port && own.sin_addr.s_addr == peer.sin_addr.s_addr;
}

/* There are no pipes that can be waited for, so a connection to ourselves takes their place. */
int waker_open(struct waker *waker)
{
    enum { PATIENCE_MS = 5000 };
    int listener;
    int port = 0;
    waker->read_fd = waker->write_fd = -1;
    if (net_listen_tcp("127.0.0.1", &port, &listener) != 0) {
        return ERR_IO;
    }
    struct ready_item item = {listener, READY_READ, 0};
    bool done = net_connect_tcp("127.0.0.1", port, PATIENCE_MS, NULL, &waker->write_fd) == 0;
    done = done && ready_wait(&item, 1, PATIENCE_MS) > 0 &&
           net_accept(listener, &waker->read_fd) == 0 &&
           are_ends_of_one(waker->write_fd, waker->read_fd);
    net_close_copy(listener);
    if (!done) {
        waker_close(waker);
        return ERR_IO;
    }
    return 0;
}

void waker_close(struct waker *waker)
{
    if (waker->read_fd >= 0) {
        net_close_copy(waker->read_fd);
    }
    if (waker->write_fd >= 0) {
        net_close_copy(waker->write_fd);
    }
    waker->read_fd = waker->write_fd = -1;
}

void waker_wake(const struct waker *waker)
{
    const char byte = 0;
    (void)send(socket_of(waker->write_fd), &byte, 1, 0); /* one that is full wakes as well */
}

void waker_clear(const struct waker *waker)
{
    char bytes[64];
    while (recv(socket_of(waker->read_fd), bytes, sizeof bytes, 0) == (int)sizeof bytes) {
    }
}
