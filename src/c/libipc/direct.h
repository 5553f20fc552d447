/*
 * Direct mode: links between two modules, without central in between.
 *
 * Where central asks for it, this module listens on a port of its own and tells
 * central which.  A message whose number is negative goes to the handlers that
 * central lists, over one outgoing link per module.  Others open links to here.
 * A module that cannot be reached is left out; the rest goes on.
 */
#ifndef IPC_LIBIPC_DIRECT_H
#define IPC_LIBIPC_DIRECT_H

#include "libipc/context.h"
#include "libipc/registry.h"

/* A link to or from another module. */
struct peer {
    struct list in_context;
    struct _X_IPC_CONTEXT *context;
    struct link link;    /* fd -1 once it is closed */
    unsigned references; /* the context's list, and instances that may be answered over it */
    bool incoming;
    char *host; /* outgoing: where to; owned */
    int port;
};

/* Where a direct message goes. */
struct direct_target {
    int32_t handler;
    struct peer *peer; /* NULL: cannot be reached */
};

struct peer *peer_ref(struct peer *peer);

/* NULL is fine. */
void peer_unref(struct peer *peer);

/* The link has broken or its other end has gone: closes it. */
void direct_peer_ended(struct peer *peer);

/* Listens, and sets context->direct_port: 0 or ERR_IO. */
int direct_listen(struct _X_IPC_CONTEXT *context);

/* Queues the port for central. */
void direct_tell_port(struct _X_IPC_CONTEXT *context);

/* Tells central the port. */
IPC_ERROR_TYPE direct_announce(struct _X_IPC_CONTEXT *context);

/* Makes sure that the message's targets are known, connecting to them; none may be left. */
IPC_ERROR_TYPE direct_find_targets(struct _X_IPC_CONTEXT *context, struct message *message);

/* Waits until everything up to mark has left over the peer's link; the link may break meanwhile. */
void direct_drain(struct peer *peer, uint64_t mark);

/* Adds what is to be waited for: calls add for every descriptor. */
void direct_each_fd(struct _X_IPC_CONTEXT *context,
                    void (*add)(void *waiting, int fd, int wanted, struct _X_IPC_CONTEXT *context),
                    void *waiting);

/* A descriptor of the list above is ready. */
void direct_ready(struct _X_IPC_CONTEXT *context, int fd, int found);

/* Takes in what has arrived from other modules. */
void direct_look(struct _X_IPC_CONTEXT *context);

/* Forgets where a message goes. */
void direct_forget_targets(struct message *message);

/* Closes listeners and links. */
void direct_close(struct _X_IPC_CONTEXT *context);

#endif
