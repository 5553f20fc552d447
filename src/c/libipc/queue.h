/*
 * Queue control: how much central gives this module at once, and what waits.
 */
#ifndef IPC_LIBIPC_QUEUE_H
#define IPC_LIBIPC_QUEUE_H

#include "libipc/context.h"

IPC_ERROR_TYPE queue_set_capacity(struct _X_IPC_CONTEXT *context, int capacity);
IPC_ERROR_TYPE queue_set_limit(struct _X_IPC_CONTEXT *context, const char *name, int limit);
IPC_ERROR_TYPE queue_set_priority(struct _X_IPC_CONTEXT *context, const char *name, int priority);

/* Queues all settings, for a central that does not know them. */
void queue_tell_all(struct _X_IPC_CONTEXT *context);

#endif
