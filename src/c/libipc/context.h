/*
 * Contexts: one connection to one central, with everything that depends on it.
 *
 * A context is never freed, because programs keep its address; when its
 * connection has ended it is an empty husk that says so.
 *
 *     connecting -> connected -> lost -> closed
 *         ^             |
 *         +--- away <---+    if the program wants it to come back (reconnect.h)
 */
#ifndef IPC_LIBIPC_CONTEXT_H
#define IPC_LIBIPC_CONTEXT_H

#include "libipc/source.h"
#include "link/link.h"

struct reconnect;

enum { GREETING_PARTS = 3 }; /* a number and two frames */

enum context_state {
    CONTEXT_CONNECTING, /* handshake under way */
    CONTEXT_CONNECTED,
    CONTEXT_AWAY,  /* the connection broke, and another one is tried to be had */
    CONTEXT_LOST,  /* the connection broke and nobody has been told yet */
    CONTEXT_CLOSED /* a husk */
};

/* A reply that somebody waits for: an answer of central, or the response to a query. */
struct awaited {
    int32_t reference;
    bool done;
    bool failed;   /* the connection ended first */
    uint8_t *data; /* malloc block, the waiter's once done; NULL for no data */
    size_t length;
    enum byte_order order;
    char *name;  /* message of the response, malloc; NULL in answers of central */
    bool notify; /* a malloc'ed one whose handler is to be called */
    HANDLER_TYPE handler;
    void *client_data;
};

struct _X_IPC_CONTEXT {
    struct list in_library;
    struct library *library;
    enum context_state state;
    void (*lost)(struct _X_IPC_CONTEXT *context,
                 bool noticed); /* closing_lost; its maker sets it */
    bool unseen;        /* no program has got its address, and none does before it is connected */
    unsigned greeting;  /* parts of central's greeting taken so far, GREETING_PARTS: all */
    bool shown_as_lost; /* the exit procedure runs for it: IPC_getContext gives it */
    bool loss_noticed;  /* by reading: the call that noticed reports it */
    char *server_name;  /* as given to connect, owned; kept in the husk */
    char *module_name;
    int port;
    char address[NET_NAME_SIZE]; /* where central was found, numeric; "" by Unix socket */
    bool will_listen;
    IPCX_RECONNECT reconnect; /* what follows a loss */
    struct reconnect *away;   /* from a loss until central is back; else NULL; owned */
    unsigned connection;      /* grows at every loss: what came over another one is stale */
    bool local;               /* by Unix socket: what central has written is there at once */
    bool new_central;         /* central of this project: its promises may be relied on */

    struct link link;
    struct source source; /* of the link, once that is waited for (receive_start) */
    unsigned writers;     /* threads that wait for what they have queued to be written */
    bool try_first;       /* the last attempt to read found something */
    int32_t last_reference;
    int32_t library_ids[LM_COUNT]; /* 0: not looked up yet */
    struct intmap awaited;         /* reference -> struct awaited */

    struct table messages;  /* name -> struct message */
    struct table handlers;  /* handler name -> struct handler, for the life of the connection */
    struct list subscribed; /* of struct handler, oldest subscription first */
    struct idpool handler_ids;

    struct list inbox; /* of struct instance, in the order in which they run */
    size_t n_inbox;
    size_t inbox_bytes;       /* content in it */
    int capacity;             /* deliveries of central that may be handled at a time */
    int active;               /* those being handled, or answered later */
    unsigned unfinished;      /* deliveries of central not yet acknowledged */
    uint64_t acknowledged_ns; /* when the oldest acknowledgement that waits was queued, 0: none */
    struct list delayed;      /* of struct instance, response still to come */
    struct turn turn;

    struct table broadcasts; /* names that have subscribers, valid if broadcasts_known */
    bool broadcasts_known;

    bool direct;              /* central wants modules to be linked with each other */
    int direct_port;          /* where others reach this module, 0: nowhere */
    struct source direct_tcp; /* listeners, fd -1: none */
    struct source direct_unix;
    struct net_local direct_local; /* the latter's file */
    struct list peers;             /* of struct peer */
    unsigned draining;             /* threads that wait for a peer to take bytes */

    struct list connect_watchers; /* of struct watcher, latest first */
    struct list disconnect_watchers;
    struct list change_watchers;
    struct list connection_watchers;
};

/* A context in state connecting over that socket; the current one stays what it is. */
struct _X_IPC_CONTEXT *context_new(struct library *library, int fd, const char *module_name,
                                   const char *server_name, int port, bool will_listen);

static inline bool context_is_connected(const struct _X_IPC_CONTEXT *context)
{
    return context->state == CONTEXT_CONNECTED;
}

static inline bool context_is_open(const struct _X_IPC_CONTEXT *context)
{
    return context->state == CONTEXT_CONNECTED || context->state == CONTEXT_CONNECTING;
}

static inline bool context_has_ended(const struct _X_IPC_CONTEXT *context)
{
    return context->state == CONTEXT_LOST || context->state == CONTEXT_CLOSED;
}

/* Still connected, and by that connection of the context. */
static inline bool context_is_connected_as(const struct _X_IPC_CONTEXT *context,
                                           unsigned connection)
{
    return context_is_connected(context) && context->connection == connection;
}

/* Connected, or going to be again: handlers, timers and descriptors belong to it. */
static inline bool context_is_live(const struct _X_IPC_CONTEXT *context)
{
    return context->state == CONTEXT_CONNECTED || context->away != NULL;
}

static inline struct _X_IPC_CONTEXT *context_at(struct list *position)
{
    return LIST_OWNER(position, struct _X_IPC_CONTEXT, in_library);
}

/* The handshake is done. */
void context_connected(struct _X_IPC_CONTEXT *context);

/* Tells central that a delivery is finished; the frame leaves with the next write. */
void context_acknowledge(struct _X_IPC_CONTEXT *context, int32_t dispatch);

/* Whether pointer is a context of this library, closed or not. */
bool context_is_known(const struct library *library, const struct _X_IPC_CONTEXT *pointer);

/* The context that calls of this thread act on: NULL in state fresh; may be closed. */
struct _X_IPC_CONTEXT *context_current(const struct library *library);

/* The same if it is connected, else NULL. */
struct _X_IPC_CONTEXT *context_current_connected(const struct library *library);

/* The same if it is connected or going to be again, else NULL. */
struct _X_IPC_CONTEXT *context_current_live(const struct library *library);

/* context (may be NULL) if it is connected or going to be again, else NULL. */
struct _X_IPC_CONTEXT *context_if_live(struct _X_IPC_CONTEXT *context);

/* Whether any context is connected or going to be again. */
bool context_any_live(const struct library *library);

/* The connection of an open context broke: what depends on it is told (context->lost).  noticed: found
 * by a call that may report it right away. */
void context_lose(struct _X_IPC_CONTEXT *context, bool noticed);

/* A lost context that is to be reported now, which closes it; NULL: none.  all: also those that
 * a failed write found. */
struct _X_IPC_CONTEXT *context_take_loss(struct library *library, bool all);

#endif
