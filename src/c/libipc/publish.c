/*
 * Sending user messages.
 */
#include "libipc/publish.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/peer.h"
#include "libipc/receive.h"
#include "libipc/report.h"

/* --------------------------------------------------------------------- length */

static IPC_ERROR_TYPE wrong_length(const char *kind, const struct message *message,
                                   unsigned int length, IPC_ERROR_TYPE error)
{
    report_warning("Illegal length argument %d for %s message %s\n", (int)length, kind,
                   message->name);
    return error;
}

static IPC_ERROR_TYPE check_length(const struct message *message, unsigned int *length)
{
    if (message->wire == WIRE_VARIABLE) {
        if (*length == IPC_FIXED_LENGTH) {
            return wrong_length("variable-length", message, *length, IPC_Not_Fixed_Length);
        }
        if (*length == IPC_VARIABLE_LENGTH) {
            return wrong_length("variable-length", message, *length, IPC_Message_Lengths_Differ);
        }
        return *length <= LIMIT_DATA - 8 ? IPC_No_Error : IPC_Argument_Out_Of_Range;
    }
    if (*length != IPC_FIXED_LENGTH && *length != message->fixed_length) {
        if (message->wire == WIRE_NONE) {
            report_warning("Illegal length argument %d for zero-length message\n %s\n",
                           (int)*length, message->name);
            return IPC_Message_Lengths_Differ;
        }
        return wrong_length("fixed-length", message, *length, IPC_Message_Lengths_Differ);
    }
    *length = (unsigned int)message->fixed_length;
    return IPC_No_Error;
}

IPC_ERROR_TYPE publish_check(const struct message *message, unsigned int *length,
                             const void *content)
{
    const IPC_ERROR_TYPE error = check_length(message, length);
    return error == IPC_No_Error && content == NULL && *length > 0 ? IPC_Null_Argument : error;
}

/* --------------------------------------------------------------------- frames */

/* Queues a frame with the message's data; content stays the caller's until the mark has left. */
static uint64_t queue_frame(struct link *link, struct frame *frame, const struct message *message,
                            const void *content, size_t length)
{
    const int32_t envelope[2] = {(int32_t)length, (int32_t)length};
    const size_t prefix = message->wire == WIRE_VARIABLE ? sizeof envelope : 0;
    frame->data_length = (uint32_t)(prefix + length);
    return link_queue_borrowed(link, frame, envelope, prefix, content, length);
}

IPC_ERROR_TYPE publish_frame(struct _X_IPC_CONTEXT *context, struct frame *frame,
                             const struct message *message, const void *content, size_t length)
{
    return exchange_drain(context, queue_frame(&context->link, frame, message, content, length));
}

void publish_frame_to(struct peer *peer, struct frame *frame, const struct message *message,
                      const void *content, size_t length)
{
    peer_drain(peer, queue_frame(&peer->link, frame, message, content, length));
}

/*
 * A message that nobody subscribes to need not be sent, if that is certain: central
 * keeps every listening module informed, and a subscription is only complete when the
 * news is in this module's socket.  So what the socket holds is taken in first, and the
 * message is sent in any case if the news might be stuck behind something else.
 * Only centrals of this project make that promise, and only a Unix socket keeps it:
 * over TCP the news may still be on its way when the subscriber has its answer.
 */
static bool nobody_subscribes(struct _X_IPC_CONTEXT *context, const struct message *message)
{
    if (!context->will_listen || !context->local || !context->new_central ||
        !context->broadcasts_known || message->n_subscriptions > 0 || context->unfinished > 0 ||
        table_find(&context->broadcasts, message->name) != NULL) {
        return false;
    }
    const bool came = receive(context);
    return !came && context_is_connected(context) && reader_is_empty(&context->link.reader) &&
           link_waiting(&context->link) == 0;
}

/* To all targets, oldest subscription first; a query to the oldest that can be reached alone.
 * Returns how many that were.  The targets may change while one of them lets this thread wait. */
static size_t send_to_targets(struct _X_IPC_CONTEXT *context, struct frame *frame,
                              struct message *message, const void *content, size_t length)
{
    const unsigned connection = context->connection;
    size_t n_sent = 0;
    for (size_t i = 0; context_is_connected_as(context, connection) && i < message->n_targets;
         i++) {
        struct peer *peer = message->targets[i].peer;
        if (peer == NULL || peer->link.fd < 0) {
            continue;
        }
        frame->intent = message->targets[i].handler;
        (void)peer_ref(peer);
        publish_frame_to(peer, frame, message, content, length);
        peer_unref(peer);
        n_sent++;
        if (frame->class == CLASS_QUERY) {
            break;
        }
    }
    return n_sent;
}

IPC_ERROR_TYPE publish_send(struct _X_IPC_CONTEXT *context, struct frame *frame,
                            struct message *message, const void *content, size_t length)
{
    if (message->id < 0) {
        const unsigned connection = context->connection;
        const IPC_ERROR_TYPE error = direct_find_targets(context, message);
        if (error != IPC_No_Error) {
            return error;
        }
        const size_t n_sent = send_to_targets(context, frame, message, content, length);
        if (!context_is_connected_as(context, connection)) {
            return IPC_Not_Connected; /* or by another connection, with other numbers */
        }
        if (n_sent > 0 || (message->n_targets > 0 && frame->class != CLASS_QUERY)) {
            return IPC_No_Error;
        }
    }
    frame->intent = message->id;
    return publish_frame(context, frame, message, content, length);
}

/* The message as the present central knows it: since it was found, another one may have come. */
static IPC_ERROR_TYPE find_again(struct _X_IPC_CONTEXT *context, struct message **message)
{
    char *name = mem_copy_string((*message)->name); /* which may go with the connection */
    const IPC_ERROR_TYPE error = registry_find(context, name, true, message);
    free(name);
    return error;
}

static IPC_ERROR_TYPE publish_once(struct _X_IPC_CONTEXT *context, struct message *message,
                                   unsigned int length, const void *content)
{
    struct frame frame;
    IPC_ERROR_TYPE error = IPC_No_Error;
    if (!message->known) {
        error = find_again(context, &message);
    }
    if (error == IPC_No_Error) {
        error = publish_check(message, &length, content);
    }
    if (error != IPC_No_Error || nobody_subscribes(context, message)) {
        return error;
    }
    if (!context_is_connected(context)) {
        return IPC_Not_Connected;
    }
    exchange_frame(context, &frame, CLASS_BROADCAST, message->id);
    return publish_send(context, &frame, message, content, length);
}

IPC_ERROR_TYPE publish(struct _X_IPC_CONTEXT *context, struct message *message, unsigned int length,
                       const void *content)
{
    IPC_ERROR_TYPE error;
    unsigned connection;
    do {
        connection = context->connection;
        error = publish_once(context, message, length, content);
    } while (error != IPC_No_Error && exchange_again(context, connection));
    return error;
}

/* ------------------------------------------------------------------- encoding */

/* Larger scratch is given back, so that one big message does not hold memory for ever. */
enum { KEPT_SCRATCH = 256 * 1024 };

static int encode(const struct format *format, const void *data, struct encoded *encoded)
{
    encoded->buffer.length = 0;
    const int error = format_encode(format, data, byte_order_of_host(), &encoded->buffer);
    encoded->content = encoded->buffer.length > 0 ? encoded->buffer.bytes : NULL;
    encoded->length = encoded->buffer.length;
    return error;
}

IPC_ERROR_TYPE publish_encode(struct library *library, const struct format *format,
                              const void *data, struct encoded *encoded)
{
    memset(encoded, 0, sizeof *encoded);
    if (format == NULL) {
        return IPC_No_Error;
    }
    if (format_is_bad(format)) {
        return IPC_Illegal_Formatter;
    }
    if (data == NULL && format_size(format) > 0) {
        return IPC_Null_Argument;
    }
    if (format_is_simple(format)) {
        encoded->content = data;
        encoded->length = format_size(format);
        return IPC_No_Error;
    }
    encoded->buffer = library->scratch;
    buffer_init(&library->scratch);
    library_leave(library);
    const int error = encode(format, data, encoded);
    mutex_lock(library->lock);
    return report_code(error);
}

void publish_release(struct library *library, struct encoded *encoded)
{
    if (encoded->buffer.bytes == NULL) {
        return;
    }
    if (library->scratch.bytes == NULL && encoded->buffer.capacity <= KEPT_SCRATCH) {
        library->scratch = encoded->buffer;
    } else {
        buffer_fini(&encoded->buffer);
    }
    buffer_init(&encoded->buffer);
}
