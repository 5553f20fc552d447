/*
 * Peers: links to or from other modules, and who refers to them.
 *
 * A link that has broken is closed at once; the peer stays until the last reference
 * to it has gone.  Making them is the business of direct mode (direct.h).
 */
#ifndef IPC_LIBIPC_PEER_H
#define IPC_LIBIPC_PEER_H

#include "libipc/context.h"

struct peer {
    struct list in_context;
    struct source source; /* of the link */
    struct _X_IPC_CONTEXT *context;
    struct link link;    /* fd -1 once it is closed */
    unsigned references; /* the context's list, and instances that may be answered over it */
    bool incoming;
    char *host; /* outgoing: where to; owned */
    int port;
};

static inline struct peer *peer_at(struct list *position)
{
    return LIST_OWNER(position, struct peer, in_context);
}

/* Adds a link over that socket, which waits from now on are for, to the context's list. */
struct peer *peer_new(struct _X_IPC_CONTEXT *context, const struct source_kind *kind, int fd,
                      bool incoming);

struct peer *peer_ref(struct peer *peer);

/* NULL is fine. */
void peer_unref(struct peer *peer);

/* Closes the link and takes the peer off the list; who still refers to it sees that. */
void peer_close(struct peer *peer);

/* The link has broken or its other end has gone: says so and closes it. */
void peer_end(struct peer *peer);

/* Writes what waits to be written, as far as the kernel takes it. */
void peer_flush(struct peer *peer);

/* Waits until everything up to mark has left over the link, which may break meanwhile: the caller holds a
 * reference. */
void peer_drain(struct peer *peer, uint64_t mark);

#endif
