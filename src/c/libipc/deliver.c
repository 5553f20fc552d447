/*
 * Running the handlers of instances.
 */
#include "libipc/deliver.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "libipc/callback.h"
#include "libipc/known_arrays.h"
#include "libipc/report.h"
#include "libipc/subscription.h"
#include "libipc/watcher.h"

/* What is handed to the handler. */
struct handed {
    HANDLER_TYPE function;
    void *client_data;
    const struct format *format; /* NULL: bytes as they came */
    void *data;
    bool decoded; /* data is a value of its own, the bytes are not needed any more */
};

/* Leaves only the content in an instance that still has the whole frame's data. */
static int strip(struct instance *instance)
{
    const uint8_t *content;
    size_t length;
    if (!instance->wrapped) {
        return 0;
    }
    const int error = registry_unwrap(instance->message, instance->content, instance->length,
                                      instance->order, &content, &length);
    if (error != 0) {
        return error;
    }
    if (length > 0) {
        memmove(instance->content, content, length);
    } else {
        free(instance->content);
        instance->content = NULL;
    }
    instance->length = length;
    instance->wrapped = false;
    return 0;
}

/* Makes sure that the message's definition is known, or was when it arrived.  Waits at the first
 * instance of a message. */
static bool define(struct instance *instance)
{
    if (instance->message->known || !instance->wrapped) {
        return true;
    }
    struct _X_IPC_CONTEXT *context = instance->context;
    struct message *found = NULL;
    return registry_find(context, instance->message->name, false, &found) == IPC_No_Error &&
           context_is_connected(context);
}

/* Decodes for handlers that want data.  Runs without the lock. */
static int decode(const struct instance *instance, struct handed *handed)
{
    const struct format *format = handed->format;
    const struct format_source source = {instance->content, instance->length, instance->order};
    handed->data = instance->content;
    if (format == NULL || instance->length == 0) {
        return 0;
    }
    if (format_is_bad(format)) {
        return ERR_FORMAT;
    }
    if (format_is_simple(format) && instance->order == byte_order_of_host()) {
        /* The bytes are the value; what is behind it is of no matter. */
        return instance->length >= format_size(format) ? 0 : ERR_CONTENT;
    }
    handed->decoded = true;
    return format_decode_new(format, &source, &handed->data, NULL);
}

/* Calls the handler with the lock given up; the bytes or the data are the handler's from then on. */
static int call(struct instance *instance, struct handed *handed)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    struct library *library = context->library;
    const MSG_INSTANCE handle = instance_handle(instance);
    struct running running = callback_of(library, context, instance->dispatch);
    struct array_mark mark = {0, 0, 0, ORDER_LITTLE, {0}, {0}};
    instance->running = true;
    if (handed->format == NULL && instance->content != NULL) {
        mark = known_arrays_mark(instance->content, instance->length, instance->order);
        running.content = instance->content;
        running.content_length = instance->length;
        running.content_order = instance->order;
    }
    callback_begin(library, &running);
    const int error = decode(instance, handed);
    if (error == 0) {
        if (handed->decoded) {
            free(instance->content);
        }
        instance->content = NULL;
        handed->function(handle, handed->data, handed->client_data);
    }
    callback_end(library, &running);
    instance->running = false;
    if (error == 0 && running.content != NULL) {
        /* The handler has kept the bytes and may unmarshall them later, or has freed them itself. */
        known_arrays_add(library, &mark);
    }
    return error;
}

static void finish(struct instance *instance)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    if (instance->delayed && !instance->responded && !instance_is_stale(instance) &&
        context_is_connected(context)) {
        list_append(&context->delayed, &instance->in_queue);
        return;
    }
    instance_acknowledge(instance);
    instance_free(instance);
}

static void warn_undecodable(const struct instance *instance)
{
    report_warning("WARNING: Message '%s' could not be decoded\n", instance->message->name);
}

static void deliver_message(struct instance *instance)
{
    const struct handler *handler = instance->handler;
    if (!define(instance)) {
        if (context_is_connected(instance->context)) {
            warn_undecodable(instance);
        }
        return;
    }
    if (handler != NULL && !handler->subscribed) {
        report_warning("WARNING: Message '%s' received but not processed: Handler '%s' not "
                       "registered\n",
                       instance->message->name, handler->name);
        return;
    }
    struct handed handed = {instance->function, instance->client_data, NULL, NULL, false};
    if (handler != NULL) {
        handed.function = handler->function;
        handed.client_data = handler->client_data;
        handed.format = handler->unmarshall ? instance->message->content : NULL;
    }
    if (strip(instance) != 0 || call(instance, &handed) != 0) {
        warn_undecodable(instance);
    }
}

void deliver(struct instance *instance)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    /* From here on, because the lock may be given up before the handler runs, to ask central. */
    callback_take_turn(&context->turn);
    instance_activate(instance);
    if (instance->kind == INSTANCE_NOTICE) {
        watcher_run(instance);
    } else {
        deliver_message(instance);
    }
    finish(instance);
    callback_give_turn(context->library, &context->turn);
}
