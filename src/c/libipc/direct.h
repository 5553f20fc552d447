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

/* Listens, and sets context->direct_port: 0 or ERR_IO. */
int direct_listen(struct _X_IPC_CONTEXT *context);

/* Queues the port for central. */
void direct_tell_port(struct _X_IPC_CONTEXT *context);

/* Tells central the port. */
IPC_ERROR_TYPE direct_announce(struct _X_IPC_CONTEXT *context);

/* Makes sure that the message's targets are known, connecting to them; none may be left. */
IPC_ERROR_TYPE direct_find_targets(struct _X_IPC_CONTEXT *context, struct message *message);

/* Calls add for every descriptor of other modules, and -1 for listeners that there are not. */
void direct_each_fd(struct _X_IPC_CONTEXT *context, void (*add)(void *set, int fd), void *set);

/* Takes in what has arrived from other modules. */
void direct_look(struct _X_IPC_CONTEXT *context);

/* Closes listeners and links. */
void direct_close(struct _X_IPC_CONTEXT *context);

#endif
