/*
 * Routing: who gets a message.
 */
#include "central/routing/route.h"

#include "central/routing/flow.h"
#include "central/routing/tap.h"

static void route_copies(struct server *server, struct module *sender, const struct frame *frame,
                         struct message *message)
{
    struct block *shared = frame->block == NULL ? NULL : block_ref(frame->block);
    struct list *at, *following;
    LIST_EACH (at, following, &message->subscriptions) {
        struct dispatch *dispatch = dispatch_new(&server->dispatches, message, sender, frame);
        dispatch->handler = LIST_OWNER(at, struct subscription, in_message)->handler;
        flow_enter(server, dispatch, &shared);
    }
    block_unref(shared);
}

/* Sends the data of a tapped message as the messages that listen, too. */
static void route_to_taps(struct server *server, struct module *sender, const struct frame *frame,
                          const struct message *message)
{
    struct list *at, *following;
    LIST_EACH (at, following, &message->taps) {
        const struct tap_entry *tap = LIST_OWNER(at, struct tap_entry, in_message);
        if (tap->condition == TAP_WHEN_SENT) {
            route_copies(server, sender, frame, tap->listening);
        }
    }
}

void route_broadcast(struct server *server, struct module *sender, const struct frame *frame,
                     struct message *message)
{
    meter_add(&message->published, server->now_ns, frame->data_length);
    route_copies(server, sender, frame, message);
    if (!list_is_empty(&message->taps)) {
        route_to_taps(server, sender, frame, message);
    }
}

struct handler *route_choose(const struct server *server, const struct message *message,
                             const struct module *sender)
{
    struct handler *best = NULL;
    struct list *at, *following;
    LIST_EACH (at, following, &message->subscriptions) {
        struct handler *handler = LIST_OWNER(at, struct subscription, in_message)->handler;
        if (flow_is_free(server, handler->resource, sender)) {
            return handler;
        }
        if (best == NULL ||
            resource_count_waiting(handler->resource) < resource_count_waiting(best->resource)) {
            best = handler;
        }
    }
    return best;
}

void route_to_one(struct server *server, struct module *sender, const struct frame *frame,
                  struct message *message)
{
    struct block *shared = frame->block == NULL ? NULL : block_ref(frame->block);
    struct dispatch *dispatch = dispatch_new(&server->dispatches, message, sender, frame);
    meter_add(&message->published, server->now_ns, frame->data_length);
    dispatch->handler = route_choose(server, message, sender);
    if (dispatch->handler != NULL) {
        flow_enter(server, dispatch, &shared);
    } else {
        flow_wait_for_handler(server, dispatch, &shared);
    }
    block_unref(shared);
    if (!list_is_empty(&message->taps)) {
        route_to_taps(server, sender, frame, message);
    }
}
