/*
 * Handlers and subscriptions.
 */
#include "central/model/handler.h"

#include <stdlib.h>

#include "base/memory.h"
#include "central/settings/limits.h"
#include "central/model/module.h"

struct handler *handler_find(const struct module *module, const char *name)
{
    return table_find(&module->handlers, name);
}

struct handler *handler_get(struct module *module, const char *name, int id)
{
    struct handler *handler = handler_find(module, name);
    if (handler != NULL || module->handlers.count >= LIMIT_HANDLERS) {
        return handler;
    }
    handler = mem_new(sizeof *handler);
    handler->name = mem_copy_string(name);
    handler->id = id;
    handler->module = module;
    handler->resource = module->own;
    list_init(&handler->subscriptions);
    (void)table_put(&module->handlers, name, handler); /* replaces nothing */
    return handler;
}

void handler_free_all(struct module *module)
{
    for (struct table_entry *entry = table_first(&module->handlers); entry != NULL;
         entry = table_next(&module->handlers, entry)) {
        struct handler *handler = entry->value;
        free(handler->name);
        free(handler);
    }
    table_fini(&module->handlers);
}

struct subscription *subscription_find(const struct handler *handler, const struct message *message)
{
    struct list *at, *following;
    LIST_EACH (at, following, &handler->subscriptions) {
        struct subscription *subscription = LIST_OWNER(at, struct subscription, in_handler);
        if (subscription->message == message) {
            return subscription;
        }
    }
    return NULL;
}

struct subscription *subscription_new(struct handler *handler, struct message *message)
{
    struct subscription *subscription = mem_new(sizeof *subscription);
    subscription->handler = handler;
    subscription->message = message;
    list_append(&handler->subscriptions, &subscription->in_handler);
    list_append(&message->subscriptions, &subscription->in_message);
    list_init(&subscription->in_due);
    handler->n_subscriptions++;
    message->n_subscriptions++;
    return subscription;
}

void subscription_detach(struct subscription *subscription)
{
    if (!list_is_empty(&subscription->in_message)) {
        list_remove(&subscription->in_message);
        list_remove(&subscription->in_due);
        subscription->message->n_subscriptions--;
    }
}

void subscription_free(struct subscription *subscription)
{
    subscription_detach(subscription);
    list_remove(&subscription->in_handler);
    subscription->handler->n_subscriptions--;
    free(subscription);
}

struct subscription *subscription_oldest(const struct message *message)
{
    return list_is_empty(&message->subscriptions)
               ? NULL
               : LIST_OWNER(message->subscriptions.next, struct subscription, in_message);
}

struct subscription *subscription_latest(const struct message *message)
{
    return list_is_empty(&message->subscriptions)
               ? NULL
               : LIST_OWNER(message->subscriptions.previous, struct subscription, in_message);
}
