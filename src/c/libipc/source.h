/*
 * Sources: whatever a wait in the kernel may be for.
 *
 * The connection to central, links to other modules, listeners, descriptors of the user,
 * and tries to come back: each embeds a source.  A wait (wait.h) asks every source what
 * it wants and tells it what was found, and knows nothing else of it.
 */
#ifndef IPC_LIBIPC_SOURCE_H
#define IPC_LIBIPC_SOURCE_H

#include "libipc/library.h"

#define NO_DEADLINE UINT64_MAX

/* What source_kind.wanted says of a descriptor that is not to be waited for now. */
enum { NOT_WANTED = -1 };

struct source;

/* None of these waits. */
struct source_kind {
    /* Before a wait: writes what waits to be written.  Returns whether that, or a loss, is what some
     * thread waits for; only then may sources have come or gone.  NULL: there never is anything. */
    bool (*write)(struct source *source);
    /* READY_READ | READY_WRITE, or NOT_WANTED. */
    int (*wanted)(const struct source *source);
    /* After a wait: what the descriptor is ready for, or 0 when the source's time has come.  Any
     * source may come or go, this one too. */
    void (*found)(struct source *source, int found);
};

struct source {
    struct list in_library; /* in library->sources, or in library->watched_fds */
    const struct source_kind *kind;
    int fd;          /* -1: none */
    uint64_t due_ns; /* found is called then at the latest; NO_DEADLINE: there is no such time */
};

/* What one wait is for.  The first item is the waker's and has no source. */
struct source_list {
    struct ready_item *items;
    struct source **sources; /* one for each item; NULL: it has gone since */
    size_t count;
    size_t capacity;
    struct ready_item few_items[16];
    struct source *few_sources[16];
};

static inline struct source *source_at(struct list *position)
{
    return LIST_OWNER(position, struct source, in_library);
}

/* Not in a list yet; see wait_add. */
void source_init(struct source *source, const struct source_kind *kind, int fd);

/* Lists the waker alone. */
void source_list_init(struct source_list *list, const struct library *library);

/* Adds those of library->sources or library->watched_fds that are to be waited for now. */
void source_list_add(struct source_list *list, struct list *sources);

/* Takes a source out that is about to go. */
void source_list_forget(struct source_list *list, const struct source *source);

void source_list_fini(struct source_list *list);

#endif
