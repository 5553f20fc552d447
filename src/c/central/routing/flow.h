/*
 * Flow control: which deliveries go now, and which wait.
 *
 * Decides by capacity, queue, limits, locks and unsent bytes.  Who gets a
 * message at all is decided before (route.h); how it is sent, after (deliver.h).
 */
#ifndef IPC_CENTRAL_FLOW_H
#define IPC_CENTRAL_FLOW_H

#include "central/routing/server.h"

/*
 * A new dispatch, whose handler is set, goes to its handler or into its queue.
 * shared is the block that keeps the frame's data, or NULL: see dispatch_keep.
 */
void flow_enter(struct server *server, struct dispatch *dispatch, struct block **shared);

/* A new dispatch, which keeps its data, waits until somebody handles its message. */
void flow_wait_for_handler(struct server *server, struct dispatch *dispatch, struct block **shared);

/* The same, for a dispatch that its module has lost. */
void flow_wait_again(struct server *server, struct dispatch *dispatch);

/* Somebody does: all that wait for such a handler move to its queue. */
void flow_adopt(struct server *server, struct message *message, struct handler *handler);

/* Sends what waits and may go now. */
void flow_release(struct server *server, struct resource *resource);
void flow_release_all(struct server *server, struct module *module);

/* Whether a delivery from that sender would go at once. */
bool flow_is_free(const struct server *server, struct resource *resource,
                  const struct module *sender);

/* Moves what waits for a handler from its resource to another one of its module. */
void flow_move(struct server *server, struct handler *handler, struct resource *to);

/* Ends everything that is active or waits in a resource of a module that has ended, or moves it to
 * a list of what is to be sent again. */
void flow_clear(struct server *server, struct resource *resource, struct list *lost);

/* Ends an active dispatch whose receiver has reported it finished. */
void flow_finish(struct server *server, struct dispatch *dispatch);

#endif
