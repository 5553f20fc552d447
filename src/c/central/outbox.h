/*
 * The way out: frames queue on the links of modules, and links that have
 * something to write are remembered until the end of the turn.
 *
 * New values of watched variables are written before anything else is even queued:
 * a publisher that asks the kernel for what is there must find the new list of
 * subscribed messages before anybody can know that the subscription was made.  Many
 * changes in a row are still written as one.
 */
#ifndef IPC_CENTRAL_OUTBOX_H
#define IPC_CENTRAL_OUTBOX_H

#include "central/server.h"

enum outbox_urgency { OUTBOX_NORMAL, OUTBOX_FIRST };

/* Queues a frame for a module, unless it is gone. */
void outbox_queue(struct server *server, struct module *module, const struct frame *frame,
                  enum outbox_urgency urgency);

/* Queues raw bytes. */
void outbox_queue_raw(struct server *server, struct module *module, const void *bytes,
                      size_t count);

/* Has the loop look after the module's socket at the end of the turn. */
void outbox_attend(struct server *server, struct module *module);

/* Whether deliveries may be taken from the module's queues: not too much is unsent. */
bool outbox_has_room(const struct server *server, struct module *module);

#endif
