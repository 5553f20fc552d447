/*
 * Queries and responses.
 */
#include "libipc/query.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/listen.h"
#include "libipc/peer.h"
#include "libipc/publish.h"
#include "libipc/report.h"
#include "libipc/wait.h"

/* --------------------------------------------------------------------- asking */

static IPC_ERROR_TYPE prepare(struct _X_IPC_CONTEXT *context, const char *name,
                              unsigned int *length, const void *content, struct message **message)
{
    IPC_ERROR_TYPE error = registry_find(context, name, true, message);
    if (error == IPC_No_Error) {
        error = publish_check(*message, length, content);
    }
    return error;
}

/* Sends the query; awaited is in the table before anything can come back. */
static IPC_ERROR_TYPE send_query(struct _X_IPC_CONTEXT *context, struct message *message,
                                 const void *content, unsigned int length, struct awaited *awaited)
{
    struct frame frame;
    exchange_frame(context, &frame, CLASS_QUERY, message->id);
    awaited->reference = frame.reference;
    (void)intmap_put(&context->awaited, (uint64_t)frame.reference, awaited);
    return publish_send(context, &frame, message, content, length);
}

IPC_ERROR_TYPE query_notify(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                            const void *content, HANDLER_TYPE handler, void *client_data)
{
    struct message *message;
    const IPC_ERROR_TYPE error = prepare(context, name, &length, content, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    struct awaited *awaited = mem_new(sizeof *awaited);
    awaited->notify = true;
    awaited->handler = handler;
    awaited->client_data = client_data;
    /* From here on the table owns it: the reply or the end of the connection frees it. */
    return send_query(context, message, content, length, awaited);
}

/* Whether the program gives up the query, after a pass with that result. */
static bool is_given_up(struct library *library, enum listen_result result)
{
    return result == LISTEN_GIVEN_UP || (result == LISTEN_HANDLED && wait_is_given_up(library));
}

/* Listens until the reply is there, the connection has gone, or time is over or given up. */
static IPC_ERROR_TYPE listen_for(struct _X_IPC_CONTEXT *context, struct awaited *awaited,
                                 uint64_t deadline_ns, bool *timed_out)
{
    bool last = false;
    *timed_out = false;
    while (!awaited->done && !awaited->failed) {
        if (last) {
            *timed_out = true;
            return IPC_No_Error;
        }
        last = wait_is_over(deadline_ns); /* one more look at what is there already */
        last = is_given_up(context->library,
                           listen_pass_for(context->library, deadline_ns, awaited)) ||
               last;
    }
    return awaited->done ? IPC_No_Error : IPC_Not_Connected;
}

/* Takes the reply apart.  The response's definition may have to be asked for. */
static IPC_ERROR_TYPE unwrap(struct _X_IPC_CONTEXT *context, struct awaited *awaited,
                             struct response *response)
{
    const uint8_t *content;
    if (awaited->name == NULL) {
        return IPC_Communication_Error;
    }
    const IPC_ERROR_TYPE error = registry_find(context, awaited->name, true, &response->message);
    if (error != IPC_No_Error) {
        return error;
    }
    if (registry_unwrap(response->message, awaited->data, awaited->length, awaited->order, &content,
                        &response->length) != 0) {
        return IPC_Communication_Error;
    }
    response->order = awaited->order;
    if (response->length > 0) {
        memmove(awaited->data, content, response->length);
        response->content = awaited->data;
        awaited->data = NULL;
    }
    return IPC_No_Error;
}

IPC_ERROR_TYPE query_response(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                              const void *content, unsigned int timeout_ms,
                              struct response *response, bool *timed_out)
{
    struct message *message;
    struct awaited awaited;
    memset(response, 0, sizeof *response);
    memset(&awaited, 0, sizeof awaited);
    *timed_out = false;
    IPC_ERROR_TYPE error = prepare(context, name, &length, content, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    const uint64_t deadline = wait_deadline(timeout_ms);
    error = send_query(context, message, content, length, &awaited);
    if (error == IPC_No_Error) {
        error = listen_for(context, &awaited, deadline, timed_out);
    }
    if (error == IPC_No_Error && awaited.done) {
        error = unwrap(context, &awaited, response);
    }
    exchange_forget(context, &awaited);
    return error;
}

/* ------------------------------------------------------------------ answering */

/* Whether the instance can still be answered; says so if it has been already. */
static IPC_ERROR_TYPE check_answerable(const struct instance *instance)
{
    if (instance == NULL || instance->kind != INSTANCE_DELIVERY) {
        return IPC_Argument_Out_Of_Range;
    }
    if (instance->responded) {
        report_note("x_ipc_sendResponse: Already responed to instance %u (%s)\n\n",
                    (unsigned)instance->number, instance->message->name);
        return IPC_Argument_Out_Of_Range;
    }
    if (!instance->running && !instance->delayed) {
        return IPC_Argument_Out_Of_Range;
    }
    return instance_is_stale(instance) ? IPC_Not_Connected : IPC_No_Error;
}

/* A message name as class data; the caller frees it: 0 or ERR_MEMORY. */
static int encode_name(const struct message *message, struct buffer *name)
{
    const int32_t length = (int32_t)strlen(message->name);
    buffer_init(name);
    const int error = buffer_append(name, &length, sizeof length);
    return error != 0 ? error : buffer_append(name, message->name, (size_t)length);
}

/* Who asked through central is answered through central.  The response frees central's slot, so it is
 * the acknowledgement as well. */
static IPC_ERROR_TYPE respond_routed(struct instance *instance, struct frame *frame,
                                     const struct message *message, const void *content,
                                     unsigned int length)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    frame->dispatch = instance->dispatch;
    instance->dispatch = NO_ID;
    context->unfinished--;
    return publish_frame(context, frame, message, content, length);
}

/* Who asked directly is answered over the same link; whether he is still there is of no matter. */
static IPC_ERROR_TYPE respond_direct(struct instance *instance, struct frame *frame,
                                     const struct message *message, const void *content,
                                     unsigned int length)
{
    struct peer *peer = instance->peer;
    if (instance->class == CLASS_QUERY && peer->link.fd >= 0) {
        frame->intent = INTENT_REPLY;
        frame->dispatch = instance->reference;
        frame->reference = instance->reference;
        (void)peer_ref(peer);
        publish_frame_to(peer, frame, message, content, length);
        peer_unref(peer);
    }
    return IPC_No_Error;
}

static IPC_ERROR_TYPE send_response(struct instance *instance, const struct message *message,
                                    const void *content, unsigned int length)
{
    const struct _X_IPC_CONTEXT *context = instance->context;
    const struct running *running = library_running(context->library);
    struct frame frame;
    struct buffer name;
    IPC_ERROR_TYPE error = report_code(encode_name(message, &name));
    if (error == IPC_No_Error) {
        frame_init(&frame, CLASS_REPLY);
        frame.parent = running != NULL && running->context == context ? running->dispatch : NO_ID;
        frame.class_data = name.bytes;
        frame.class_length = (uint32_t)name.length;
        instance->responded = true;
        instance_passivate(instance);
        error = instance->peer == NULL ? respond_routed(instance, &frame, message, content, length)
                                       : respond_direct(instance, &frame, message, content, length);
    }
    buffer_fini(&name);
    return error;
}

IPC_ERROR_TYPE query_respond(struct library *library, MSG_INSTANCE handle, const char *name,
                             unsigned int length, const void *content)
{
    struct message *message;
    struct instance *instance = instance_find(library, handle);
    IPC_ERROR_TYPE error = check_answerable(instance);
    if (error != IPC_No_Error) {
        return error;
    }
    if (!context_is_connected(instance->context)) {
        return IPC_Not_Connected;
    }
    error = prepare(instance->context, name, &length, content, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    instance = instance_find(library, handle); /* prepare may have waited */
    error = check_answerable(instance);
    if (error != IPC_No_Error) {
        return error;
    }
    error = send_response(instance, message, content, length);
    instance = instance_find(library, handle); /* so may sending */
    if (instance != NULL && instance->delayed && !instance->running) {
        instance_free(instance);
    }
    return error;
}

IPC_ERROR_TYPE query_delay(struct library *library, MSG_INSTANCE handle)
{
    struct instance *instance = instance_find(library, handle);
    if (instance == NULL || !(instance->running || instance->delayed)) {
        return IPC_Argument_Out_Of_Range;
    }
    instance->delayed = true;
    return IPC_No_Error;
}
