/*
 * Requests of the server to itself, for the log.
 */
#include "central/routing/own_request.h"

#include "central/settings/version.h"

struct dispatch *own_request_begin(struct server *server, struct message *message,
                                   const struct buffer *data)
{
    struct frame frame;
    if (!server->log.messages_on) {
        return NULL;
    }
    frame_init(&frame, CLASS_INFORM);
    frame.data = data->bytes;
    frame.data_length = (uint32_t)data->length;
    struct dispatch *dispatch = dispatch_new(&server->dispatches, message, NULL, &frame);
    dispatch->state = DISPATCH_SERVED;
    log_sent(&server->log, dispatch, SERVER_NAME);
    return dispatch;
}

struct dispatch *own_request_begin_value(struct server *server, struct message *message,
                                         const void *value)
{
    struct buffer data;
    struct dispatch *dispatch = NULL;
    if (!server->log.messages_on) {
        return NULL;
    }
    buffer_init(&data);
    if (payload_encode(message->wire, value, &data) == 0) {
        dispatch = own_request_begin(server, message, &data);
    }
    buffer_fini(&data);
    return dispatch;
}

void own_request_end(struct server *server, struct dispatch *dispatch)
{
    if (dispatch != NULL) {
        log_done(&server->log, dispatch);
        dispatch_free(&server->dispatches, dispatch);
    }
}
