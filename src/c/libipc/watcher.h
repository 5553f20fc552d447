/*
 * Watchers: functions of the user that are told news of modules, subscriptions and
 * the connection.
 *
 * News become notices in the inbox, so that watchers run in listening calls like any
 * handler; what central has sent is acknowledged when they have run.
 */
#ifndef IPC_LIBIPC_WATCHER_H
#define IPC_LIBIPC_WATCHER_H

#include "libipc/instance.h"

/* CONNECT_HANDLE_TYPE, CHANGE_HANDLE_TYPE or IPCX_CONNECTION_HANDLER. */
typedef void (*watcher_function)(void);

/* Adds one to a list of the context, or replaces its client data.  message: of change watchers, which;
 * of others NULL. */
void watcher_add(struct list *watchers, watcher_function function, const char *message,
                 void *client_data);

/* Removes it; false: there is none. */
bool watcher_drop(struct list *watchers, watcher_function function, const char *message);

/* Whether anybody watches that message, or (NULL) anything. */
bool watcher_is_any(struct list *watchers, const char *message);

/* Has the watchers of that list told.  dispatch: of the delivery of central that is the news, NO_ID:
 * none.  Takes name (malloc) over. */
void watcher_queue_notice(struct _X_IPC_CONTEXT *context, int32_t dispatch, struct list *watchers,
                          char *name, int count);

/* The list of a message's handlers has changed, as that frame of central says.  Returns whether
 * nobody watches, so that the frame is done with. */
bool watcher_tell_change(struct _X_IPC_CONTEXT *context, const struct message *message,
                         const struct frame *frame);

/* Has watchers told that central has gone, or is back. */
void watcher_tell_connection(struct _X_IPC_CONTEXT *context, bool connected);

/* Calls the watchers of a notice. */
void watcher_run(struct instance *notice);

void watcher_clear(struct _X_IPC_CONTEXT *context);

#endif
