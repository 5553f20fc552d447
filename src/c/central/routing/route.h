/*
 * Routing: who gets a message.
 *
 * A publication goes to every handler, oldest subscription first; a query, or
 * an inform of an old module, to exactly one.
 */
#ifndef IPC_CENTRAL_ROUTE_H
#define IPC_CENTRAL_ROUTE_H

#include "central/routing/server.h"

/* Routes a frame to the handlers of a user's message or a notice; sender NULL: the server. */
void route_broadcast(struct server *server, struct module *sender, const struct frame *frame,
                     struct message *message);

/* Routes a frame to one handler, or lets it wait for one. */
void route_to_one(struct server *server, struct module *sender, const struct frame *frame,
                  struct message *message);

/* The oldest handler that takes a delivery from that sender at once; else the one with the shortest
 * queue; NULL when there is none. */
struct handler *route_choose(const struct server *server, const struct message *message,
                             const struct module *sender);

#endif
