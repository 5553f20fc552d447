/*
 * Answers of the server to requests of modules.
 *
 * They go at once, whatever the module's capacity, and have the header fields
 * that answers of central always had: parent and dispatch 0.
 */
#include "central/routing/answer.h"

#include "central/routing/outbox.h"
#include "central/settings/version.h"
#include "central/routing/watch.h"

struct encoded {
    const uint8_t *bytes;
    size_t length;
    enum byte_order order;
};

static void send(struct server *server, const struct dispatch *request, const struct encoded *value,
                 enum outbox_urgency urgency)
{
    struct frame frame;
    const struct log_reply reply = {SERVER_NAME,  value->bytes, value->length,
                                    value->order, NULL,         request->message->content};
    log_replied(&server->log, request, &reply);
    frame_init(&frame, CLASS_NONE);
    frame.data = value->bytes;
    frame.data_length = (uint32_t)value->length;
    frame.data_order = (uint8_t)value->order;
    frame.parent = 0;
    frame.intent = INTENT_REPLY;
    frame.dispatch = 0;
    frame.reference = request->reference;
    watch_catch_up(server, request->sender);
    outbox_queue(server, request->sender, &frame, urgency);
}

static void encode_and_send(struct server *server, const struct dispatch *request,
                            const void *value, enum outbox_urgency urgency)
{
    struct buffer bytes;
    buffer_init(&bytes);
    if (value == NULL || payload_encode(request->message->content, value, &bytes) == 0) {
        const struct encoded encoded = {bytes.bytes, bytes.length, byte_order_of_host()};
        send(server, request, &encoded, urgency);
    } else {
        log_warning(&server->log, request->sender, "no answer to %s can be made",
                    request->message->name);
    }
    buffer_fini(&bytes);
}

void answer_and_keep(struct server *server, struct dispatch *request, const void *value)
{
    encode_and_send(server, request, value, OUTBOX_NORMAL);
}

void answer_state(struct server *server, struct dispatch *request, const void *value)
{
    encode_and_send(server, request, value, OUTBOX_FIRST);
    dispatch_free(&server->dispatches, request);
}

void answer(struct server *server, struct dispatch *request, const void *value)
{
    answer_and_keep(server, request, value);
    dispatch_free(&server->dispatches, request);
}

void answer_encoded(struct server *server, struct dispatch *request, const uint8_t *bytes,
                    size_t length, enum byte_order order)
{
    const struct encoded encoded = {bytes, length, order};
    send(server, request, &encoded, OUTBOX_FIRST);
    dispatch_free(&server->dispatches, request);
}

void answer_nothing(struct server *server, struct dispatch *request)
{
    log_done(&server->log, request);
    dispatch_free(&server->dispatches, request);
}
