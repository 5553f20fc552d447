/*
 * The library's state: making it, and locking it.
 */
#include "libipc/library.h"

#include <stdlib.h>
#include <string.h>

/* Where everything is reached from, but for what the program chooses about texts (report.c). */
static struct library the_library;

/* What the environment says follows a loss of central where the program says nothing. */
static IPCX_RECONNECT reconnect_of(const char *text)
{
    if (text == NULL) {
        return IPCX_RECONNECT_NEVER;
    }
    return strcmp(text, "fail") == 0   ? IPCX_RECONNECT_FAIL
           : strcmp(text, "wait") == 0 ? IPCX_RECONNECT_WAIT
                                       : IPCX_RECONNECT_NEVER;
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
    library->reconnect = reconnect_of(getenv("IPC_RECONNECT"));
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

struct library *library_at_end(void)
{
    return &the_library;
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
    if (!library->initialised) {
        library_restart(library);
    }
    if (library->waker.read_fd < 0) {
        (void)waker_open(&library->waker); /* without it other threads are only noticed later */
    }
    library->initialised = true;
    library->used = true;
}

struct running *library_running(const struct library *library)
{
    struct running *running = library->running;
    const uintptr_t thread = running != NULL ? thread_number() : 0;
    while (running != NULL && running->thread != thread) {
        running = running->outer;
    }
    return running;
}
