/*
 * Subscriptions of this module.
 */
#include "libipc/subscription.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/report.h"

char *subscription_name(const char *message, HANDLER_TYPE function)
{
    const uintptr_t address = (uintptr_t)function;
    const size_t size = strlen(message) + 32;
    char *name = mem_new(size);
    snprintf(name, size, "HND-%s%" PRIuPTR, message, address);
    return name;
}

static struct handler *handler_get(struct _X_IPC_CONTEXT *context, const char *handler_name)
{
    struct handler *handler = table_find(&context->handlers, handler_name);
    if (handler == NULL) {
        handler = mem_new(sizeof *handler);
        handler->name = mem_copy_string(handler_name);
        handler->id = idpool_take(&context->handler_ids, handler);
        list_init(&handler->in_context);
        (void)table_put(&context->handlers, handler_name, handler); /* new: replaces nothing */
    }
    return handler;
}

static void begin(struct _X_IPC_CONTEXT *context, struct handler *handler, const char *message)
{
    handler->subscribed = true;
    handler->message = registry_get(context, message);
    list_remove(&handler->in_context);
    list_append(&context->subscribed, &handler->in_context);
}

static IPC_ERROR_TYPE tell(struct _X_IPC_CONTEXT *context, enum library_message which,
                           const struct handler *handler, int id, const char *message)
{
    /* The payload's strings are only read. */
    struct subscription_notice notice = {id, (char *)(uintptr_t)message, handler->name};
    return exchange_notice(context, which, &notice);
}

/* Central has worked off everything before the answer to a question, and the question asked
 * here is one that the first delivery would ask anyhow. */
static IPC_ERROR_TYPE await_central(struct _X_IPC_CONTEXT *context, const char *message)
{
    struct message *found;
    struct message *known = table_find(&context->messages, message);
    if (known == NULL || !known->known) {
        const IPC_ERROR_TYPE error = registry_find(context, message, false, &found);
        return error == IPC_Message_Not_Defined ? IPC_No_Error : error;
    }
    char *own_name = context->module_name;
    int connected;
    return exchange_ask(context, LM_IS_CONNECTED, &own_name, &connected);
}

/* The handler is subscribed already: only what it is called with can change. */
static void replace(struct handler *handler, HANDLER_TYPE function, void *client_data,
                    bool unmarshall)
{
    if (handler->function != function) {
        report_warning("\nWARNING: Procedure change ignored for existing handler %s.\n",
                       handler->name);
    }
    if (handler->client_data != client_data) {
        report_warning("Resetting client data for handler %s\n", handler->name);
    }
    handler->client_data = client_data;
    handler->unmarshall = unmarshall;
}

IPC_ERROR_TYPE subscription_add(struct _X_IPC_CONTEXT *context, const char *message,
                                const char *handler_name, HANDLER_TYPE function, void *client_data,
                                bool unmarshall)
{
    struct handler *handler = handler_get(context, handler_name);
    if (!context->will_listen) {
        report_warning("WARNING: Subscribing to %s, but have connected no-listen\n", message);
    }
    if (handler->subscribed) {
        replace(handler, function, client_data, unmarshall);
        return IPC_No_Error;
    }
    begin(context, handler, message);
    handler->function = function;
    handler->client_data = client_data;
    handler->unmarshall = unmarshall;
    handler->message->n_subscriptions++;
    /* Central keeps the number of the first registration; CMU IPC sends 0 with the others. */
    const int id = handler->registered ? 0 : (int)handler->id;
    handler->registered = true;
    const IPC_ERROR_TYPE error = tell(context, LM_SUBSCRIBE, handler, id, message);
    return error != IPC_No_Error ? error : await_central(context, message);
}

struct handler *subscription_prepare_internal(struct _X_IPC_CONTEXT *context, const char *message,
                                              subscription_internal internal)
{
    struct handler *handler = handler_get(context, message);
    handler->internal = internal;
    if (!handler->subscribed) {
        begin(context, handler, message);
    }
    return handler;
}

IPC_ERROR_TYPE subscription_add_internal(struct _X_IPC_CONTEXT *context, const char *message,
                                         subscription_internal internal)
{
    const struct handler *handler = subscription_prepare_internal(context, message, internal);
    const IPC_ERROR_TYPE error = tell(context, LM_SUBSCRIBE, handler, (int)handler->id, message);
    return error != IPC_No_Error ? error : await_central(context, message);
}

/* Ends a subscription here and at central.  The entry stays, for its number. */
static IPC_ERROR_TYPE end(struct _X_IPC_CONTEXT *context, struct handler *handler)
{
    handler->subscribed = false;
    list_remove(&handler->in_context);
    if (handler->internal == NULL) {
        handler->message->n_subscriptions--;
    }
    return tell(context, LM_UNSUBSCRIBE, handler, 0, handler->message->name);
}

IPC_ERROR_TYPE subscription_remove(struct _X_IPC_CONTEXT *context, const char *handler_name)
{
    struct handler *handler = table_find(&context->handlers, handler_name);
    return handler != NULL && handler->subscribed ? end(context, handler) : IPC_No_Error;
}

IPC_ERROR_TYPE subscription_remove_all(struct _X_IPC_CONTEXT *context, const char *message)
{
    IPC_ERROR_TYPE error = IPC_No_Error;
    const struct message *entry = table_find(&context->messages, message);
    struct table_entry *position = table_first(&context->handlers);
    while (position != NULL && error == IPC_No_Error && context_is_connected(context)) {
        struct handler *handler = position->value;
        if (handler->subscribed && handler->internal == NULL && handler->message == entry) {
            error = end(context, handler);
        }
        position = table_next(&context->handlers, position);
    }
    return error;
}

void subscription_tell_all(struct _X_IPC_CONTEXT *context)
{
    struct list *position = context->subscribed.next;
    for (; position != &context->subscribed; position = position->next) {
        struct handler *handler = LIST_OWNER(position, struct handler, in_context);
        /* The payload's strings are only read. */
        const struct subscription_notice notice = {(int)handler->id, handler->message->name,
                                                   handler->name};
        handler->registered = true;
        exchange_tell(context, LM_SUBSCRIBE, &notice);
    }
}

void subscription_lose(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *position = table_first(&context->handlers);
    for (; position != NULL; position = table_next(&context->handlers, position)) {
        struct handler *handler = position->value;
        handler->registered = false;
    }
}

void subscription_clear(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *position = table_first(&context->handlers);
    for (; position != NULL; position = table_next(&context->handlers, position)) {
        struct handler *handler = position->value;
        free(handler->name);
        free(handler);
    }
    list_init(&context->subscribed);
    table_fini(&context->handlers);
    table_init(&context->handlers, TABLE_FOLDING);
    idpool_fini(&context->handler_ids);
    idpool_init(&context->handler_ids);
}
