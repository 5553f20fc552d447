/*
 * The library's state: making it, locking it, and leaving it for callbacks.
 */
#include "libipc/library.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/context.h"
#include "libipc/reconnect.h"
#include "libipc/wait.h"

/* The one mutable static of the library; everything else is reached from here. */
static struct library the_library;

/*
 * The process ends: files of sockets would outlive it.  Without the lock, since a signal handler may
 * have called exit() while this thread held it; contexts are never freed.
 */
static void library_end(void)
{
    struct list *position = the_library.contexts.next;
    for (; position != &the_library.contexts; position = position->next) {
        net_remove_local(&context_at(position)->direct_local);
    }
}

static void library_make(void)
{
    struct library *library = &the_library;
    library->lock = mutex_new();
    library->changed = condition_new();
    library->waker.read_fd = library->waker.write_fd = -1;
    list_init(&library->sources);
    list_init(&library->contexts);
    table_init(&library->formatters, TABLE_EXACT);
    list_init(&library->timers);
    idpool_init(&library->timer_ids);
    library->next_timer_ns = UINT64_MAX;
    list_init(&library->watched_fds);
    idpool_init(&library->instances);
    list_init(&library->spare_instances);
    intmap_init(&library->known_arrays);
    list_init(&library->known_order);
    buffer_init(&library->scratch);
    library->names = format_names_new();
    const char *empty_strings = getenv("IPC_EMPTY_STRINGS");
    format_set_empty_strings(empty_strings != NULL && strcmp(empty_strings, "1") == 0);
    library->reconnect = reconnect_default();
    (void)atexit(library_end); /* at worst a stale file stays */
}

struct library *library_enter(void)
{
    thread_once(library_make);
    mutex_lock(the_library.lock);
    return &the_library;
}

void library_leave(struct library *library)
{
    mutex_unlock(library->lock);
}

/* What is made once and kept, whatever happens to the connections. */
static void library_prepare(struct library *library)
{
    if (library->variable_wire != NULL) {
        return;
    }
    /* Neither can fail but for lack of memory, with which no program starts. */
    (void)catalogue_init(&library->catalogue);
    (void)format_parse("{int, <byte:1>}", NULL, &library->variable_wire, NULL);
}

/* A new life after the last connection has ended: what belonged to the old one is forgotten. */
static void library_restart(struct library *library)
{
    if (library->used && !library->names_busy) {
        format_names_free(library->names);
        library->names = format_names_new();
    }
    library->exit_procedure = NULL;
}

void library_initialise(struct library *library)
{
    library_prepare(library);
    if (!library->initialised && !library_any_live(library)) {
        library_restart(library);
    }
    if (library->waker.read_fd < 0) {
        (void)waker_open(&library->waker); /* without it other threads are only noticed later */
    }
    library->initialised = true;
    library->used = true;
}

/* ---------------------------------------------------------------- contexts */

struct running *library_running(const struct library *library)
{
    struct running *running = library->running;
    const uintptr_t thread = running != NULL ? thread_number() : 0;
    while (running != NULL && running->thread != thread) {
        running = running->outer;
    }
    return running;
}

struct _X_IPC_CONTEXT *library_context(const struct library *library)
{
    const struct running *running = library_running(library);
    return running != NULL && running->context != NULL ? running->context : library->current;
}

static struct _X_IPC_CONTEXT *if_live(struct _X_IPC_CONTEXT *context)
{
    return context != NULL && context_is_live(context) ? context : NULL;
}

struct _X_IPC_CONTEXT *library_live(const struct library *library)
{
    return if_live(library_context(library));
}

struct _X_IPC_CONTEXT *library_connected(const struct library *library)
{
    struct _X_IPC_CONTEXT *context = library_context(library);
    return context != NULL && context_is_connected(context) ? context : NULL;
}

bool library_any_live(const struct library *library)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &library->contexts) {
        if (context_is_live(context_at(position))) {
            return true;
        }
    }
    return false;
}

bool library_is_ready(const struct library *library)
{
    return library->initialised || library_live(library) != NULL;
}

/* --------------------------------------------------------------- callbacks */

/* The one that callbacks of a live context take, or (NULL) those of no context. */
static struct turn *turn_of(struct library *library, struct _X_IPC_CONTEXT *context)
{
    return context != NULL ? &context->turn : &library->turn;
}

bool library_turn_is_free(struct library *library, struct _X_IPC_CONTEXT *context)
{
    const struct turn *turn = turn_of(library, if_live(context));
    return turn->thread == 0 || turn->thread == thread_number();
}

struct running library_call(struct library *library, struct _X_IPC_CONTEXT *context,
                            int32_t dispatch)
{
    struct running running;
    memset(&running, 0, sizeof running);
    running.context = if_live(context);
    running.turn = turn_of(library, running.context);
    running.dispatch = dispatch;
    return running;
}

void library_call_begin(struct library *library, struct running *running)
{
    running->thread = thread_number();
    running->outer = library->running;
    library->running = running;
    running->turn->thread = running->thread;
    running->turn->depth++;
    library_leave(library);
}

void library_call_end(struct library *library, struct running *running)
{
    mutex_lock(library->lock);
    struct running **link = &library->running;
    while (*link != running) {
        link = &(*link)->outer;
    }
    *link = running->outer;
    if (--running->turn->depth == 0) {
        running->turn->thread = 0;
        wait_wake(library); /* others may have waited for their turn */
    }
}
