/*
 * Watchers and their notices.
 */
#include "libipc/watcher.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/callback.h"
#include "libipc/inbox.h"

struct watcher {
    struct list in_context; /* latest first */
    watcher_function function;
    void *client_data;
    char *message; /* change watchers: which message, owned; else NULL */
};

static struct watcher *watcher_at(struct list *position)
{
    return LIST_OWNER(position, struct watcher, in_context);
}

static bool is_about(const struct watcher *watcher, const char *message)
{
    return message == NULL || table_same_name(TABLE_FOLDING, watcher->message, message);
}

static struct watcher *watcher_find(struct list *watchers, watcher_function function,
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

void watcher_add(struct list *watchers, watcher_function function, const char *message,
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

bool watcher_is_any(struct list *watchers, const char *message)
{
    return watcher_find(watchers, NULL, message) != NULL;
}

static void watcher_free(struct watcher *watcher)
{
    list_remove(&watcher->in_context);
    free(watcher->message);
    free(watcher);
}

bool watcher_drop(struct list *watchers, watcher_function function, const char *message)
{
    struct watcher *watcher = watcher_find(watchers, function, message);
    if (watcher != NULL) {
        watcher_free(watcher);
    }
    return watcher != NULL;
}

/* -------------------------------------------------------------------- notices */

void watcher_queue_notice(struct _X_IPC_CONTEXT *context, int32_t dispatch, struct list *watchers,
                          char *name, int count)
{
    struct instance *notice = instance_new(context, INSTANCE_NOTICE);
    notice->dispatch = dispatch;
    notice->watchers = watchers;
    notice->notice_name = name;
    notice->notice_count = count;
    inbox_add(notice);
}

bool watcher_tell_change(struct _X_IPC_CONTEXT *context, const struct message *message,
                         const struct frame *frame)
{
    if (!watcher_is_any(&context->change_watchers, message->name)) {
        return true;
    }
    watcher_queue_notice(context, frame->reference, &context->change_watchers,
                         mem_copy_string(message->name), message->handlers.count);
    return false;
}

void watcher_tell_connection(struct _X_IPC_CONTEXT *context, bool connected)
{
    if (!list_is_empty(&context->connection_watchers)) {
        watcher_queue_notice(context, NO_ID, &context->connection_watchers, NULL, connected);
    }
}

/* A copy of what is to be called: watchers come and go while the others run. */
struct call {
    watcher_function function;
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

void watcher_run(struct instance *notice)
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

static void clear(struct list *watchers)
{
    while (!list_is_empty(watchers)) {
        watcher_free(watcher_at(watchers->next));
    }
}

void watcher_clear(struct _X_IPC_CONTEXT *context)
{
    clear(&context->connect_watchers);
    clear(&context->disconnect_watchers);
    clear(&context->change_watchers);
    clear(&context->connection_watchers);
}
