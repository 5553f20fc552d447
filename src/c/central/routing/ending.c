/*
 * The end of a connection.
 *
 * The log says so, the socket closes, the handlers go, then the resources with
 * all that was on its way to the module; lists of handlers and the list of
 * active broadcasts are put right, and last everybody who wants to know is told.
 * What the module has sent to others stays on its way; what it has not finished
 * is sent again if that was asked for (resend.h).
 */
#include "central/routing/ending.h"

#include "central/routing/broadcasts.h"
#include "central/routing/claim.h"
#include "central/routing/flow.h"
#include "central/routing/handler_list.h"
#include "central/routing/notify.h"
#include "central/routing/resend.h"
#include "central/routing/start.h"

static void say(struct server *server, const struct module *module, enum ending why)
{
    struct log *log = &server->log;
    if (why == ENDING_NOTICE) {
        log_always(log,
                   "x_ipcClose: Closed Connection Detected from: sd: %d:\n"
                   "x_ipcClose: Closing %s on %s\n",
                   module->shown_fd, module->name, module->host);
    } else if (why == ENDING_LOSS) {
        log_status(log, "Closed Connection Detected from: sd: %d: \n", module->shown_fd);
        log_always(log, " Closing %s on %s\n", module->name, module->host);
    }
    log_always(log, "close Module: Closing %s\n", module->name);
}

/* Leaves every list of the server but that of the ended. */
static void withdraw(struct server *server, struct module *module)
{
    list_remove(&module->in_server);
    server->statistics.n_modules--;
    list_remove(&module->in_input);
    list_remove(&module->in_waiting_for);
    list_remove(&module->in_flush);
    list_remove(&module->in_due);
    list_remove(&module->in_condemned);
    if (module->state == MODULE_GREETED) {
        server->n_greeted--;
    } else {
        namesakes_remove(&server->module_names, module->name, &module->same_name);
    }
    list_remove(&module->in_state);
}

/* Detaches all subscriptions and moves them into a list of their own. */
static void take_subscriptions(struct module *module, struct list *taken)
{
    struct list *at, *following;
    for (struct table_entry *entry = table_first(&module->handlers); entry != NULL;
         entry = table_next(&module->handlers, entry)) {
        struct handler *handler = entry->value;
        LIST_EACH (at, following, &handler->subscriptions) {
            subscription_detach(LIST_OWNER(at, struct subscription, in_handler));
            list_remove(at);
            list_append(taken, at);
        }
    }
}

static void free_resources(struct server *server, struct module *module)
{
    struct list *at, *following;
    LIST_EACH (at, following, &module->resources) {
        struct resource *resource = LIST_OWNER(at, struct resource, in_owner);
        struct list lost;
        list_init(&lost);
        claim_end_of_resource(server, resource);
        flow_clear(server, resource, &lost);
        resend(server, resource->name, &lost);
        list_remove(at);
        namesakes_remove(&server->resource_names, resource->name, &resource->same_name);
        resource_free(resource);
    }
    module->own = NULL;
}

/* Tells who handles the messages of these subscriptions now, and which broadcasts are active; frees
 * the subscriptions. */
static void tell_changes(struct server *server, struct list *taken)
{
    bool changed = false;
    struct list *at, *following;
    LIST_EACH (at, following, taken) {
        LIST_OWNER(at, struct subscription, in_handler)->message->has_lost_handlers = true;
    }
    LIST_EACH (at, following, taken) {
        struct message *message = LIST_OWNER(at, struct subscription, in_handler)->message;
        if (message->has_lost_handlers) {
            message->has_lost_handlers = false;
            handler_list_changed(server, message); /* once, however many it has lost */
        }
    }
    LIST_EACH (at, following, taken) {
        struct subscription *subscription = LIST_OWNER(at, struct subscription, in_handler);
        struct message *message = subscription->message;
        changed |= broadcasts_put(server, message, message->n_subscriptions);
        subscription_free(subscription);
    }
    if (changed) {
        broadcasts_tell(server);
    }
}

static void release_what_it_holds(struct server *server, struct module *module)
{
    struct resource *resource;
    claim_withdraw_all(server, module);
    while ((resource = claim_give_back_any(server, module)) != NULL) {
        flow_release(server, resource);
    }
}

void ending(struct server *server, struct module *module, enum ending why)
{
    struct list taken;
    if (module->state == MODULE_ENDED) {
        return;
    }
    say(server, module, why);
    const bool was_introduced = module_is_introduced(module);
    start_withdraw(server, module);
    withdraw(server, module);
    module_enter(module, MODULE_ENDED);
    if (server->poller != NULL && module->link.fd >= 0) {
        poller_remove(server->poller, module->link.fd);
    }
    link_fini(&module->link);
    module_drop_later(module);
    list_append(&server->ended, &module->in_state);
    list_init(&taken);
    take_subscriptions(module, &taken);
    free_resources(server, module);
    release_what_it_holds(server, module);
    tell_changes(server, &taken);
    handler_free_all(module);
    table_fini(&module->provides);
    table_fini(&module->needs);
    if (was_introduced) {
        notify(server, LM_DISCONNECTED, module);
    }
}

void ending_for_violation(struct server *server, struct module *module, const char *reason)
{
    if (module->state == MODULE_ENDED) {
        return;
    }
    log_warning(&server->log, module, "%s", reason);
    ending(server, module, ENDING_LOSS);
}

void ending_carry_out(struct server *server)
{
    while (!list_is_empty(&server->condemned)) { /* each may condemn more */
        ending(server, LIST_OWNER(server->condemned.next, struct module, in_condemned),
               ENDING_LOSS);
    }
}

void ending_sweep(struct server *server)
{
    struct list *at, *following;
    LIST_EACH (at, following, &server->ended) {
        list_remove(at);
        module_unref(LIST_OWNER(at, struct module, in_state));
    }
}
