/*
 * Watching modules and subscriptions.
 *
 * Central's broadcasts become notices in the inbox, so that watchers run in
 * listening calls like any handler, and are acknowledged when they have run.
 */
#include "libipc/notify.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/callback.h"
#include "libipc/exchange.h"
#include "libipc/handler_watch.h"
#include "libipc/inbox.h"
#include "libipc/registry.h"
#include "libipc/subscription.h"

typedef void (*any_function)(void);

static struct watcher *watcher_at(struct list *position)
{
    return LIST_OWNER(position, struct watcher, in_context);
}

static bool is_about(const struct watcher *watcher, const char *message)
{
    return message == NULL || table_same_name(TABLE_FOLDING, watcher->message, message);
}

static struct watcher *watcher_find(struct list *watchers, any_function function,
                                    const char *message)
{
    struct list *position = watchers->next;
    for (; position != watchers; position = position->next) {
        struct watcher *watcher = watcher_at(position);
        if ((function == NULL || watcher->function == function) && is_about(watcher, message)) {
            return watcher;
        }
    }
    return NULL;
}

static void watcher_add(struct list *watchers, any_function function, const char *message,
                        void *client_data)
{
    struct watcher *watcher = watcher_find(watchers, function, message);
    if (watcher == NULL) {
        watcher = mem_new(sizeof *watcher);
        watcher->function = function;
        watcher->message = mem_copy_string(message);
        list_prepend(watchers, &watcher->in_context);
    }
    watcher->client_data = client_data;
}

static void watcher_free(struct watcher *watcher)
{
    list_remove(&watcher->in_context);
    free(watcher->message);
    free(watcher);
}

static bool watcher_drop(struct list *watchers, any_function function, const char *message)
{
    struct watcher *watcher = watcher_find(watchers, function, message);
    if (watcher != NULL) {
        watcher_free(watcher);
    }
    return watcher != NULL;
}

/* -------------------------------------------------------------------- notices */

/* dispatch: of the delivery of central that is the news, NO_ID: none. */
static void queue_notice(struct _X_IPC_CONTEXT *context, int32_t dispatch, struct list *watchers,
                         char *name, int count)
{
    struct instance *notice = instance_new(context, INSTANCE_NOTICE);
    notice->dispatch = dispatch;
    notice->watchers = watchers;
    notice->notice_name = name;
    notice->notice_count = count;
    inbox_add(notice);
}

static bool take_module_event(struct _X_IPC_CONTEXT *context, const struct frame *frame,
                              struct list *watchers)
{
    char *name = NULL;
    const struct format *format = context->library->catalogue.request[LM_CONNECTED];
    if (payload_decode(format, frame->data, frame->data_length,
                       (enum byte_order)frame->data_order, &name) != 0 ||
        name == NULL) {
        return true; /* nothing that anybody could be told */
    }
    queue_notice(context, frame->reference, watchers, name, 0);
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

bool notify_handlers_changed(struct _X_IPC_CONTEXT *context, const struct message *message,
                             const struct frame *frame)
{
    if (watcher_find(&context->change_watchers, NULL, message->name) == NULL) {
        return true;
    }
    queue_notice(context, frame->reference, &context->change_watchers,
                 mem_copy_string(message->name), message->handlers.count);
    return false;
}

void notify_connection(struct _X_IPC_CONTEXT *context, bool connected)
{
    if (!list_is_empty(&context->connection_watchers)) {
        queue_notice(context, NO_ID, &context->connection_watchers, NULL, connected);
    }
}

/* A copy of what is to be called: watchers come and go while the others run. */
struct call {
    any_function function;
    void *client_data;
};

static size_t list_calls(const struct instance *notice, const char *message, struct call **calls)
{
    size_t n_calls = 0;
    size_t room = 0;
    struct list *position = notice->watchers->next;
    *calls = NULL;
    for (; position != notice->watchers; position = position->next) {
        const struct watcher *watcher = watcher_at(position);
        if (is_about(watcher, message)) {
            if (n_calls == room) {
                room = room == 0 ? 4 : room * 2;
                *calls = mem_resize(*calls, room, sizeof **calls);
            }
            (*calls)[n_calls].function = watcher->function;
            (*calls)[n_calls++].client_data = watcher->client_data;
        }
    }
    return n_calls;
}

static void run(struct instance *notice, const struct call *call)
{
    struct _X_IPC_CONTEXT *context = notice->context;
    struct running running = callback_of(context->library, context, notice->dispatch);
    const char *name = notice->notice_name;
    callback_begin(context->library, &running);
    if (notice->watchers == &context->change_watchers) {
        ((CHANGE_HANDLE_TYPE)call->function)(name, notice->notice_count, call->client_data);
    } else if (notice->watchers == &context->connection_watchers) {
        ((IPCX_CONNECTION_HANDLER)call->function)(notice->notice_count, call->client_data);
    } else {
        ((CONNECT_HANDLE_TYPE)call->function)(name, call->client_data);
    }
    callback_end(context->library, &running);
}

void notify_run(struct instance *notice)
{
    struct _X_IPC_CONTEXT *context = notice->context;
    struct call *calls;
    const bool change = notice->watchers == &context->change_watchers;
    const size_t n_calls = list_calls(notice, change ? notice->notice_name : NULL, &calls);
    for (size_t i = 0; i < n_calls && context_is_live(context); i++) {
        run(notice, &calls[i]);
    }
    free(calls);
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
    watcher_add(watchers, (any_function)handler, NULL, client_data);
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
    if (!watcher_drop(watchers, (any_function)handler, NULL) || !list_is_empty(watchers)) {
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
    watcher_add(&context->change_watchers, (any_function)handler, message->name, client_data);
    return handler_watch_start(context, message);
}

IPC_ERROR_TYPE notify_remove_change(struct _X_IPC_CONTEXT *context, const char *name,
                                    CHANGE_HANDLE_TYPE handler)
{
    struct message *message = table_find(&context->messages, name);
    if (message == NULL ||
        !watcher_drop(&context->change_watchers, (any_function)handler, name) ||
        watcher_find(&context->change_watchers, NULL, name) != NULL) {
        return IPC_No_Error;
    }
    return handler_watch_stop(context, message);
}

void notify_add_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler,
                           void *client_data)
{
    watcher_add(&context->connection_watchers, (any_function)handler, NULL, client_data);
}

void notify_remove_connection(struct _X_IPC_CONTEXT *context, IPCX_CONNECTION_HANDLER handler)
{
    (void)watcher_drop(&context->connection_watchers, (any_function)handler, NULL);
}

static void clear(struct list *watchers)
{
    while (!list_is_empty(watchers)) {
        watcher_free(watcher_at(watchers->next));
    }
}

void notify_clear(struct _X_IPC_CONTEXT *context)
{
    clear(&context->connect_watchers);
    clear(&context->disconnect_watchers);
    clear(&context->change_watchers);
    clear(&context->connection_watchers);
}
