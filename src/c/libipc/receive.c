/*
 * Taking in what comes from central.
 */
#include "libipc/receive.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/peer.h"
#include "libipc/report.h"
#include "libipc/subscription.h"
#include "libipc/wait.h"

/* A connection that does not stop to send is left now and then, so that others get their turn. */
enum { MAX_READS = 64 };

/* With so much in the inbox, some is to be handled first, while it is in the processor's cache and
 * before more memory is needed. */
enum { ENOUGH_BYTES = 1024 * 1024 };

static bool is_enough(const struct _X_IPC_CONTEXT *context, int n_reads)
{
    return n_reads == MAX_READS || context->inbox_bytes >= ENOUGH_BYTES;
}

/* Bytes of a frame in a malloc block, NULL for none of them: 0 or ERR_MEMORY.  The memory of a large
 * frame is used again, so that the frame has no bytes after that. */
static int take_bytes(const struct frame *frame, const uint8_t *bytes, size_t length,
                      uint8_t **taken)
{
    *taken = NULL;
    if (length == 0) {
        return 0;
    }
    if (frame->block != NULL) {
        *taken = block_take(frame->block);
    }
    if (*taken == NULL) {
        *taken = malloc(length);
    }
    if (*taken == NULL) {
        return ERR_MEMORY;
    }
    memmove(*taken, bytes, length);
    return 0;
}

/* ------------------------------------------------------------------- greeting */

/* The number of the look-up message, then two frames with formats that are known here. */
static int take_greeting(struct _X_IPC_CONTEXT *context)
{
    struct reader *reader = &context->link.reader;
    while (context->greeting < GREETING_PARTS) {
        struct frame frame;
        const uint8_t *number;
        const int taken = context->greeting == 0 ? reader_take_raw(reader, 4, &number)
                                                 : reader_next(reader, &frame);
        if (taken <= 0) {
            return taken;
        }
        if (context->greeting == 0) {
            context->library_ids[LM_MESSAGE_INFO] = (int32_t)load_be32(number);
        } else if (frame.class != CLASS_NONE || frame.intent != 0) {
            return ERR_PROTOCOL;
        }
        context->greeting++;
    }
    return 1;
}

/* -------------------------------------------------------------------- replies */

/* The message name in a frame's class data, not terminated; NULL if there is none. */
static const char *class_text(const struct frame *frame, size_t *length)
{
    *length = 0;
    if (frame->class_length < 4) {
        return NULL;
    }
    *length = load_32(frame->class_data, (enum byte_order)frame->class_order);
    return *length > 0 && *length <= frame->class_length - 4 ? (const char *)frame->class_data + 4
                                                             : NULL;
}

static int queue_reply(struct _X_IPC_CONTEXT *context, struct awaited *awaited)
{
    struct instance *instance = instance_new(context, INSTANCE_REPLY);
    instance->message = registry_get(context, awaited->name);
    instance->function = awaited->handler;
    instance->client_data = awaited->client_data;
    instance->class = CLASS_REPLY;
    instance->wrapped = true;
    instance->content = awaited->data;
    instance->length = awaited->length;
    instance->order = awaited->order;
    free(awaited->name);
    free(awaited);
    inbox_add(instance);
    return 0;
}

static int take_reply(struct _X_IPC_CONTEXT *context, const struct frame *frame)
{
    struct awaited *awaited = intmap_remove(&context->awaited, (uint64_t)frame->reference);
    if (awaited == NULL) {
        return 0; /* whoever asked has given up */
    }
    awaited->done = true;
    awaited->order = (enum byte_order)frame->data_order;
    awaited->length = frame->data_length;
    size_t name_length;
    const char *name = class_text(frame, &name_length);
    awaited->name = name != NULL ? mem_copy_text(name, name_length) : NULL;
    const int error = take_bytes(frame, frame->data, frame->data_length, &awaited->data);
    if (!awaited->notify) {
        return error;
    }
    if (error != 0 || awaited->name == NULL || awaited->handler == NULL) {
        free(awaited->data);
        free(awaited->name);
        free(awaited);
        return error;
    }
    return queue_reply(context, awaited);
}

/* ----------------------------------------------------------------- deliveries */

/* Nearly always the message that the handler was subscribed to, in the same spelling. */
static struct message *message_of(struct _X_IPC_CONTEXT *context, const struct handler *handler,
                                  const struct frame *frame)
{
    size_t length;
    const char *text = class_text(frame, &length);
    const char *usual = handler->message->name;
    if (text == NULL || (strncmp(text, usual, length) == 0 && usual[length] == '\0')) {
        return handler->message;
    }
    char *name = mem_copy_text(text, length);
    struct message *message = registry_get(context, name);
    free(name);
    return message;
}

/* Takes the payload over: only the content where the message is known, all of the data where not. */
static int take_content(struct instance *instance, const struct frame *frame)
{
    const uint8_t *content;
    size_t length;
    instance->order = (enum byte_order)frame->data_order;
    instance->wrapped = !instance->message->known ||
                        registry_unwrap(instance->message, frame->data, frame->data_length,
                                        instance->order, &content, &length) != 0;
    if (instance->wrapped) {
        content = frame->data;
        length = frame->data_length;
    }
    instance->length = length;
    return take_bytes(frame, content, length, &instance->content);
}

/* What a handler of the user gets; peer: who sent it directly, NULL for central. */
static int queue_delivery(struct _X_IPC_CONTEXT *context, struct handler *handler,
                          const struct frame *frame, struct peer *peer)
{
    struct instance *instance = instance_new(context, INSTANCE_DELIVERY);
    instance->handler = handler;
    instance->message = message_of(context, handler, frame);
    instance->class = frame->class;
    if (peer == NULL) {
        instance->dispatch = frame->reference;
    } else {
        instance->peer = peer_ref(peer);
        instance->reference = frame->reference;
    }
    const int error = take_content(instance, frame);
    if (error != 0) {
        instance_free(instance);
        return error;
    }
    inbox_add(instance);
    return 0;
}

static int take_delivery(struct _X_IPC_CONTEXT *context, const struct frame *frame,
                         struct peer *peer)
{
    struct handler *handler = idpool_get(&context->handler_ids, frame->intent);
    context->unfinished += peer == NULL;
    if (handler != NULL && handler->internal == NULL) {
        return queue_delivery(context, handler, frame, peer);
    }
    if (handler == NULL) {
        report_warning("WARNING: Message received but not processed: Handler '%" PRId32
                       "' not registered\n",
                       frame->intent);
    }
    if (peer == NULL && (handler == NULL || handler->internal(context, handler, frame))) {
        context_acknowledge(context, frame->reference);
    }
    return 0;
}

/* --------------------------------------------------------------------- stream */

static int take_frame(struct _X_IPC_CONTEXT *context, const struct frame *frame, struct peer *peer)
{
    if (frame->intent == INTENT_REPLY) {
        return take_reply(context, frame);
    }
    return frame->intent >= 0 ? take_delivery(context, frame, peer) : ERR_PROTOCOL;
}

/* Takes in the complete frames that have been read: their number, or an error. */
static int take_frames(struct _X_IPC_CONTEXT *context, struct link *link, struct peer *peer)
{
    int n_frames = 0;
    int result;
    do {
        struct frame frame;
        result = reader_next(&link->reader, &frame);
        if (result > 0) {
            const int error = take_frame(context, &frame, peer);
            result = error != 0 ? error : 1;
            n_frames++;
        }
    } while (result > 0);
    return result < 0 ? result : n_frames;
}

/* Something has come, perhaps what others wait for: of what is read already the one in the kernel would
 * not hear. */
static void tell_others(const struct _X_IPC_CONTEXT *context)
{
    wait_wake(context->library);
}

bool receive(struct _X_IPC_CONTEXT *context)
{
    bool any = false;
    bool more = true;
    for (int n_reads = 1; more && context_is_open(context); n_reads++) {
        int result = link_read(&context->link, &more);
        if (result == 0) {
            break;
        }
        if (result > 0) {
            any = true;
            result = context->greeting < GREETING_PARTS ? take_greeting(context) : 1;
        }
        if (result > 0) {
            result = take_frames(context, &context->link, NULL);
            context->try_first = result > 1;
        }
        if (result < 0) {
            context_lose(context, true);
        }
        more = more && !is_enough(context, n_reads);
    }
    if (any) {
        tell_others(context);
    }
    return any;
}

bool receive_from_peer(struct peer *peer)
{
    bool any = false;
    bool more = true;
    (void)peer_ref(peer); /* it may end meanwhile */
    for (int n_reads = 1; more && peer->link.fd >= 0; n_reads++) {
        int result = link_read(&peer->link, &more);
        if (result == 0) {
            break;
        }
        any = any || result > 0;
        if (result > 0) {
            result = take_frames(peer->context, &peer->link, peer);
        }
        if (result < 0) {
            peer_end(peer);
        }
        more = more && !is_enough(peer->context, n_reads);
    }
    if (any) {
        tell_others(peer->context);
    }
    peer_unref(peer);
    return any;
}

/* --------------------------------------------------------------- as a source */

static struct _X_IPC_CONTEXT *context_of(const struct source *source)
{
    return LIST_OWNER(source, struct _X_IPC_CONTEXT, source);
}

static bool write_queued(struct source *source)
{
    struct _X_IPC_CONTEXT *context = context_of(source);
    if (link_waiting(&context->link) == 0) {
        return false;
    }
    const IPC_ERROR_TYPE error = exchange_flush(context);
    return error != IPC_No_Error || (context->writers > 0 && link_waiting(&context->link) == 0);
}

static int wanted(const struct source *source)
{
    return link_waiting(&context_of(source)->link) > 0 ? READY_READ | READY_WRITE : READY_READ;
}

static void take_found(struct source *source, int found)
{
    struct _X_IPC_CONTEXT *context = context_of(source);
    if (found & READY_WRITE) {
        (void)exchange_flush(context); /* a loss shows in the context's state */
    }
    if (found & (READY_READ | READY_ERROR)) {
        (void)receive(context); /* so does what came */
    }
}

static const struct source_kind central_kind = {write_queued, wanted, take_found};

void receive_start(struct _X_IPC_CONTEXT *context)
{
    source_init(&context->source, &central_kind, context->link.fd);
    wait_add(context->library, &context->source);
}
