/*
 * Taking contexts apart.
 *
 * What a connection is made of knows nothing of its end, and the end knows all of it:
 * whoever finds the connection broken says so by context_lose, which comes here.
 */
#ifndef IPC_LIBIPC_CLOSING_H
#define IPC_LIBIPC_CLOSING_H

#include "libipc/context.h"

/* For context->lost: ends the context unless it is to come back. */
void closing_lost(struct _X_IPC_CONTEXT *context, bool noticed);

/* Ends the context for good.  The new state is CONTEXT_LOST or CONTEXT_CLOSED. */
void closing_end(struct _X_IPC_CONTEXT *context, enum context_state state);

/* Tells central and ends; the context is a husk then.  tell_central false: only this process's copy of
 * the connection. */
void closing_disconnect(struct _X_IPC_CONTEXT *context, bool tell_central);

/* Frees what ended connections have left behind, where no callback of theirs runs any more. */
void closing_settle(struct library *library);

#endif
