/*
 * Watching modules and subscriptions.
 */
#include "libipc/notify.h"

#include "libipc/handler_watch.h"
#include "libipc/registry.h"
#include "libipc/subscription.h"
#include "libipc/watcher.h"

static bool take_module_event(struct _X_IPC_CONTEXT *context, const struct frame *frame,
                              struct list *watchers)
{
    char *name = NULL;
    const struct format *format = context->library->catalogue.request[LM_CONNECTED];
    if (payload_decode(format, frame->data, frame->data_length, (enum byte_order)frame->data_order,
                       &name) != 0 ||
        name == NULL) {
        return true; /* nothing that anybody could be told */
    }
    watcher_queue_notice(context, frame->reference, watchers, name, 0);
    return false;
}

static bool take_connect(struct _X_IPC_CONTEXT *context, struct handler *handler,
                         const struct frame *frame)
{
    (void)handler;
    return take_module_event(context, frame, &context->connect_watchers);
}

static bool take_disconnect(struct _X_IPC_CONTEXT *context, struct handler *handler,
                            const struct frame *frame)
{
    (void)handler;
    return take_module_event(context, frame, &context->disconnect_watchers);
}

/* ---------------------------------------------------------------- subscribing */

static struct list *watchers_of(struct _X_IPC_CONTEXT *context, enum module_event event)
{
    return event == MODULE_CONNECTS ? &context->connect_watchers : &context->disconnect_watchers;
}

static const char *broadcast_of(enum module_event event)
{
    return library_messages[event == MODULE_CONNECTS ? LM_CONNECTED : LM_DISCONNECTED].name;
}

IPC_ERROR_TYPE notify_add(struct _X_IPC_CONTEXT *context, enum module_event event,
                          CONNECT_HANDLE_TYPE handler, void *client_data)
{
    struct list *watchers = watchers_of(context, event);
    const bool first = list_is_empty(watchers);
    watcher_add(watchers, (watcher_function)handler, NULL, client_data);
    if (!first) {
        return IPC_No_Error;
    }
    return subscription_add_internal(context, broadcast_of(event),
                                     event == MODULE_CONNECTS ? take_connect : take_disconnect);
}

IPC_ERROR_TYPE notify_remove(struct _X_IPC_CONTEXT *context, enum module_event event,
                             CONNECT_HANDLE_TYPE handler)
{
    struct list *watchers = watchers_of(context, event);
    if (!watcher_drop(watchers, (watcher_function)handler, NULL) || !list_is_empty(watchers)) {
        return IPC_No_Error;
    }
    return subscription_remove(context, broadcast_of(event));
}

IPC_ERROR_TYPE notify_add_change(struct _X_IPC_CONTEXT *context, const char *name,
                                 CHANGE_HANDLE_TYPE handler, void *client_data)
{
    struct message *message;
    const IPC_ERROR_TYPE error = registry_find(context, name, true, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    watcher_add(&context->change_watchers, (watcher_function)handler, message->name, client_data);
    return handler_watch_start(context, message);
}

IPC_ERROR_TYPE notify_remove_change(struct _X_IPC_CONTEXT *context, const char *name,
                                    CHANGE_HANDLE_TYPE handler)
{
    struct message *message = table_find(&context->messages, name);
    if (message == NULL ||
        !watcher_drop(&context->change_watchers, (watcher_function)handler, name) ||
        watcher_is_any(&context->change_watchers, name)) {
        return IPC_No_Error;
    }
    return handler_watch_stop(context, message);
}

void notify_add_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler,
                           void *client_data)
{
    watcher_add(&context->connection_watchers, (watcher_function)handler, NULL, client_data);
}

void notify_remove_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler)
{
    (void)watcher_drop(&context->connection_watchers, (watcher_function)handler, NULL);
}
