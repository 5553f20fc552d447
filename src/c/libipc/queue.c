/*
 * Queue control.  The inbox keeps the same limits and priorities as central.
 */
#include "libipc/queue.h"

#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/registry.h"

static void tell_message(struct _X_IPC_CONTEXT *context, const struct message *message)
{
    if (message->queue_limit != 0) {
        const struct pending_limit pending = {message->name, context->module_name,
                                              message->queue_limit};
        exchange_tell(context, LM_LIMIT_PENDING, &pending);
    }
    if (message->priority >= 0) {
        const struct name_and_number setting = {message->name, message->priority};
        exchange_tell(context, LM_PRIORITY, &setting);
    }
}

void queue_tell_all(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    if (context->capacity != 1) {
        const struct number_and_name resource = {context->capacity, context->module_name};
        exchange_tell(context, LM_RESOURCE, &resource);
    }
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        tell_message(context, entry->value);
    }
}

IPC_ERROR_TYPE queue_set_capacity(struct _X_IPC_CONTEXT *context, int capacity)
{
    const struct number_and_name resource = {capacity, context->module_name};
    context->capacity = capacity;
    const IPC_ERROR_TYPE error = exchange_notice(context, LM_RESOURCE, &resource);
    return error == IPC_No_Error && context->direct ? direct_announce(context) : error;
}

IPC_ERROR_TYPE queue_set_limit(struct _X_IPC_CONTEXT *context, const char *name, int limit)
{
    struct message *message = registry_get(context, name);
    const struct pending_limit pending = {message->name, context->module_name, limit};
    message->queue_limit = limit;
    return exchange_notice(context, LM_LIMIT_PENDING, &pending);
}

IPC_ERROR_TYPE queue_set_priority(struct _X_IPC_CONTEXT *context, const char *name, int priority)
{
    struct message *message = registry_get(context, name);
    const struct name_and_number setting = {message->name, priority};
    message->priority = priority;
    return exchange_notice(context, LM_PRIORITY, &setting);
}
