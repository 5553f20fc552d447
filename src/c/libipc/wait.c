/*
 * Waiting in the kernel, one thread for all.
 */
#include "libipc/wait.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/context.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/receive.h"
#include "libipc/watch_fd.h"

enum {
    FEW = 16,
    ASK_MS = 200 /* a signal that comes just before a wait, or in another thread, does not end it */
};

/* What a wait is for: the items, and the context of each (NULL: the waker, or a user's descriptor).
 * Contexts are never freed, so these may be looked at again after the wait. */
struct waiting {
    struct ready_item *items;
    struct _X_IPC_CONTEXT **contexts;
    size_t n_items;
    size_t capacity;
    struct ready_item few_items[FEW];
    struct _X_IPC_CONTEXT *few_contexts[FEW];
};

uint64_t wait_deadline(unsigned int timeout_ms)
{
    return timeout_ms == IPC_WAIT_FOREVER ? NO_DEADLINE
                                          : clock_ns() + (uint64_t)timeout_ms * 1000000u;
}

bool wait_is_over(uint64_t deadline_ns)
{
    return deadline_ns != NO_DEADLINE && clock_ns() >= deadline_ns;
}

bool wait_is_given_up(struct library *library)
{
    int (*const give_up)(void) = library->give_up;
    if (give_up == NULL) {
        return false;
    }
    library_leave(library);
    const bool given_up = give_up() != 0;
    mutex_lock(library->lock);
    return given_up;
}

/* The end of one wait: the deadline, or when the program is to be asked next. */
static uint64_t end_of_turn(const struct library *library, uint64_t deadline_ns)
{
    if (library->give_up == NULL) {
        return deadline_ns;
    }
    const uint64_t ask_ns = clock_ns() + (uint64_t)ASK_MS * 1000000u;
    return ask_ns < deadline_ns ? ask_ns : deadline_ns;
}

bool wait_pause(int milliseconds)
{
    const uint64_t deadline = clock_ns() + (uint64_t)milliseconds * 1000000u;
    struct library *library = library_enter();
    bool go_on = !wait_is_given_up(library);
    while (go_on && !wait_is_over(deadline)) {
        const uint64_t end = end_of_turn(library, deadline);
        const uint64_t now = clock_ns();
        library_leave(library);
        (void)ready_wait_or_signal(NULL, 0, end > now ? (int64_t)((end - now) / 1000000u) + 1 : 0);
        mutex_lock(library->lock);
        go_on = !wait_is_given_up(library);
    }
    library_leave(library);
    return go_on;
}

static void waiting_init(struct waiting *waiting)
{
    waiting->items = waiting->few_items;
    waiting->contexts = waiting->few_contexts;
    waiting->n_items = 0;
    waiting->capacity = FEW;
}

static void waiting_fini(struct waiting *waiting)
{
    if (waiting->items != waiting->few_items) {
        free(waiting->items);
        free(waiting->contexts);
    }
}

static void waiting_grow(struct waiting *waiting)
{
    const size_t capacity = waiting->capacity * 2;
    struct ready_item *items = mem_resize(NULL, capacity, sizeof *items);
    struct _X_IPC_CONTEXT **contexts = mem_resize(NULL, capacity, sizeof(*contexts));
    for (size_t i = 0; i < waiting->n_items; i++) {
        items[i] = waiting->items[i];
        contexts[i] = waiting->contexts[i];
    }
    waiting_fini(waiting);
    waiting->items = items;
    waiting->contexts = contexts;
    waiting->capacity = capacity;
}

static void waiting_add(void *waiting_pointer, int fd, int wanted, struct _X_IPC_CONTEXT *context)
{
    struct waiting *waiting = waiting_pointer;
    if (waiting->n_items == waiting->capacity) {
        waiting_grow(waiting);
    }
    struct ready_item *item = &waiting->items[waiting->n_items];
    item->fd = fd;
    item->wanted = (short)wanted;
    item->found = 0;
    waiting->contexts[waiting->n_items++] = context;
}

/* Writes what waits to be written.  Returns whether that, or a loss, is what some thread waits for. */
static bool flush_all(struct library *library)
{
    bool came = false;
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_open(context) && link_waiting(&context->link) > 0) {
            const IPC_ERROR_TYPE error = exchange_flush(context);
            came = came || error != IPC_No_Error ||
                   (context->writers > 0 && link_waiting(&context->link) == 0);
        }
    }
    return came;
}

/* Lists everything that may wake this thread. */
static void gather(struct library *library, struct waiting *waiting)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_open(context)) {
            const bool full = link_waiting(&context->link) > 0;
            waiting_add(waiting, context->link.fd, full ? READY_READ | READY_WRITE : READY_READ,
                        context);
            direct_each_fd(context, waiting_add, waiting);
        }
    }
    if (library->waker.read_fd >= 0) {
        waiting_add(waiting, library->waker.read_fd, READY_READ, NULL);
    }
}

static void gather_fds(struct library *library, struct waiting *waiting)
{
    struct list *position = library->watched_fds.next;
    for (; position != &library->watched_fds; position = position->next) {
        const struct watched_fd *watched = LIST_OWNER(position, struct watched_fd, in_library);
        if (!watched->ready && !watched->broken) {
            waiting_add(waiting, watched->fd, READY_READ, NULL);
        }
    }
}

static void mark_fd(struct library *library, const struct ready_item *item)
{
    struct list *position = library->watched_fds.next;
    for (; position != &library->watched_fds; position = position->next) {
        struct watched_fd *watched = LIST_OWNER(position, struct watched_fd, in_library);
        if (watched->fd == item->fd) {
            watched->broken = (item->found & READY_INVALID) != 0;
            watched->ready = !watched->broken;
        }
    }
}

static void take_found_central(struct _X_IPC_CONTEXT *context, int found)
{
    if (found & READY_WRITE) {
        (void)exchange_flush(context); /* a loss shows in the context's state */
    }
    if (found & (READY_READ | READY_ERROR)) {
        (void)receive(context); /* so does what came */
    }
}

static void take_found(struct library *library, const struct waiting *waiting)
{
    for (size_t i = 0; i < waiting->n_items; i++) {
        const struct ready_item *item = &waiting->items[i];
        struct _X_IPC_CONTEXT *context = waiting->contexts[i];
        if (item->found == 0) {
            continue;
        }
        if (context == NULL) {
            if (item->fd == library->waker.read_fd) {
                waker_clear(&library->waker);
            } else {
                mark_fd(library, item);
            }
        } else if (context_is_open(context) && context->link.fd == item->fd) {
            take_found_central(context, item->found);
        } else if (context_is_open(context)) {
            direct_ready(context, item->fd, item->found);
        }
    }
}

/* Milliseconds until the deadline or the next timer, -1 for ever, rounded up so as not to wake early. */
static int64_t patience_ms(const struct library *library, uint64_t deadline_ns)
{
    uint64_t until = deadline_ns;
    if (library->listeners > 0 && library->next_timer_ns < until) {
        until = library->next_timer_ns;
    }
    if (until == NO_DEADLINE) {
        return -1;
    }
    const uint64_t now = clock_ns();
    return now >= until ? 0 : (int64_t)((until - now + 999999u) / 1000000u);
}

static void wait_in_kernel(struct library *library, uint64_t deadline_ns)
{
    struct waiting waiting;
    waiting_init(&waiting);
    gather(library, &waiting);
    if (library->listeners > 0) {
        gather_fds(library, &waiting);
    }
    const int64_t patience = patience_ms(library, deadline_ns);
    library->polling = true;
    library_leave(library);
    const int found = ready_wait_or_signal(waiting.items, waiting.n_items, patience);
    mutex_lock(library->lock);
    library->polling = false;
    if (found > 0) {
        take_found(library, &waiting);
    }
    if (library->sleepers > 0) {
        condition_tell_all(library->changed);
    }
    waiting_fini(&waiting);
}

/* Whether a connection has more to write than the kernel takes. */
static bool is_any_full(struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_open(context) &&
            (link_waiting(&context->link) > 0 || context->draining > 0)) {
            return true;
        }
    }
    return false;
}

static void wait_for_other(struct library *library, uint64_t deadline_ns)
{
    if (is_any_full(library)) {
        waker_wake(&library->waker); /* the thread in the kernel may not wait for room yet */
    }
    library->sleepers++;
    condition_wait(library->changed, library->lock, deadline_ns);
    library->sleepers--;
}

bool wait_turn(struct library *library, uint64_t deadline_ns)
{
    if (flush_all(library)) {
        return true;
    }
    const uint64_t end_ns = end_of_turn(library, deadline_ns);
    if (library->polling) {
        wait_for_other(library, end_ns);
    } else {
        wait_in_kernel(library, end_ns);
    }
    return !wait_is_given_up(library);
}

size_t wait_list(struct library *library, struct ready_item **items)
{
    struct waiting waiting;
    waiting_init(&waiting);
    gather(library, &waiting);
    gather_fds(library, &waiting);
    const size_t n_items = waiting.n_items;
    *items = mem_resize(NULL, n_items + 1, sizeof **items);
    for (size_t i = 0; i < n_items; i++) {
        (*items)[i] = waiting.items[i];
    }
    waiting_fini(&waiting);
    return n_items;
}

void wait_poll_fds(struct library *library)
{
    struct waiting waiting;
    waiting_init(&waiting);
    gather_fds(library, &waiting);
    if (waiting.n_items > 0 && ready_wait(waiting.items, waiting.n_items, 0) > 0) {
        take_found(library, &waiting);
    }
    waiting_fini(&waiting);
}
