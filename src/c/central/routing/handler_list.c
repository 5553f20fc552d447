/*
 * Who handles a message, and how its modules can be reached directly.
 */
#include "central/routing/handler_list.h"

#include <stdlib.h>

#include "base/memory.h"
#include "central/routing/value.h"

static void fill_in(struct handler_address *address, const struct handler *handler)
{
    address->id = handler->id;
    address->port = handler->module->direct_port;
    address->host = handler->module->host;
    address->module = handler->module->name;
}

/* How many handlers are told of: for other messages than broadcasts only the newest counts. */
static size_t told(const struct message *message)
{
    if (message->direct && message->n_subscriptions > LIMIT_DIRECT_HANDLERS) {
        return 0;
    }
    if (message_is_defined(message) && message->class != CLASS_BROADCAST) {
        return message->n_subscriptions > 0;
    }
    return message->n_subscriptions;
}

void handler_list_init(struct server *server, struct handler_list *list,
                       const struct message *message)
{
    const size_t n_told = told(message);
    if (n_told == 0 && message->n_subscriptions > 0) {
        log_always(&server->log, "Too many handlers for %s; Must send through central\n",
                   message->name);
    }
    list->handlers = mem_new(n_told * sizeof *list->handlers);
    list->count = 0;
    for (struct list *at = message->subscriptions.previous;
         at != &message->subscriptions && (size_t)list->count < n_told; at = at->previous) {
        const struct subscription *subscription = LIST_OWNER(at, struct subscription, in_message);
        fill_in(&list->handlers[list->count++], subscription->handler);
    }
}

void handler_list_fini(struct handler_list *list)
{
    free(list->handlers);
    list->handlers = NULL;
}

void handler_list_changed(struct server *server, const struct message *message)
{
    struct handler_list list;
    if (message->handlers == NULL) {
        return;
    }
    handler_list_init(server, &list, message);
    value_set_own(server, message->handlers, &list);
    handler_list_fini(&list);
}

void handler_list_keep(struct server *server, struct message *message)
{
    message->handlers_wanted = true;
    if (message->handlers != NULL || !message_is_defined(message)) {
        return;
    }
    message->handlers = variable_define_own(server, message->name, FORMAT_HANDLER_LIST,
                                            server->catalogue.handler_list);
    handler_list_changed(server, message);
}
