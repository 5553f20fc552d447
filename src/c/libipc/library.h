/*
 * The library's state in this process.
 *
 * There is one struct library, because the API has one current context, one
 * verbosity and one set of timers and descriptors.  Every function below the API
 * takes it, or a context that leads to it, as an argument.
 *
 * One lock guards all of it.  An API function enters (takes the lock), works, and
 * leaves.  The lock is given up only inside wait_turn, while the kernel waits, and
 * from callback_begin to callback_end, while a user's function runs; whoever holds
 * pointers across one of these looks again at what may have changed.
 */
#ifndef IPC_LIBIPC_LIBRARY_H
#define IPC_LIBIPC_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ipc/ipc.h"
#include "ipc/ipcx.h"

#include "base/buffer.h"
#include "base/idpool.h"
#include "base/intmap.h"
#include "base/list.h"
#include "base/table.h"
#include "format/format.h"
#include "format/names.h"
#include "platform/platform.h"
#include "wire/catalogue.h"

struct _X_IPC_CONTEXT;
struct source_list;

/* Which thread runs callbacks on behalf of something, and how deeply nested. */
struct turn {
    uintptr_t thread; /* 0: nobody */
    unsigned depth;
};

/* One callback that is running; lives on the stack of the thread that runs it. */
struct running {
    struct running *outer; /* of any thread, in library.running */
    uintptr_t thread;
    struct turn *turn;              /* that it takes */
    struct _X_IPC_CONTEXT *context; /* current for this thread; NULL: the process-wide one */
    int32_t dispatch;               /* parent of what the callback sends, NO_ID: none */
    const void *content;            /* byte array that the callback was given, or NULL */
    size_t content_length;
    enum byte_order content_order;
};

struct library {
    struct mutex *lock;
    struct condition *changed; /* told whenever something that a waiting thread may want changes */
    struct list sources;       /* what that may be: all struct source but the user's descriptors */
    bool polling;              /* a thread waits in the kernel for all others */
    struct source_list *waiting; /* what it waits for, or is looking at after the wait; else NULL */
    unsigned sleepers;           /* threads that wait for it in turn */
    unsigned listeners;          /* threads inside a listening call */
    int (*give_up)(void);  /* whether the thread that asks should wait no longer; NULL: never */
    uint64_t ask_again_ns; /* until when a wait may last without its being asked */
    struct waker waker;    /* ends the wait in the kernel */

    bool initialised;     /* always while a context is live (context.h) */
    bool used;            /* has ever been initialised: errors may end the process */
    struct list contexts; /* of struct _X_IPC_CONTEXT, also closed ones: they are never freed */
    struct _X_IPC_CONTEXT *current; /* may be closed */
    struct running *running;        /* innermost of all threads */
    struct turn turn;               /* of timers and descriptors that no context owns */
    void (*exit_procedure)(void);
    bool in_exit_procedure;
    bool removes_files;       /* at the end of the process (direct.c) */
    IPCX_RECONNECT reconnect; /* what follows a loss in contexts to come */

    struct catalogue catalogue;
    struct format *variable_wire; /* wire format of variable-length messages */
    struct format_names *names;
    bool names_busy;         /* a thread parses; names must not change */
    struct table formatters; /* canonical text -> struct format, kept for ever */

    struct list timers; /* in the order in which they were added */
    struct idpool timer_ids;
    uint64_t next_timer_ns;   /* earliest due time, UINT64_MAX: none */
    uint64_t timer_passes;    /* times that due timers were looked for */
    struct poller *event_set; /* for other event loops; NULL: nobody has asked for it */
    int *event_fds;           /* what is in it */
    size_t n_event_fds;
    struct list watched_fds; /* of struct source, in ascending order */
    int max_fd;              /* largest descriptor that was ever waited for */
    struct idpool instances; /* numbers behind MSG_INSTANCE */
    struct list spare_instances;

    struct intmap known_arrays; /* address -> struct known_array */
    struct list known_order;    /* oldest first */
    struct buffer scratch;      /* for encoding; empty while a thread uses it */
};

/* Takes the lock; makes the library at the first call. */
struct library *library_enter(void);

/* Gives the lock back. */
void library_leave(struct library *library);

/* The library without its lock, for what the end of the process does. */
struct library *library_at_end(void);

/* Puts the library into state initialised if it is fresh or disconnected. */
void library_initialise(struct library *library);

/* The innermost callback of this thread, or NULL. */
struct running *library_running(const struct library *library);

#endif
