/*
 * The handlers that all modules have for a message, as central keeps the list.
 *
 * Two want to know: whoever has subscribed to changes, and direct mode, which
 * sends to the listed modules.
 */
#ifndef IPC_LIBIPC_HANDLER_WATCH_H
#define IPC_LIBIPC_HANDLER_WATCH_H

#include "libipc/context.h"
#include "libipc/registry.h"

/* Has central keep message->handlers up to date from now on. */
IPC_ERROR_TYPE handler_watch_start(struct _X_IPC_CONTEXT *context, struct message *message);

/* Queues that for all messages with which it was so, for a central that does not know it. */
void handler_watch_tell_all(struct _X_IPC_CONTEXT *context);

/* Ends that, unless direct mode still needs it. */
IPC_ERROR_TYPE handler_watch_stop(struct _X_IPC_CONTEXT *context, struct message *message);

/* Asks for the list as it is now. */
IPC_ERROR_TYPE handler_watch_ask(struct _X_IPC_CONTEXT *context, struct message *message);

#endif
