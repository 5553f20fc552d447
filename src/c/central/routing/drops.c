/*
 * Messages that a full queue has lost.
 */
#include "central/routing/drops.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/memory.h"

/* What one burst has cost of one message. */
struct loss {
    struct list in_resource;
    struct message *message;
    uint64_t count;
};

static void tell_beginning(struct server *server, const struct resource *resource,
                           const struct dispatch *dispatch)
{
    static const char *const consequences[] = {
        [WHEN_FULL_WAIT] = "the newest messages are kept",
        [WHEN_FULL_NEWEST] = "the newest messages are kept",
        [WHEN_FULL_OLDEST] = "the oldest messages are kept",
        [WHEN_FULL_DISCONNECT] = "its connection ends",
    };
    log_warning(&server->log, resource->owner, "the queue of %s is full: %s of %s is dropped, %s",
                resource->name, dispatch->message->name, dispatch_sender_name(dispatch),
                consequences[resource->owner->when_full]);
}

void drops_count(struct server *server, struct resource *resource, const struct dispatch *dispatch)
{
    struct loss *loss = intmap_find(&resource->lost, dispatch->message->subject.number);
    if (loss == NULL) {
        loss = mem_new(sizeof *loss);
        loss->message = dispatch->message;
        list_append(&resource->losses, &loss->in_resource);
        (void)intmap_put(&resource->lost, loss->message->subject.number, loss); /* it is new */
        tell_beginning(server, resource, dispatch);
    }
    loss->count++;
}

void drops_tell_end(struct server *server, struct resource *resource)
{
    struct list *at, *following;
    LIST_EACH (at, following, &resource->losses) {
        struct loss *loss = LIST_OWNER(at, struct loss, in_resource);
        log_warning(&server->log, resource->owner,
                    "the queue of %s was full: %" PRIu64 " of %s were dropped", resource->name,
                    loss->count, loss->message->name);
        list_remove(at);
        free(loss);
    }
    intmap_fini(&resource->lost);
    intmap_init(&resource->lost);
}
