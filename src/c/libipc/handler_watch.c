/*
 * Watching the list of a message's handlers.
 */
#include "libipc/handler_watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/subscription.h"
#include "libipc/watcher.h"

/* Takes the list over. */
static void set_list(struct _X_IPC_CONTEXT *context, struct message *message,
                     struct handler_list *list)
{
    const struct format *format = context->library->catalogue.handler_list;
    (void)format_release(format, &message->handlers); /* a list of the library's own is sound */
    message->handlers = *list;
    message->handlers_known = true;
    message->targets_stale = true;
}

static bool list_changed(struct _X_IPC_CONTEXT *context, struct handler *handler,
                         const struct frame *frame)
{
    const struct format *format = context->library->catalogue.handler_list;
    struct message *message =
        registry_get(context, handler->message->name + sizeof VARIABLE_WATCH - 1);
    struct handler_list list;
    if (payload_decode(format, frame->data, frame->data_length, (enum byte_order)frame->data_order,
                       &list) != 0) {
        return true;
    }
    set_list(context, message, &list);
    return watcher_tell_change(context, message, frame);
}

/* Name of the broadcast of the list; the caller frees it. */
static char *watch_name(const struct message *message)
{
    const size_t size = sizeof VARIABLE_WATCH + strlen(message->name);
    char *name = mem_new(size);
    snprintf(name, size, "%s%s", VARIABLE_WATCH, message->name);
    return name;
}

IPC_ERROR_TYPE handler_watch_start(struct _X_IPC_CONTEXT *context, struct message *message)
{
    if (message->handlers_watched) {
        return IPC_No_Error;
    }
    message->handlers_watched = true;
    char *watched = watch_name(message);
    char *name = mem_copy_string(message->name);
    IPC_ERROR_TYPE error = exchange_notice(context, LM_WATCH_HANDLERS, &name);
    if (error == IPC_No_Error) {
        error = subscription_add_internal(context, watched, list_changed);
    }
    free(watched);
    free(name);
    return error;
}

void handler_watch_tell_all(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        const struct message *message = entry->value;
        if (message->handlers_watched) {
            exchange_tell(context, LM_WATCH_HANDLERS, &message->name);
        }
    }
}

IPC_ERROR_TYPE handler_watch_stop(struct _X_IPC_CONTEXT *context, struct message *message)
{
    if (!message->handlers_watched || message->id < 0) {
        return IPC_No_Error;
    }
    message->handlers_watched = false;
    char *watched = watch_name(message);
    const IPC_ERROR_TYPE error = subscription_remove(context, watched);
    free(watched);
    return error;
}

IPC_ERROR_TYPE handler_watch_ask(struct _X_IPC_CONTEXT *context, struct message *message)
{
    struct handler_list list;
    const IPC_ERROR_TYPE error = exchange_ask(context, LM_HANDLERS, &message->name, &list);
    if (error == IPC_No_Error) {
        set_list(context, message, &list);
    }
    return error;
}
