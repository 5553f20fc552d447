/*
 * Messages that a full queue has lost: each is counted, and the log tells once
 * per burst which message of whom is lost to whom, and how many at its end.
 *
 * A burst begins with the first loss and ends when nothing waits in the queue
 * any more.
 */
#ifndef IPC_CENTRAL_DROPS_H
#define IPC_CENTRAL_DROPS_H

#include "central/routing/server.h"

/* Counts a dispatch that the resource's queue is about to lose. */
void drops_count(struct server *server, struct resource *resource, const struct dispatch *dispatch);

/* The burst is over. */
void drops_tell_end(struct server *server, struct resource *resource);

/* The same if there is one. */
static inline void drops_end_burst(struct server *server, struct resource *resource)
{
    if (!list_is_empty(&resource->losses)) {
        drops_tell_end(server, resource);
    }
}

#endif
