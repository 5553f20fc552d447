/*
 * One delivery: from being sent to being reported finished.
 *
 * The message's name goes along as class data every time.  CMU IPC leaves it
 * out once the module has asked about the message for that handler; a module
 * needs it at most once, and never minds it.
 */
#include "central/routing/deliver.h"

static void start(struct dispatch *dispatch)
{
    struct resource *resource = dispatch->handler->resource;
    dispatch->state = DISPATCH_ACTIVE;
    dispatch->resource = resource;
    list_append(&resource->active, &dispatch->link);
    if (!dispatch->uncounted) {
        resource->attending++;
    }
}

static void queue_frame(struct server *server, const struct dispatch *dispatch)
{
    struct frame frame;
    frame_init(&frame, (enum frame_class)dispatch->class);
    frame.class_length = dispatch->message->label_length;
    frame.class_data = dispatch->message->label;
    frame.data_length = dispatch->data_length;
    frame.data = dispatch->data;
    frame.data_order = dispatch->data_order;
    frame.block = dispatch->block;
    frame.parent = dispatch->parent;
    frame.intent = dispatch->handler->id;
    frame.reference = (int32_t)dispatch->id;
    dispatch->message->delivered++;
    meter_add(&dispatch->handler->module->gets, server->now_ns, dispatch->data_length);
    outbox_queue(server, dispatch->handler->module, &frame,
                 dispatch->message->kind == MESSAGE_WATCH ? OUTBOX_FIRST : OUTBOX_NORMAL);
}

void deliver(struct server *server, struct dispatch *dispatch, bool from_queue)
{
    start(dispatch);
    if (from_queue) {
        log_released(&server->log, dispatch);
    } else {
        log_sent(&server->log, dispatch, dispatch->handler->module->name);
    }
    queue_frame(server, dispatch);
    if (!server->options->resend) {
        dispatch_drop_data(dispatch);
    }
}

void deliver_ahead(struct server *server, struct dispatch *dispatch)
{
    struct resource *resource = dispatch->handler->resource;
    dispatch->state = DISPATCH_AHEAD;
    dispatch->resource = resource;
    list_append(&resource->ahead, &dispatch->link);
    resource->n_ahead++;
    resource->ahead_bytes += dispatch->data_length;
    queue_frame(server, dispatch);
    const uint32_t length = dispatch->data_length;
    dispatch_drop_data(dispatch);
    dispatch->data_length = length; /* what leave_ahead gives back */
}

static void leave_ahead(struct dispatch *dispatch)
{
    list_remove(&dispatch->link);
    dispatch->resource->n_ahead--;
    dispatch->resource->ahead_bytes -= dispatch->data_length;
}

void deliver_promote(struct server *server, struct dispatch *dispatch)
{
    leave_ahead(dispatch);
    start(dispatch);
    log_released(&server->log, dispatch);
}

void deliver_leave(struct dispatch *dispatch)
{
    if (dispatch->state == DISPATCH_AHEAD) {
        leave_ahead(dispatch);
    } else {
        dispatch->resource->attending -= !dispatch->uncounted;
        list_remove(&dispatch->link);
    }
}

void deliver_end(struct server *server, struct dispatch *dispatch)
{
    deliver_leave(dispatch);
    dispatch_free(&server->dispatches, dispatch);
}
