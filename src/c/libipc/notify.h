/*
 * Watching other modules come and go, and subscriptions change.
 */
#ifndef IPC_LIBIPC_NOTIFY_H
#define IPC_LIBIPC_NOTIFY_H

#include "libipc/context.h"
#include "libipc/instance.h"

struct watcher {
    struct list in_context; /* latest first */
    void (*function)(void); /* CONNECT_HANDLE_TYPE, CHANGE_HANDLE_TYPE or IPCX_CONNECTION_HANDLER */
    void *client_data;
    char *message; /* change watchers: which message, owned; else NULL */
};

enum module_event { MODULE_CONNECTS, MODULE_DISCONNECTS };

IPC_ERROR_TYPE notify_add(struct _X_IPC_CONTEXT *context, enum module_event event,
                          CONNECT_HANDLE_TYPE handler, void *client_data);
IPC_ERROR_TYPE notify_remove(struct _X_IPC_CONTEXT *context, enum module_event event,
                             CONNECT_HANDLE_TYPE handler);
IPC_ERROR_TYPE notify_add_change(struct _X_IPC_CONTEXT *context, const char *name,
                                 CHANGE_HANDLE_TYPE handler, void *client_data);
IPC_ERROR_TYPE notify_remove_change(struct _X_IPC_CONTEXT *context, const char *name,
                                    CHANGE_HANDLE_TYPE handler);

/* The list of a message's handlers has changed, as that frame of central says.  Returns whether
 * nobody watches, so that the frame is done with. */
bool notify_handlers_changed(struct _X_IPC_CONTEXT *context, const struct message *message,
                             const struct frame *frame);

/* Has watchers told that central has gone, or is back. */
void notify_connection(struct _X_IPC_CONTEXT *context, bool connected);

void notify_add_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler,
                           void *client_data);
void notify_remove_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler);

/* Calls the watchers of a notice. */
void notify_run(struct instance *notice);

void notify_clear(struct _X_IPC_CONTEXT *context);

#endif
