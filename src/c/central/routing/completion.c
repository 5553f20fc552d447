/*
 * What modules report about deliveries.
 *
 * A response to a query goes to the asker at once, whatever the asker's
 * capacity, and ends the delivery; a response to anything else only ends it.
 */
#include "central/routing/completion.h"

#include <limits.h>
#include <string.h>

#include "central/routing/flow.h"
#include "central/routing/outbox.h"
#include "central/routing/watch.h"

/* The text of class data: a counted string, or nothing if it is none. */
static const char *class_text(const struct frame *frame, int *length)
{
    *length = 0;
    if (frame->class_length < sizeof(uint32_t)) {
        return "";
    }
    const uint32_t count = load_32(frame->class_data, (enum byte_order)frame->class_order);
    if (count > frame->class_length - sizeof(uint32_t)) {
        return "";
    }
    *length = (int)count; /* within the class data, whose limit is far lower */
    return (const char *)frame->class_data + sizeof(uint32_t);
}

/* The message that a response names, or NULL. */
static struct message *named_message(const struct server *server, const struct frame *frame)
{
    int length;
    const char *name = class_text(frame, &length);
    return table_find_text(&server->messages.names, name, (size_t)length);
}

static void relay(struct server *server, struct module *asker, const struct dispatch *query,
                  const struct frame *frame)
{
    struct frame relayed = *frame;
    relayed.intent = INTENT_REPLY;
    relayed.reference = query->reference;
    watch_catch_up(server, asker);
    outbox_queue(server, asker, &relayed, OUTBOX_NORMAL);
}

static void respond(struct server *server, struct module *module, struct dispatch *dispatch,
                    const struct frame *frame)
{
    struct log_reply reply = {
        module->name, frame->data, frame->data_length, (enum byte_order)frame->data_order,
        NULL,         NULL};
    if (dispatch->class != CLASS_QUERY) {
        log_done(&server->log, dispatch);
    } else if (frame->class_length == 0) {
        /* A module of CMU IPC would not survive a response that names no message. */
        log_warning(&server->log, module, "a response to %s names no message",
                    dispatch->message->name);
        log_done(&server->log, dispatch);
    } else {
        reply.message = named_message(server, frame);
        log_replied(&server->log, dispatch, &reply);
        relay(server, dispatch->sender, dispatch, frame);
    }
}

static void fail(struct server *server, const struct dispatch *dispatch, const struct frame *frame)
{
    int length;
    const char *reason = class_text(frame, &length);
    log_failed(&server->log, dispatch, reason, length);
}

void completion(struct server *server, struct module *module, const struct frame *frame)
{
    if (frame->dispatch == NO_ID) {
        return; /* about no delivery in particular */
    }
    struct dispatch *dispatch = dispatch_find(&server->dispatches, frame->dispatch);
    if (dispatch == NULL ||
        (dispatch->state != DISPATCH_ACTIVE && dispatch->state != DISPATCH_AHEAD) ||
        dispatch->handler->module != module) {
        log_warning(&server->log, module, "it reports delivery %d, which it does not have",
                    (int)frame->dispatch);
        return;
    }
    if (frame->class == CLASS_REPLY) {
        respond(server, module, dispatch, frame);
    } else if (frame->class == CLASS_FAILURE) {
        fail(server, dispatch, frame);
    } else {
        log_done(&server->log, dispatch);
    }
    flow_finish(server, dispatch);
}
