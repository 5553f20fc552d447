/*
 * Back-pressure: whoever outpaces a receiver that works waits for it.
 *
 * While more than half of what may wait for a resource waits there, and its
 * module goes on finishing deliveries, the senders that fill it are not read;
 * the kernel makes them wait in turn.  For a receiver that has finished nothing
 * for a while nobody waits: it loses its oldest messages (flow.h).  So no two
 * modules can wait for each other for longer than that.  This is the standard
 * policy; queues with another one (when_full.h) make nobody wait.
 */
#ifndef IPC_CENTRAL_BACKPRESSURE_H
#define IPC_CENTRAL_BACKPRESSURE_H

#include "central/routing/server.h"

/* A delivery of that sender (NULL: the server itself) has been put into the resource's queue. */
void backpressure_apply(struct server *server, struct module *sender, struct resource *resource);

/* Deliveries may have left the queue: who waits for it goes on if it has room again. */
void backpressure_ease(struct server *server, struct resource *resource);

/* Who waits for the resource goes on. */
void backpressure_end(struct server *server, struct resource *resource);

/* The sender goes on if it waits. */
void backpressure_let_go(struct server *server, struct module *sender);

/* Gives up waiting for those that finish nothing; returns when to look again, UINT64_MAX: never. */
uint64_t backpressure_check(struct server *server);

#endif
