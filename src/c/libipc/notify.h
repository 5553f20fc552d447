/*
 * Watching other modules come and go, and subscriptions change.
 */
#ifndef IPC_LIBIPC_NOTIFY_H
#define IPC_LIBIPC_NOTIFY_H

#include "libipc/context.h"

enum module_event { MODULE_CONNECTS, MODULE_DISCONNECTS };

IPC_ERROR_TYPE notify_add(struct _X_IPC_CONTEXT *context, enum module_event event,
                          CONNECT_HANDLE_TYPE handler, void *client_data);
IPC_ERROR_TYPE notify_remove(struct _X_IPC_CONTEXT *context, enum module_event event,
                             CONNECT_HANDLE_TYPE handler);
IPC_ERROR_TYPE notify_add_change(struct _X_IPC_CONTEXT *context, const char *name,
                                 CHANGE_HANDLE_TYPE handler, void *client_data);
IPC_ERROR_TYPE notify_remove_change(struct _X_IPC_CONTEXT *context, const char *name,
                                    CHANGE_HANDLE_TYPE handler);

void notify_add_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler,
                           void *client_data);
void notify_remove_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler);

#endif
