/*
 * Frames between this module and central.
 */
#include "libipc/exchange.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "libipc/report.h"
#include "libipc/wait.h"

/* --------------------------------------------------------------------- frames */

int32_t exchange_reference(struct _X_IPC_CONTEXT *context)
{
    context->last_reference =
        context->last_reference == INT32_MAX ? 1 : context->last_reference + 1;
    return context->last_reference;
}

void exchange_frame(struct _X_IPC_CONTEXT *context, struct frame *frame, enum frame_class class,
                    int32_t intent)
{
    const struct running *running = library_running(context->library);
    frame_init(frame, class);
    frame->intent = intent;
    frame->reference = exchange_reference(context);
    if (running != NULL && running->context == context) {
        frame->parent = running->dispatch;
    }
}

/* A write has found the connection gone. */
static IPC_ERROR_TYPE lost(const struct _X_IPC_CONTEXT *context)
{
    return context_is_live(context) ? IPC_Not_Connected : IPC_Communication_Error;
}

IPC_ERROR_TYPE exchange_flush(struct _X_IPC_CONTEXT *context)
{
    if (!context_is_open(context)) {
        return IPC_Not_Connected;
    }
    context->acknowledged_ns = 0;
    if (link_flush(&context->link) < 0) {
        context_lose(context, false);
        return lost(context);
    }
    return IPC_No_Error;
}

IPC_ERROR_TYPE exchange_drain(struct _X_IPC_CONTEXT *context, uint64_t mark)
{
    const unsigned connection = context->connection;
    IPC_ERROR_TYPE error = exchange_flush(context);
    context->writers++;
    bool given_up = false; /* then it leaves later */
    while (error == IPC_No_Error && !given_up && context->link.written < mark) {
        given_up = !wait_turn(context->library, NO_DEADLINE) && link_keep_borrowed(&context->link);
        if (context->connection != connection || !context_is_open(context)) {
            error = lost(context);
        }
    }
    context->writers--;
    return error;
}

/* ------------------------------------------------------------- a lost connection */

bool exchange_await_central(struct _X_IPC_CONTEXT *context)
{
    bool go_on = true;
    while (go_on && context->away != NULL && context->reconnect == IPCX_RECONNECT_WAIT) {
        go_on = wait_turn(context->library, NO_DEADLINE);
    }
    return context_is_connected(context);
}

bool exchange_again(struct _X_IPC_CONTEXT *context, unsigned connection)
{
    return (context->away != NULL || context->connection != connection) &&
           context->reconnect == IPCX_RECONNECT_WAIT && exchange_await_central(context);
}

/* ------------------------------------------------------------------- requests */

static IPC_ERROR_TYPE queue_payload(struct _X_IPC_CONTEXT *context, struct frame *frame,
                                    const struct format *format, const void *payload)
{
    struct buffer data;
    buffer_init(&data);
    const int error = payload_encode(format, payload, &data);
    if (error == 0) {
        frame->data = data.bytes;
        frame->data_length = (uint32_t)data.length;
        link_queue(&context->link, frame);
    }
    buffer_fini(&data);
    return report_code(error);
}

IPC_ERROR_TYPE exchange_queue_request(struct _X_IPC_CONTEXT *context, int32_t message_id,
                                      const struct format *format, const void *payload,
                                      struct awaited *awaited)
{
    struct frame frame;
    memset(awaited, 0, sizeof *awaited);
    if (!context_is_open(context)) {
        return IPC_Not_Connected;
    }
    exchange_frame(context, &frame, CLASS_QUERY, message_id);
    awaited->reference = frame.reference;
    const IPC_ERROR_TYPE error = queue_payload(context, &frame, format, payload);
    if (error == IPC_No_Error) {
        (void)intmap_put(&context->awaited, (uint64_t)frame.reference, awaited);
    }
    return error;
}

IPC_ERROR_TYPE exchange_queue_notice(struct _X_IPC_CONTEXT *context, int32_t message_id,
                                     const struct format *format, const void *payload)
{
    struct frame frame;
    if (!context_is_open(context)) {
        return IPC_Not_Connected;
    }
    exchange_frame(context, &frame, CLASS_INFORM, message_id);
    return queue_payload(context, &frame, format, payload);
}

void exchange_forget(struct _X_IPC_CONTEXT *context, struct awaited *awaited)
{
    if (!awaited->done && !awaited->failed) {
        (void)intmap_remove(&context->awaited, (uint64_t)awaited->reference);
    }
    free(awaited->data);
    free(awaited->name);
    awaited->data = NULL;
    awaited->name = NULL;
}

IPC_ERROR_TYPE exchange_await(struct _X_IPC_CONTEXT *context, struct awaited *awaited,
                              uint64_t deadline_ns, bool *timed_out)
{
    if (timed_out != NULL) {
        *timed_out = false;
    }
    bool go_on = true;
    while (!awaited->done && !awaited->failed) {
        if (!go_on || wait_is_over(deadline_ns)) {
            if (timed_out != NULL) {
                *timed_out = true;
            }
            return go_on ? IPC_Not_Connected : IPC_Communication_Error;
        }
        go_on = wait_turn(context->library, deadline_ns);
    }
    return awaited->done ? IPC_No_Error : IPC_Not_Connected;
}

IPC_ERROR_TYPE exchange_decode(struct awaited *awaited, const struct format *format, void *reply)
{
    int error = 0;
    memset(reply, 0, format_size(format));
    if (awaited->length > 0) {
        error = payload_decode(format, awaited->data, awaited->length, awaited->order, reply);
    }
    free(awaited->data);
    awaited->data = NULL;
    return error == 0 ? IPC_No_Error : IPC_Communication_Error;
}

/* The number of a message of central, asked for at the first use. */
static IPC_ERROR_TYPE library_id(struct _X_IPC_CONTEXT *context, enum library_message which,
                                 int32_t *id)
{
    if (context->library_ids[which] == 0) {
        const struct catalogue *catalogue = &context->library->catalogue;
        struct message_info_request request = {(char *)(uintptr_t)library_messages[which].name,
                                               NULL};
        struct optional_message_info reply;
        const IPC_ERROR_TYPE error = exchange_ask(context, LM_MESSAGE_INFO, &request, &reply);
        if (error != IPC_No_Error) {
            return error;
        }
        context->library_ids[which] = reply.info != NULL ? reply.info->id : 0;
        (void)format_release(catalogue->reply[LM_MESSAGE_INFO], &reply);
    }
    *id = context->library_ids[which];
    if (!context_is_connected(context)) {
        return IPC_Not_Connected;
    }
    return *id != 0 ? IPC_No_Error : IPC_Communication_Error;
}

static IPC_ERROR_TYPE ask(struct _X_IPC_CONTEXT *context, enum library_message which,
                          const void *payload, void *reply)
{
    const struct catalogue *catalogue = &context->library->catalogue;
    struct awaited awaited;
    int32_t id;
    memset(reply, 0, format_size(catalogue->reply[which]));
    IPC_ERROR_TYPE error = library_id(context, which, &id);
    if (error != IPC_No_Error) {
        return error;
    }
    error = exchange_queue_request(context, id, catalogue->request[which], payload, &awaited);
    if (error == IPC_No_Error) {
        error = exchange_flush(context);
    }
    if (error == IPC_No_Error) {
        error = exchange_await(context, &awaited, NO_DEADLINE, NULL);
    }
    if (error == IPC_No_Error) {
        error = exchange_decode(&awaited, catalogue->reply[which], reply);
    }
    exchange_forget(context, &awaited);
    return error;
}

IPC_ERROR_TYPE exchange_ask(struct _X_IPC_CONTEXT *context, enum library_message which,
                            const void *payload, void *reply)
{
    IPC_ERROR_TYPE error;
    unsigned connection;
    do {
        connection = context->connection;
        error = ask(context, which, payload, reply);
    } while (error != IPC_No_Error && exchange_again(context, connection));
    return error;
}

void exchange_tell(struct _X_IPC_CONTEXT *context, enum library_message which, const void *payload)
{
    if (context->library_ids[which] != 0) {
        (void)exchange_queue_notice(context, context->library_ids[which],
                                    context->library->catalogue.request[which],
                                    payload); /* a loss shows in the context's state */
    }
}

IPC_ERROR_TYPE exchange_notice(struct _X_IPC_CONTEXT *context, enum library_message which,
                               const void *payload)
{
    const unsigned connection = context->connection;
    int32_t id;
    IPC_ERROR_TYPE error = library_id(context, which, &id);
    if (error == IPC_No_Error) {
        error =
            exchange_queue_notice(context, id, context->library->catalogue.request[which], payload);
    }
    if (error == IPC_No_Error) {
        error = exchange_drain(context, context->link.queued);
    }
    /* The handshake has told a central that came back everything that notices say. */
    return error != IPC_No_Error && exchange_again(context, connection) ? IPC_No_Error : error;
}
