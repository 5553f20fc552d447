/*
 * Descriptors of the user.
 */
#include "libipc/watch_fd.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/callback.h"
#include "libipc/report.h"
#include "libipc/wait.h"

static struct watched_fd *watched_at(struct list *position)
{
    return LIST_OWNER(position, struct watched_fd, source.in_library);
}

/* ------------------------------------------------------------------ as a source */

static struct watched_fd *watched_of(const struct source *source)
{
    return LIST_OWNER(source, struct watched_fd, source);
}

static int wanted(const struct source *source)
{
    const struct watched_fd *watched = watched_of(source);
    return watched->ready || watched->broken ? NOT_WANTED : READY_READ;
}

static void mark(struct source *source, int found)
{
    struct watched_fd *watched = watched_of(source);
    watched->broken = (found & READY_INVALID) != 0;
    watched->ready = !watched->broken;
}

static const struct source_kind watched_kind = {NULL, wanted, mark};

/* ------------------------------------------------------------------- the list */

/* The entry of fd, or the place before which it belongs. */
static struct list *place_of(struct library *library, int fd)
{
    struct list *position = library->watched_fds.next;
    while (position != &library->watched_fds && watched_at(position)->source.fd < fd) {
        position = position->next;
    }
    return position;
}

static struct watched_fd *watched_find(struct library *library, int fd)
{
    struct list *place = place_of(library, fd);
    const bool found = place != &library->watched_fds && watched_at(place)->source.fd == fd;
    return found ? watched_at(place) : NULL;
}

static void replace(struct watched_fd *watched, FD_HANDLER_TYPE handler, void *client_data)
{
    if (watched->handler != handler) {
        report_warning("WARNING: Handler function replaced for fd %d\n", watched->source.fd);
    }
    if (watched->client_data != client_data) {
        report_warning("WARNING: Replacing client data for fd %d\n", watched->source.fd);
    }
    watched->handler = handler;
    watched->client_data = client_data;
}

void watch_fd_add(struct library *library, int fd, FD_HANDLER_TYPE handler, void *client_data)
{
    const struct _X_IPC_CONTEXT *context = context_current_live(library);
    struct watched_fd *watched = watched_find(library, fd);
    if (context != NULL && !context->will_listen) {
        report_warning("WARNING: Subscribing to port %d, but have connected no-listen\n", fd);
    }
    if (watched != NULL) {
        replace(watched, handler, client_data);
        return;
    }
    watched = mem_new(sizeof *watched);
    source_init(&watched->source, &watched_kind, fd);
    watched->handler = handler;
    watched->client_data = client_data;
    watched->context = context_current_live(library);
    list_insert(place_of(library, fd), &watched->source.in_library);
    if (fd > library->max_fd) {
        library->max_fd = fd;
    }
    wait_changed(library);
}

void watch_fd_remove(struct library *library, int fd)
{
    struct watched_fd *watched = watched_find(library, fd);
    if (watched != NULL) {
        wait_remove(library, &watched->source);
        free(watched);
        wait_changed(library);
    }
}

/* -------------------------------------------------------------------- calling */

/* In the context that the descriptor belongs to, as long as that has not ended. */
static void call(struct library *library, struct watched_fd *watched)
{
    struct running running = callback_of(library, watched->context, NO_ID);
    const FD_HANDLER_TYPE handler = watched->handler;
    void *client_data = watched->client_data;
    const int fd = watched->source.fd;
    watched->ready = false;
    callback_begin(library, &running); /* the entry may be gone from here on */
    handler(fd, client_data);
    callback_end(library, &running);
}

/*
 * Whether there is still something to read.  Another handler or another thread may have read it since
 * the wait in the kernel, and a handler called for nothing would wait for ever.
 */
static bool is_still_ready(struct watched_fd *watched)
{
    struct ready_item item = {watched->source.fd, READY_READ, 0};
    watched->ready = ready_wait(&item, 1, 0) > 0 && (item.found & READY_INVALID) == 0;
    return watched->ready;
}

/* The ready one with the smallest descriptor above last whose turn is free. */
static struct watched_fd *next_ready(struct library *library, int last)
{
    struct list *position = library->watched_fds.next;
    for (; position != &library->watched_fds; position = position->next) {
        struct watched_fd *watched = watched_at(position);
        if (watched->source.fd > last && watched->ready &&
            callback_turn_is_free(library, watched->context) && is_still_ready(watched)) {
            return watched;
        }
    }
    return NULL;
}

int watch_fd_run_ready(struct library *library, int limit)
{
    int n_run = 0;
    int last = -1;
    struct watched_fd *watched = next_ready(library, last);
    while (watched != NULL && n_run < limit) {
        last = watched->source.fd;
        call(library, watched);
        n_run++;
        watched = next_ready(library, last);
    }
    return n_run;
}

void watch_fd_poll(struct library *library)
{
    struct source_list list;
    if (list_is_empty(&library->watched_fds)) {
        return;
    }
    source_list_init(&list, library);
    source_list_add(&list, &library->watched_fds);
    if (list.count > 1 && ready_wait(list.items, list.count, 0) > 0) {
        for (size_t i = 1; i < list.count; i++) {
            if (list.items[i].found != 0) {
                mark(list.sources[i], list.items[i].found);
            }
        }
    }
    source_list_fini(&list);
}

int watch_fd_broken(const struct library *library)
{
    struct list *position = library->watched_fds.next;
    for (; position != &library->watched_fds; position = position->next) {
        if (watched_at(position)->broken) {
            return watched_at(position)->source.fd;
        }
    }
    return -1;
}

void watch_fd_clear(struct library *library)
{
    while (!list_is_empty(&library->watched_fds)) {
        struct watched_fd *watched = watched_at(library->watched_fds.next);
        wait_remove(library, &watched->source);
        free(watched);
    }
}
