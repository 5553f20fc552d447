/*
 * Answers of the server to requests of modules.
 *
 * They go at once, whatever the module's capacity, and have the header fields
 * that answers of central always had: parent and dispatch 0.
 */
#include "central/answer.h"

#include "central/outbox.h"
#include "central/version.h"
#include "central/watch.h"

static void send(struct server *server, const struct dispatch *request, const uint8_t *bytes,
                 size_t length, enum byte_order order)
{
    struct frame frame;
    const struct log_reply reply = {SERVER_NAME, bytes, length,
                                    order,       NULL,  request->message->content};
    log_replied(&server->log, request, &reply);
    frame_init(&frame, CLASS_NONE);
    frame.data = bytes;
    frame.data_length = (uint32_t)length;
    frame.data_order = (uint8_t)order;
    frame.parent = 0;
    frame.intent = INTENT_REPLY;
    frame.dispatch = 0;
    frame.reference = request->reference;
    watch_catch_up(server, request->sender);
    outbox_queue(server, request->sender, &frame, OUTBOX_NORMAL);
}

void answer_and_keep(struct server *server, struct dispatch *request, const void *value)
{
    struct buffer bytes;
    buffer_init(&bytes);
    if (value == NULL || payload_encode(request->message->content, value, &bytes) == 0) {
        send(server, request, bytes.bytes, bytes.length, byte_order_of_host());
    } else {
        log_warning(&server->log, request->sender, "no answer to %s can be made",
                    request->message->name);
    }
    buffer_fini(&bytes);
}

void answer(struct server *server, struct dispatch *request, const void *value)
{
    answer_and_keep(server, request, value);
    dispatch_free(&server->dispatches, request);
}

void answer_encoded(struct server *server, struct dispatch *request, const uint8_t *bytes,
                    size_t length, enum byte_order order)
{
    send(server, request, bytes, length, order);
    dispatch_free(&server->dispatches, request);
}

void answer_nothing(struct server *server, struct dispatch *request)
{
    log_done(&server->log, request);
    dispatch_free(&server->dispatches, request);
}
