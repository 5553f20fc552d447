/*
 * Timers.
 */
#include "libipc/timer.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/memory.h"
#include "libipc/callback.h"
#include "libipc/report.h"
#include "libipc/wait.h"

struct timer {
    struct list in_library;
    uint32_t number;
    uint64_t period_ns;
    uint64_t due_ns;
    long left; /* TRIGGER_FOREVER: for ever */
    TIMER_HANDLER_TYPE handler;
    void *client_data;
    struct _X_IPC_CONTEXT *context; /* current when it was added; NULL: there was none */
    uint64_t pass;                  /* the one in which it was called last */
    bool running;
    bool removed; /* while running: freed when the handler returns */
};

static struct timer *timer_at(struct list *position)
{
    return LIST_OWNER(position, struct timer, in_library);
}

static struct timer *timer_find(const struct library *library, TIMER_REF reference)
{
    return idpool_find(&library->timer_ids, (uintptr_t)reference);
}

/* Timers that run, or whose turn another thread has, do not end a wait. */
static void find_next(struct library *library)
{
    library->next_timer_ns = UINT64_MAX;
    struct list *position = library->timers.next;
    for (; position != &library->timers; position = position->next) {
        const struct timer *timer = timer_at(position);
        if (!timer->running && timer->due_ns < library->next_timer_ns &&
            callback_turn_is_free(library, timer->context)) {
            library->next_timer_ns = timer->due_ns;
        }
    }
}

static void timer_free(struct library *library, struct timer *timer)
{
    list_remove(&timer->in_library);
    idpool_release(&library->timer_ids, timer->number);
    free(timer);
}

/* The oldest one with that handler that still has calls to make. */
static struct timer *oldest_of(struct library *library, TIMER_HANDLER_TYPE handler)
{
    struct list *position = library->timers.next;
    for (; position != &library->timers; position = position->next) {
        struct timer *timer = timer_at(position);
        if (timer->handler == handler && !timer->removed && timer->left != 0) {
            return timer;
        }
    }
    return NULL;
}

static struct timer *timer_new(struct library *library)
{
    struct timer *timer = mem_new(sizeof *timer);
    timer->number = idpool_take(&library->timer_ids, timer);
    list_append(&library->timers, &timer->in_library);
    return timer;
}

TIMER_REF timer_add(struct library *library, uint64_t delay_ms, long count,
                    TIMER_HANDLER_TYPE handler, void *client_data, bool want_reference)
{
    struct timer *timer = want_reference ? NULL : oldest_of(library, handler);
    if (timer != NULL) {
        report_warning("Replacing existing timer for handler (0x%" PRIxPTR ")\n",
                       (uintptr_t)handler);
    } else {
        timer = timer_new(library);
    }
    timer->period_ns = delay_ms > UINT64_MAX / 2000000u ? UINT64_MAX / 2 : delay_ms * 1000000u;
    timer->due_ns = clock_ns() + timer->period_ns;
    timer->left = count;
    timer->handler = handler;
    timer->client_data = client_data;
    timer->context = context_current_live(library);
    timer->pass = 0;
    find_next(library);
    wait_changed(library);
    return (TIMER_REF)idpool_handle(&library->timer_ids, timer->number);
}

static void timer_end(struct library *library, struct timer *timer)
{
    if (timer->running) {
        timer->removed = true;
        timer->left = 0;
    } else {
        timer_free(library, timer);
    }
    find_next(library);
}

bool timer_remove(struct library *library, TIMER_HANDLER_TYPE handler)
{
    struct timer *timer = oldest_of(library, handler);
    if (timer != NULL) {
        timer_end(library, timer);
    }
    return timer != NULL;
}

bool timer_remove_reference(struct library *library, TIMER_REF reference)
{
    struct timer *timer = timer_find(library, reference);
    if (timer == NULL || timer->removed || timer->left == 0) {
        return false;
    }
    timer_end(library, timer);
    return true;
}

long timer_count(const struct library *library, TIMER_REF reference)
{
    const struct timer *timer = timer_find(library, reference);
    return timer != NULL && !timer->removed ? timer->left : 0;
}

void timer_clear(struct library *library)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &library->timers) {
        struct timer *timer = timer_at(position);
        if (timer->running) {
            timer->removed = true;
            timer->left = 0;
        } else {
            timer_free(library, timer);
        }
    }
    find_next(library);
}

unsigned long timer_milliseconds(uint64_t ns)
{
    return (unsigned long)(ns / 1000000u);
}

/* The next call is a whole number of periods after the last, so that lateness does not add up; periods
 * that have been missed altogether are left out. */
static void schedule(struct timer *timer, uint64_t now)
{
    if (timer->left != TRIGGER_FOREVER) {
        timer->left--;
    }
    timer->due_ns += timer->period_ns;
    if (timer->due_ns <= now) {
        timer->due_ns = now + timer->period_ns;
    }
}

static void timer_call(struct library *library, struct timer *timer, uint64_t now)
{
    const uint64_t due = timer->due_ns;
    struct running running = callback_of(library, timer->context, NO_ID);
    const TIMER_HANDLER_TYPE handler = timer->handler;
    void *client_data = timer->client_data;
    schedule(timer, now);
    timer->running = true;
    find_next(library);
    callback_begin(library, &running);
    handler(client_data, timer_milliseconds(now), timer_milliseconds(due));
    callback_end(library, &running);
    timer->running = false;
    if (timer->removed || timer->left == 0) {
        timer_free(library, timer);
    }
    find_next(library);
}

/* The first timer that is due and has not been called in this pass. */
static struct timer *next_due(struct library *library, uint64_t now, uint64_t pass)
{
    struct list *position = library->timers.next;
    for (; position != &library->timers; position = position->next) {
        struct timer *timer = timer_at(position);
        if (!timer->running && timer->due_ns <= now && timer->pass != pass &&
            callback_turn_is_free(library, timer->context)) {
            return timer;
        }
    }
    return NULL;
}

void timer_run_due(struct library *library)
{
    if (list_is_empty(&library->timers)) {
        return;
    }
    find_next(library);
    uint64_t now = clock_ns();
    if (now < library->next_timer_ns) {
        return;
    }
    const uint64_t pass = ++library->timer_passes;
    struct timer *timer = next_due(library, now, pass);
    while (timer != NULL) {
        timer->pass = pass;
        timer_call(library, timer, now);
        now = clock_ns();
        timer = next_due(library, now, pass);
    }
}
