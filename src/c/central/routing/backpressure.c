/*
 * Back-pressure: whoever outpaces a receiver that works waits for it.
 */
#include "central/routing/backpressure.h"

#include "central/routing/outbox.h"

static bool is_crowded(const struct server *server, const struct resource *resource)
{
    const struct central_limits *limits = &server->options->limits;
    return resource->pending.count > limits->pending_messages / 2 ||
           resource->pending.bytes > limits->pending_bytes / 2;
}

/* When the receiver no longer counts as working. */
static uint64_t end_of_patience(const struct server *server, const struct resource *resource)
{
    return resource->owner->finished_ns + server->options->limits.progress_ns;
}

void backpressure_apply(struct server *server, struct module *sender, struct resource *resource)
{
    if (!is_crowded(server, resource) || resource->owner->when_full != WHEN_FULL_WAIT ||
        sender == NULL || sender == resource->owner || module_waits(sender) || sender->deaf ||
        sender->input_ended || /* it is about to end, little more can come */
        server->now_ns >= end_of_patience(server, resource)) {
        return;
    }
    list_remove(&sender->in_input);
    list_append(&resource->waited_for_by, &sender->in_waiting_for);
    outbox_attend(server, sender);
    if (list_is_empty(&resource->in_crowded)) {
        list_append(&server->crowded, &resource->in_crowded);
    }
}

static void go_on(struct server *server, struct module *sender)
{
    list_remove(&sender->in_waiting_for);
    list_append(&server->input, &sender->in_input);
    outbox_attend(server, sender);
}

void backpressure_end(struct server *server, struct resource *resource)
{
    struct list *at, *following;
    LIST_EACH (at, following, &resource->waited_for_by) {
        go_on(server, LIST_OWNER(at, struct module, in_waiting_for));
    }
    list_remove(&resource->in_crowded);
}

void backpressure_ease(struct server *server, struct resource *resource)
{
    if (!list_is_empty(&resource->in_crowded) && !is_crowded(server, resource)) {
        backpressure_end(server, resource);
    }
}

void backpressure_let_go(struct server *server, struct module *sender)
{
    if (module_waits(sender)) {
        go_on(server, sender);
    }
}

uint64_t backpressure_check(struct server *server)
{
    uint64_t next = UINT64_MAX;
    struct list *at, *following;
    LIST_EACH (at, following, &server->crowded) {
        struct resource *resource = LIST_OWNER(at, struct resource, in_crowded);
        const uint64_t end = end_of_patience(server, resource);
        if (server->now_ns >= end) {
            backpressure_end(server, resource);
        } else if (end < next) {
            next = end;
        }
    }
    return next;
}
