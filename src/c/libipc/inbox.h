/*
 * The inbox: instances that wait for their handlers, in the order in which
 * these run: by priority, then by arrival.
 */
#ifndef IPC_LIBIPC_INBOX_H
#define IPC_LIBIPC_INBOX_H

#include "libipc/instance.h"

/* Takes the instance over.  If its message has a limit that is reached, the oldest one makes room:
 * it is acknowledged and freed, and a warning is printed. */
void inbox_add(struct instance *instance);

/* The first instance that may run now; NULL: none. */
struct instance *inbox_first(struct _X_IPC_CONTEXT *context);

/* Whether one may run in any context that is live. */
bool inbox_is_any_waiting(const struct library *library);

/* Tells other event loops if one may: makes their set of descriptors readable. */
void inbox_tell(const struct library *library);

/* Takes it out. */
struct instance *inbox_take(struct _X_IPC_CONTEXT *context);

/* Central has gone: what has arrived is handled all the same, but for queries, which cannot be
 * answered any more. */
void inbox_lose(struct _X_IPC_CONTEXT *context);

/* Frees all of them. */
void inbox_clear(struct _X_IPC_CONTEXT *context);

#endif
