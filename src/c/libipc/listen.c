/*
 * Listening.
 *
 *     due timers  ->  ready descriptors, ascending  ->  messages  ->  due timers
 *
 * If the first round finds nothing, the thread waits and tries again.
 */
#include "libipc/listen.h"

#include "libipc/callback.h"
#include "libipc/closing.h"
#include "libipc/deliver.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/receive.h"
#include "libipc/reconnect.h"
#include "libipc/timer.h"
#include "libipc/wait.h"
#include "libipc/watch_fd.h"

/* Acknowledgements may wait for company, but not for longer than this. */
enum { ACKNOWLEDGE_NS = 1000000 };

/* Takes in what has arrived where it is likely that something has, or, if urgent, everywhere. */
static void look(struct library *library, bool urgent)
{
    struct list *position = library->contexts.next;
    reconnect_turn(library); /* news of it come through the inbox */
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_connected(context) && inbox_first(context) == NULL &&
            (urgent || context->try_first)) {
            context->try_first = receive(context);
            if (urgent) {
                direct_look(context);
            }
        }
    }
    watch_fd_poll(library);
}

static void flush_late_acknowledgements(struct _X_IPC_CONTEXT *context)
{
    if (context->acknowledged_ns != 0 && clock_ns() - context->acknowledged_ns > ACKNOWLEDGE_NS) {
        (void)exchange_flush(context); /* a loss shows in the context's state */
    }
}

/* Runs up to limit messages of one context, but none that come while they run. */
static int run_messages(struct _X_IPC_CONTEXT *context, int limit)
{
    int n_run = 0;
    size_t n_waiting = context->n_inbox;
    while (n_waiting-- > 0 && n_run < limit && context_is_live(context) &&
           callback_turn_is_free(context->library, context)) {
        struct instance *instance = inbox_take(context);
        if (instance == NULL) {
            break; /* a nested call has been faster, or the capacity is used up */
        }
        deliver(instance);
        flush_late_acknowledgements(context);
        n_run++;
    }
    return n_run;
}

static int run_all_messages(struct library *library, int limit)
{
    int n_run = 0;
    struct list *position = library->contexts.next;
    for (; position != &library->contexts && n_run < limit; position = position->next) {
        n_run += run_messages(context_at(position), limit - n_run);
    }
    return n_run;
}

static int run_events(struct library *library, enum listen_mode mode)
{
    if (mode == LISTEN_ONE) {
        const int n_run = run_all_messages(library, 1);
        return n_run > 0 ? n_run : watch_fd_run_ready(library, 1);
    }
    const int n_fds = watch_fd_run_ready(library, INT32_MAX);
    return n_fds + run_all_messages(library, INT32_MAX);
}

static void flush_acknowledgements(struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_connected(context) && inbox_first(context) == NULL &&
            link_waiting(&context->link) > 0) {
            (void)exchange_flush(context); /* a loss shows in the context's state */
        }
    }
}

/* Whether what has arrived must be known before anything runs: at the end of the time, and where a
 * message, even one that is still unread, goes before a descriptor. */
static bool is_urgent(const struct library *library, bool over, enum listen_mode mode)
{
    return over || (mode == LISTEN_ONE && !list_is_empty(&library->watched_fds));
}

static bool is_answered(const struct awaited *awaited)
{
    return awaited != NULL && (awaited->done || awaited->failed);
}

static enum listen_result rounds(struct library *library, uint64_t deadline_ns,
                                 enum listen_mode mode, const struct awaited *awaited)
{
    for (;;) {
        bool over = wait_is_over(deadline_ns);
        const uint64_t n_passes = library->timer_passes;
        timer_run_due(library);
        if (library->timer_passes != n_passes && wait_is_given_up(library)) {
            return LISTEN_GIVEN_UP;
        }
        if (awaited == NULL && context_current_live(library) == NULL) {
            return LISTEN_NOTHING; /* a timer has disconnected */
        }
        look(library, is_urgent(library, over, mode));
        if (is_answered(awaited)) {
            return LISTEN_NOTHING;
        }
        if (watch_fd_broken(library) >= 0) {
            return LISTEN_BAD_DESCRIPTOR;
        }
        if (run_events(library, mode) > 0) {
            timer_run_due(library);
            return LISTEN_HANDLED;
        }
        if (awaited == NULL && context_current_live(library) == NULL) {
            return LISTEN_DISCONNECTED;
        }
        if (over) {
            return LISTEN_NOTHING;
        }
        closing_settle(library); /* handlers may have ended their connections */
        if (!wait_turn(library, deadline_ns)) {
            return LISTEN_GIVEN_UP;
        }
        if (awaited == NULL && context_current_live(library) == NULL) {
            return LISTEN_DISCONNECTED;
        }
    }
}

static enum listen_result pass(struct library *library, uint64_t deadline_ns, enum listen_mode mode,
                               const struct awaited *awaited)
{
    library->listeners++;
    const enum listen_result result = rounds(library, deadline_ns, mode, awaited);
    flush_acknowledgements(library);
    closing_settle(library);
    library->listeners--;
    return result;
}

enum listen_result listen_pass(struct library *library, uint64_t deadline_ns, enum listen_mode mode)
{
    return context_current_live(library) != NULL ? pass(library, deadline_ns, mode, NULL)
                                                 : LISTEN_DISCONNECTED;
}

enum listen_result listen_pass_for(struct library *library, uint64_t deadline_ns,
                                   const struct awaited *awaited)
{
    return pass(library, deadline_ns, LISTEN_BATCH, awaited);
}
