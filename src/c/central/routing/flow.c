/*
 * Flow control: which deliveries go now, and which wait.
 */
#include "central/routing/flow.h"

#include "central/routing/backpressure.h"
#include "central/routing/claim.h"
#include "central/routing/deliver.h"
#include "central/routing/drops.h"
#include "central/routing/watch.h"

/* ------------------------------------------------------------------ may it go */

/* The queue from which deliveries of that sender come, NULL while nothing of it is sent. */
static struct pending *queue_for(struct resource *resource, const struct module *sender)
{
    switch (resource->state) {
    case RESOURCE_ACTIVE:
        return &resource->pending;
    case RESOURCE_RESERVED:
        return resource->claim->sender == sender ? &resource->holders_own : NULL;
    case RESOURCE_LOCKED:
        break;
    }
    return NULL;
}

/* Whether a value of a watched variable has to be handled before anything else may follow. */
static bool waits_for_value(const struct module *module)
{
    return !module->in_order && !list_is_empty(&module->due);
}

static bool takes_more(const struct server *server, const struct resource *resource)
{
    return resource->owner->state == MODULE_READY && resource_has_room(resource) &&
           !waits_for_value(resource->owner) && outbox_has_room(server, resource->owner);
}

bool flow_is_free(const struct server *server, struct resource *resource,
                  const struct module *sender)
{
    const struct pending *queue = queue_for(resource, sender);
    return queue != NULL && pending_is_empty(queue) && list_is_empty(&resource->ahead) &&
           takes_more(server, resource);
}

/*
 * Whether a delivery may be sent before its turn, so that the module finds it when
 * it has finished the one before, without a journey in between.  Nobody must be able
 * to notice: only where what waits stays in order and nothing of it is dropped, and
 * only to modules that keep to their capacity themselves.
 */
static bool may_go_ahead(const struct server *server, const struct resource *resource,
                         uint32_t data_length)
{
    const bool fits =
        resource->n_ahead == 0 || (resource->n_ahead < LIMIT_AHEAD &&
                                   resource->ahead_bytes + data_length <= LIMIT_AHEAD_BYTES);
    return fits && resource->owner->takes_ahead && resource->owner->state == MODULE_READY &&
           resource->state == RESOURCE_ACTIVE && list_is_empty(&resource->claims) &&
           !resource->limited && !server->has_priorities && !server->options->resend &&
           !server->log.data_on && outbox_has_room(server, resource->owner);
}

/* -------------------------------------------------------------------- waiting */

static struct dispatch *dispatch_of(struct pending_item *item)
{
    return item == NULL ? NULL : LIST_OWNER(item, struct dispatch, waiting);
}

/* Gives up a dispatch that is in no queue, and counts it; resource NULL: it waited for none. */
static void drop(struct server *server, struct resource *resource, struct dispatch *dispatch)
{
    server->statistics.n_dropped++;
    dispatch->message->dropped++;
    if (resource != NULL) {
        resource->dropped++;
    }
    dispatch_free(&server->dispatches, dispatch);
}

/* Gives up a dispatch because of a limit that a module has set. */
static void drop_for_limit(struct server *server, struct dispatch *dispatch)
{
    log_limited(&server->log, dispatch);
    drop(server, dispatch->resource, dispatch);
}

/* Gives up a dispatch because the resource's queue is full. */
static void drop_for_lack_of_room(struct server *server, struct resource *resource,
                                  struct dispatch *dispatch)
{
    drops_count(server, resource, dispatch);
    drop(server, resource, dispatch);
}

static void drop_for_lack_of_memory(struct server *server, struct dispatch *dispatch)
{
    log_status(&server->log, "WARNING: no memory to keep %s of %s\n", dispatch->message->name,
               dispatch_sender_name(dispatch));
    drop(server, dispatch->resource, dispatch);
}

/* Whether more would wait than may wait for any resource if so much came; one message may. */
static bool is_too_much(const struct server *server, const struct pending *queue, size_t messages,
                        size_t bytes)
{
    const struct central_limits *limits = &server->options->limits;
    const size_t count = queue->count + messages;
    return count > limits->pending_messages ||
           (queue->bytes + bytes > limits->pending_bytes && count > 1);
}

/* Whether a full queue gives up what comes rather than what is there. */
static bool keeps_oldest(const struct resource *resource)
{
    return resource->owner->when_full == WHEN_FULL_OLDEST ||
           resource->owner->when_full == WHEN_FULL_DISCONNECT;
}

/* A full queue does not take a dispatch. */
static void turn_away(struct server *server, struct resource *resource, struct dispatch *dispatch)
{
    drop_for_lack_of_room(server, resource, dispatch);
    if (resource->owner->when_full == WHEN_FULL_DISCONNECT) {
        server_condemn(server, resource->owner);
    }
}

/* Gives up the oldest deliveries while too much waits. */
static void trim(struct server *server, struct resource *resource, struct pending *queue)
{
    while (is_too_much(server, queue, 0, 0)) {
        drop_for_lack_of_room(server, resource, dispatch_of(pending_take_oldest(queue)));
    }
}

/* Puts a dispatch into its resource's queue; false when a limit leaves no place for it. */
static inline bool put_in_queue(struct server *server, struct dispatch *dispatch)
{
    struct resource *resource = dispatch->handler->resource;
    struct pending *queue = queue_for(resource, dispatch->sender);
    if (queue == NULL) {
        queue = &resource->pending;
    }
    const bool is_full = is_too_much(server, queue, 1, dispatch->data_length);
    if (is_full && keeps_oldest(resource)) {
        turn_away(server, resource, dispatch);
        return false;
    }
    dispatch->state = DISPATCH_PENDING;
    dispatch->resource = resource;
    struct dispatch *dropped = dispatch_of(
        pending_add(queue, &dispatch->message->subject, &dispatch->waiting, dispatch->data_length));
    const bool has_place = dropped != dispatch;
    if (dropped != NULL) {
        drop_for_limit(server, dropped);
    }
    if (is_full) {
        trim(server, resource, queue);
    }
    return has_place;
}

static void wait_in_queue(struct server *server, struct dispatch *dispatch, struct block **shared)
{
    struct resource *resource = dispatch->handler->resource;
    if (dispatch_keep(dispatch, shared) != 0) {
        drop_for_lack_of_memory(server, dispatch);
    } else if (put_in_queue(server, dispatch)) {
        log_queued(&server->log, dispatch, resource->name);
        backpressure_apply(server, dispatch->sender, resource);
    }
}

/* It is not its turn yet: it waits, here or already at the module. */
static void enter_later(struct server *server, struct dispatch *dispatch, struct block **shared)
{
    struct resource *resource = dispatch->handler->resource;
    if (!pending_is_empty(&resource->pending) ||
        !may_go_ahead(server, resource, dispatch->data_length)) {
        wait_in_queue(server, dispatch, shared);
        return;
    }
    if (*shared != NULL && dispatch_keep(dispatch, shared) != 0) {
        drop_for_lack_of_memory(server, dispatch);
        return;
    }
    log_queued(&server->log, dispatch, resource->name);
    watch_catch_up(server, resource->owner);
    deliver_ahead(server, dispatch);
}

void flow_enter(struct server *server, struct dispatch *dispatch, struct block **shared)
{
    struct resource *resource = dispatch->handler->resource;
    if (!flow_is_free(server, resource, dispatch->sender)) {
        enter_later(server, dispatch, shared);
        return;
    }
    /* Long data is shared with the link; data that may have to be sent again is kept. */
    const bool keep = *shared != NULL || server->options->resend;
    if (keep && dispatch_keep(dispatch, shared) != 0) {
        drop_for_lack_of_memory(server, dispatch);
        return;
    }
    watch_catch_up(server, resource->owner);
    deliver(server, dispatch, false);
}

/* ------------------------------------------------------------ without handler */

static void leave_message(struct dispatch *dispatch)
{
    dispatch->message->n_waiting--;
    dispatch->message->waiting_bytes -= dispatch->data_length;
    list_remove(&dispatch->link);
}

/* Makes room among those that wait for a handler, for one of so many bytes. */
static void trim_waiting(struct server *server, struct message *message, size_t bytes)
{
    while (message->n_waiting > 0 && (message->n_waiting >= LIMIT_WAITING_QUERIES ||
                                      message->waiting_bytes + bytes > LIMIT_WAITING_BYTES)) {
        struct dispatch *oldest = LIST_OWNER(message->waiting.next, struct dispatch, link);
        leave_message(oldest);
        drop_for_limit(server, oldest);
    }
}

void flow_wait_for_handler(struct server *server, struct dispatch *dispatch, struct block **shared)
{
    if (dispatch_keep(dispatch, shared) != 0) {
        drop_for_lack_of_memory(server, dispatch);
    } else {
        flow_wait_again(server, dispatch);
    }
}

void flow_wait_again(struct server *server, struct dispatch *dispatch)
{
    struct message *message = dispatch->message;
    trim_waiting(server, message, dispatch->data_length);
    dispatch->state = DISPATCH_WAITING;
    list_remove(&dispatch->link);
    list_append(&message->waiting, &dispatch->link);
    message->n_waiting++;
    message->waiting_bytes += dispatch->data_length;
    log_queued(&server->log, dispatch, message->name);
}

/* Whether a dispatch waits for such a handler. */
static bool waits_for(const struct dispatch *dispatch, const struct handler *handler)
{
    return dispatch->lost_by == NULL ||
           table_same_name(TABLE_FOLDING, dispatch->lost_by->name, handler->module->name);
}

void flow_adopt(struct server *server, struct message *message, struct handler *handler)
{
    struct list *at, *following;
    LIST_EACH (at, following, &message->waiting) {
        struct dispatch *dispatch = LIST_OWNER(at, struct dispatch, link);
        if (!waits_for(dispatch, handler)) {
            continue;
        }
        leave_message(dispatch);
        module_unref(dispatch->lost_by);
        dispatch->lost_by = NULL;
        dispatch->handler = handler;
        log_transferred(&server->log, dispatch, handler->resource);
        (void)put_in_queue(server, dispatch); /* a limit may drop it, which has been logged then */
    }
    flow_release(server, handler->resource);
}

/* ------------------------------------------------------------------ releasing */

/* Takes the next delivery that may go, or NULL. */
static struct dispatch *take_next(struct resource *resource)
{
    if (resource->state == RESOURCE_LOCKED) {
        return NULL;
    }
    struct pending_item *item = pending_take(&resource->holders_own);
    if (item == NULL && resource->state == RESOURCE_ACTIVE) {
        item = pending_take(&resource->pending);
    }
    return dispatch_of(item);
}

/* What has been sent before its turn has its turn when there is room. */
static void promote(struct server *server, struct resource *resource)
{
    while (!list_is_empty(&resource->ahead) && resource_has_room(resource)) {
        deliver_promote(server, LIST_OWNER(resource->ahead.next, struct dispatch, link));
    }
}

static void send_ahead(struct server *server, struct resource *resource)
{
    while (!pending_is_empty(&resource->pending) && may_go_ahead(server, resource, 0)) {
        struct dispatch *dispatch = take_next(resource);
        watch_catch_up(server, resource->owner);
        deliver_ahead(server, dispatch);
    }
}

void flow_release(struct server *server, struct resource *resource)
{
    promote(server, resource);
    claim_grant_waiting(server, resource);
    while (resource_has_waiting(resource) && takes_more(server, resource)) {
        struct dispatch *dispatch = take_next(resource);
        if (dispatch == NULL) {
            return;
        }
        watch_catch_up(server, resource->owner);
        deliver(server, dispatch, true);
    }
    send_ahead(server, resource);
    if (pending_is_empty(&resource->pending)) {
        drops_end_burst(server, resource);
    }
    backpressure_ease(server, resource);
}

void flow_release_all(struct server *server, struct module *module)
{
    struct list *at, *following;
    LIST_EACH (at, following, &module->resources) {
        flow_release(server, LIST_OWNER(at, struct resource, in_owner));
    }
}

void flow_finish(struct server *server, struct dispatch *dispatch)
{
    struct resource *resource = dispatch->resource;
    struct handler *handler = dispatch->handler;
    struct message *message = dispatch->message;
    resource->owner->finished_ns = server->now_ns;
    deliver_end(server, dispatch);
    if (message->kind == MESSAGE_WATCH) {
        watch_handled(server, handler, message);
        flow_release_all(server, handler->module);
    } else if (resource_has_waiting(resource) || !list_is_empty(&resource->ahead) ||
               !list_is_empty(&resource->claims)) {
        flow_release(server, resource);
    }
}

/* --------------------------------------------------------------- rare changes */

static void move_queue(struct server *server, struct pending *queue, const struct handler *handler)
{
    struct list *at, *following;
    LIST_EACH (at, following, &queue->by_age) {
        struct dispatch *dispatch =
            LIST_OWNER(LIST_OWNER(at, struct pending_item, by_age), struct dispatch, waiting);
        if (dispatch->handler == handler) {
            pending_remove(&dispatch->waiting);
            (void)put_in_queue(server, dispatch); /* a limit may drop it, which is logged then */
        }
    }
}

void flow_move(struct server *server, struct handler *handler, struct resource *to)
{
    struct resource *from = handler->resource;
    if (from == to) {
        return;
    }
    handler->resource = to;
    move_queue(server, &from->pending, handler);
    move_queue(server, &from->holders_own, handler);
    flow_release(server, to);
}

/* Whether it is to be sent again if its module ends, and can be. */
static bool is_wanted_again(const struct server *server, const struct dispatch *dispatch)
{
    return server->options->resend && dispatch->data != NULL &&
           dispatch->message->kind == MESSAGE_USER;
}

/* Ends a dispatch that has left its resource, or moves it to those to be sent again. */
static void lose(struct server *server, struct dispatch *dispatch, struct list *lost)
{
    if (!is_wanted_again(server, dispatch)) {
        log_cleared(&server->log, dispatch);
        dispatch_free(&server->dispatches, dispatch);
        return;
    }
    if (dispatch->class == CLASS_BROADCAST) {
        dispatch->lost_by = module_ref(dispatch->handler->module);
    }
    dispatch->state = DISPATCH_WAITING;
    dispatch->handler = NULL;
    dispatch->resource = NULL;
    dispatch->uncounted = false;
    list_append(lost, &dispatch->link);
}

static void clear_sent(struct server *server, struct list *dispatches, struct list *lost)
{
    while (!list_is_empty(dispatches)) {
        struct dispatch *dispatch = LIST_OWNER(dispatches->next, struct dispatch, link);
        deliver_leave(dispatch);
        lose(server, dispatch, lost);
    }
}

static void clear_queue(struct server *server, struct pending *queue, struct list *lost)
{
    struct dispatch *dispatch;
    while ((dispatch = dispatch_of(pending_take(queue))) != NULL) {
        lose(server, dispatch, lost);
    }
}

void flow_clear(struct server *server, struct resource *resource, struct list *lost)
{
    clear_sent(server, &resource->active, lost);
    clear_sent(server, &resource->ahead, lost);
    clear_queue(server, &resource->holders_own, lost);
    clear_queue(server, &resource->pending, lost);
    drops_end_burst(server, resource);
    backpressure_end(server, resource);
}
