/*
 * One delivery: from being sent to being reported finished.
 */
#ifndef IPC_CENTRAL_DELIVER_H
#define IPC_CENTRAL_DELIVER_H

#include "central/routing/outbox.h"

/* Sends a dispatch to its handler; from_queue: it waited in its resource's queue (for the log). */
void deliver(struct server *server, struct dispatch *dispatch, bool from_queue);

/* Sends a dispatch before its turn, and (deliver_promote) makes it active when that has come. */
void deliver_ahead(struct server *server, struct dispatch *dispatch);
void deliver_promote(struct server *server, struct dispatch *dispatch);

/* Takes a dispatch that has been sent out of its resource, which may then have room. */
void deliver_leave(struct dispatch *dispatch);

/* The same, and frees it. */
void deliver_end(struct server *server, struct dispatch *dispatch);

#endif
