/*
 * Waiting in the kernel, one thread for all.
 */
#include "libipc/wait.h"

#include "libipc/event_set.h"

enum {
    ASK_MS = 200 /* a signal that comes just before a wait, or in another thread, does not end it */
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

/* ----------------------------------------------------------------- giving up */

bool wait_is_given_up(struct library *library)
{
    int (*const give_up)(void) = library->give_up;
    if (give_up == NULL) {
        return false;
    }
    library_leave(library);
    const bool given_up = give_up() != 0;
    mutex_lock(library->lock);
    library->ask_again_ns = clock_ns() + (uint64_t)ASK_MS * 1000000u;
    return given_up;
}

/* The end of one wait: the deadline, or when the program is to be asked next. */
static uint64_t end_of_turn(const struct library *library, uint64_t deadline_ns)
{
    return library->give_up != NULL && library->ask_again_ns < deadline_ns ? library->ask_again_ns
                                                                           : deadline_ns;
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

/* -------------------------------------------------------------------- sources */

void wait_add(struct library *library, struct source *source)
{
    list_append(&library->sources, &source->in_library);
    wait_changed(library);
}

void wait_remove(struct library *library, struct source *source)
{
    list_remove(&source->in_library);
    if (library->waiting != NULL) {
        source_list_forget(library->waiting, source);
    }
}

void wait_wake(struct library *library)
{
    if (library->polling) {
        waker_wake(&library->waker);
    }
    if (library->sleepers > 0) {
        condition_tell_all(library->changed);
    }
}

void wait_changed(struct library *library)
{
    wait_wake(library);
    event_set_update(library);
}

/* Writes what waits to be written.  Stops where that, or a loss, is what some thread waits for, and returns
 * whether it has. */
static bool write_all(struct library *library)
{
    struct list *position = library->sources.next;
    for (; position != &library->sources; position = position->next) {
        struct source *source = source_at(position);
        if (source->kind->write != NULL && source->kind->write(source)) {
            return true;
        }
    }
    return false;
}

static void take_found(const struct source_list *list, uint64_t now)
{
    for (size_t i = 0; i < list->count; i++) {
        struct source *source = list->sources[i];
        if (source != NULL && (list->items[i].found != 0 || source->due_ns <= now)) {
            source->kind->found(source, list->items[i].found);
        }
    }
}

uint64_t wait_due(const struct library *library)
{
    uint64_t due = NO_DEADLINE;
    struct list *position = library->sources.next;
    for (; position != &library->sources; position = position->next) {
        const struct source *source = source_at(position);
        due = source->due_ns < due ? source->due_ns : due;
    }
    return due;
}

/* -------------------------------------------------------------------- waiting */

/* Milliseconds until the deadline or the next timer, -1 for ever, rounded up so as not to wake
 * early. */
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

/* Returns whether anything was found. */
static bool wait_in_kernel(struct library *library, uint64_t deadline_ns)
{
    struct source_list list;
    source_list_init(&list, library);
    source_list_add(&list, &library->sources);
    if (library->listeners > 0) {
        source_list_add(&list, &library->watched_fds);
    }
    const uint64_t due = wait_due(library);
    const int64_t patience = patience_ms(library, due < deadline_ns ? due : deadline_ns);
    library->waiting = &list;
    library->polling = true;
    library_leave(library);
    const int found = ready_wait_or_signal(list.items, list.count, patience);
    mutex_lock(library->lock);
    library->polling = false;
    if (list.items[0].found != 0) {
        waker_clear(&library->waker);
    }
    if (found > 0 || due != NO_DEADLINE) {
        take_found(&list, due != NO_DEADLINE ? clock_ns() : 0);
    }
    library->waiting = NULL;
    if (library->sleepers > 0) {
        condition_tell_all(library->changed);
    }
    source_list_fini(&list);
    return found > 0;
}

/* Whether a source wants more by now than the thread in the kernel waits for. */
static bool is_more_wanted(const struct source_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        const struct source *source = list->sources[i];
        const int wanted = source != NULL ? source->kind->wanted(source) : NOT_WANTED;
        if (wanted != NOT_WANTED && (wanted & ~list->items[i].wanted) != 0) {
            return true;
        }
    }
    return false;
}

static void wait_for_other(struct library *library, uint64_t deadline_ns)
{
    if (is_more_wanted(library->waiting)) {
        waker_wake(&library->waker); /* there may be something to write that had room before */
    }
    library->sleepers++;
    condition_wait(library->changed, library->lock, deadline_ns);
    library->sleepers--;
}

bool wait_turn(struct library *library, uint64_t deadline_ns)
{
    if (write_all(library)) {
        return true;
    }
    const uint64_t end_ns = end_of_turn(library, deadline_ns);
    bool any = false;
    if (library->polling) {
        wait_for_other(library, end_ns);
    } else {
        any = wait_in_kernel(library, end_ns);
    }
    /* What has come is looked at first: to ask takes longer. */
    return any || !wait_is_given_up(library);
}
