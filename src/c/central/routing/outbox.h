/*
 * The way out: frames queue on the links of modules, and links that have
 * something to write are remembered until the end of the turn.
 *
 * New values of watched variables are written before anything that came later:
 * a publisher that asks the kernel for what is there must find the new list of
 * subscribed messages before anybody can know that the subscription was made.  So
 * from the first change in a turn on all other frames are held, until the values
 * have been written to everybody; and however many changes a turn brings, each module is
 * told once:
 *
 *     handled      queued on links          held            written
 *     subscribe A
 *     sync of A                             answer to A
 *     subscribe B
 *     sync of B                             answer to B
 *     (settled)    list with A and B
 *                                                           the list, to all who watch
 *                                                           the answers
 */
#ifndef IPC_CENTRAL_OUTBOX_H
#define IPC_CENTRAL_OUTBOX_H

#include "central/routing/server.h"

enum outbox_urgency { OUTBOX_NORMAL, OUTBOX_FIRST };

/* Queues a frame for a module, unless it is gone. */
void outbox_queue(struct server *server, struct module *module, const struct frame *frame,
                  enum outbox_urgency urgency);

/* Queues raw bytes, which are the first ones of a connection. */
void outbox_queue_raw(struct server *server, struct module *module, const void *bytes,
                      size_t count);

/* The values have been written: what was held may follow. */
void outbox_let_go(struct server *server);

/* Has the loop look after the module's socket at the end of the turn. */
void outbox_attend(struct server *server, struct module *module);

/* Whether deliveries may be taken from the module's queues: not too much is unsent. */
bool outbox_has_room(const struct server *server, struct module *module);

#endif
