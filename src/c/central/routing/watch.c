/*
 * Those who watch a variable get its new value, and only the newest.
 */
#include "central/routing/watch.h"

#include "central/routing/deliver.h"
#include "central/routing/variable.h"

/* Values under way to one handler: a module that reads but does not report has no claim to more. */
enum { LIMIT_IN_FLIGHT = 1000 };

/* before_others: something else is about to be sent, so the value goes even behind unsent ones. */
static bool may_go(const struct subscription *subscription, bool before_others)
{
    const struct module *module = subscription->handler->module;
    if (module->state != MODULE_READY) {
        return false;
    }
    if (subscription->in_flight == 0) {
        return true;
    }
    return module->in_order && subscription->in_flight < LIMIT_IN_FLIGHT &&
           (before_others || module->link.written >= subscription->mark);
}

static void send_value(struct server *server, struct subscription *subscription)
{
    struct handler *handler = subscription->handler;
    const struct variable *variable = subscription->message->variable;
    struct frame frame;
    frame_init(&frame, CLASS_BROADCAST);
    frame.data = variable->value->bytes;
    frame.data_length = (uint32_t)variable->value->length;
    frame.data_order = variable->order;
    struct dispatch *dispatch =
        dispatch_new(&server->dispatches, subscription->message, NULL, &frame);
    dispatch->handler = handler;
    dispatch->uncounted = handler->module->in_order;
    dispatch->block = block_ref(variable->value);
    deliver(server, dispatch, false);
    subscription->in_flight++;
    subscription->mark = handler->module->link.queued;
}

static void set_due(struct subscription *subscription)
{
    if (list_is_empty(&subscription->in_due)) {
        list_append(&subscription->handler->module->due, &subscription->in_due);
    }
}

void watch_changed(struct server *server, const struct variable *variable)
{
    const struct message *watch = variable_message(variable, MESSAGE_WATCH);
    struct list *at, *following;
    LIST_EACH (at, following, &watch->subscriptions) {
        struct subscription *subscription = LIST_OWNER(at, struct subscription, in_message);
        struct module *module = subscription->handler->module;
        if (!module->in_order && may_go(subscription, false)) {
            send_value(server, subscription);
        } else {
            set_due(subscription);
            if (module->in_order) {
                watch_look_at(server, module); /* once for all changes of this turn */
            }
        }
        server->holding = true;
    }
}

void watch_send_due(struct server *server, struct module *module, bool before_others)
{
    struct list *at, *following;
    LIST_EACH (at, following, &module->due) {
        struct subscription *subscription = LIST_OWNER(at, struct subscription, in_due);
        if (may_go(subscription, before_others)) {
            list_remove(&subscription->in_due);
            send_value(server, subscription);
        }
    }
}

void watch_handled(struct server *server, struct handler *handler, struct message *message)
{
    struct subscription *subscription = subscription_find(handler, message);
    if (subscription == NULL) {
        return; /* given up meanwhile */
    }
    if (subscription->in_flight > 0) {
        subscription->in_flight--;
    }
    if (!list_is_empty(&subscription->in_due)) {
        watch_send_due(server, handler->module, false);
    }
}

bool watch_settle(struct server *server)
{
    const uint64_t before = server->dispatches.n_begun;
    struct list *at, *following;
    LIST_EACH (at, following, &server->due) {
        struct module *module = LIST_OWNER(at, struct module, in_due);
        list_remove(at);
        watch_send_due(server, module, module->later != NULL);
    }
    return server->dispatches.n_begun != before;
}
