/*
 * The messages of one connection.
 */
#include "libipc/registry.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "libipc/definition.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"
#include "libipc/peer.h"
#include "libipc/report.h"

struct message *registry_get(struct _X_IPC_CONTEXT *context, const char *name)
{
    struct message *message = table_find(&context->messages, name);
    if (message == NULL) {
        message = mem_new(sizeof *message);
        message->name = mem_copy_string(name);
        message->priority = -1;
        (void)table_put(&context->messages, name, message); /* new, so nothing is replaced */
    }
    return message;
}

static void learn_wire(struct message *message, const struct format *wire)
{
    message->fixed_length = 0;
    if (wire == NULL) {
        message->wire = WIRE_NONE;
    } else if (format_is_flat(wire)) {
        message->wire = WIRE_FIXED;
        message->fixed_length = format_size(wire);
    } else {
        message->wire = WIRE_VARIABLE;
    }
}

void registry_learn(struct _X_IPC_CONTEXT *context, const char *name,
                    const struct message_info *info)
{
    if (info == NULL || info->class == CLASS_SUBSCRIBED || info->name == NULL || info->id == 0) {
        return;
    }
    struct message *message = registry_get(context, name);
    /* In place, because others hold the pointer; spellings of one name differ in case only. */
    if (strlen(info->name) == strlen(message->name)) {
        memcpy(message->name, info->name, strlen(info->name));
    }
    message->known = true;
    message->lost = false;
    message->id = info->id;
    learn_wire(message, info->wire);
    message->content = NULL;
    if (info->content != NULL) {
        message->content = formatter_keep(context->library, format_ref(info->content));
    }
}

/* Asks central and learns its answer; *exists tells whether it knows the name. */
static IPC_ERROR_TYPE ask(struct _X_IPC_CONTEXT *context, const char *name, bool *exists)
{
    /* The request's strings are only read. */
    struct message_info_request request = {(char *)(uintptr_t)name, NULL};
    struct optional_message_info reply;
    const IPC_ERROR_TYPE error = exchange_ask(context, LM_MESSAGE_INFO, &request, &reply);
    *exists = reply.info != NULL;
    if (error == IPC_No_Error) {
        registry_learn(context, name, reply.info);
        (void)format_release(context->library->catalogue.reply[LM_MESSAGE_INFO], &reply);
    }
    return error;
}

/* Defines a message as another module had defined it at a central that has been lost. */
static IPC_ERROR_TYPE define_again(struct _X_IPC_CONTEXT *context, const struct message *message)
{
    const unsigned int length = message->wire == WIRE_NONE    ? 0
                                : message->wire == WIRE_FIXED ? (unsigned int)message->fixed_length
                                                              : IPC_VARIABLE_LENGTH;
    char *text = message->content != NULL ? format_canonical(message->content) : NULL;
    const IPC_ERROR_TYPE error = format_is_bad(message->content)
                                     ? IPC_Illegal_Formatter
                                     : definition_send(context, message->name, length, text);
    free(text);
    return error;
}

/* What other modules have defined is not known to a central that has come back before they have. */
static IPC_ERROR_TYPE ask_again_if_lost(struct _X_IPC_CONTEXT *context, const char *name,
                                        bool *exists)
{
    const struct message *message = table_find(&context->messages, name);
    if (message == NULL || message->known || !message->lost) {
        return IPC_No_Error;
    }
    const IPC_ERROR_TYPE error = define_again(context, message);
    return error == IPC_No_Error ? ask(context, name, exists) : error;
}

IPC_ERROR_TYPE registry_find(struct _X_IPC_CONTEXT *context, const char *name, bool loud,
                             struct message **message)
{
    bool exists;
    *message = NULL;
    struct message *entry = table_find(&context->messages, name);
    if (entry != NULL && entry->known) {
        *message = entry;
        return IPC_No_Error;
    }
    IPC_ERROR_TYPE error = ask(context, name, &exists);
    if (error == IPC_No_Error && loud) {
        error = ask_again_if_lost(context, name, &exists);
    }
    if (error != IPC_No_Error) {
        return error;
    }
    entry = table_find(&context->messages, name);
    if (entry != NULL && entry->known) {
        *message = entry;
        return IPC_No_Error;
    }
    if (loud) {
        report_note(exists ? "ERROR: x_ipc_msgFind: Message %s used before registered.\n\n"
                           : "ERROR: x_ipc_msgFind: Query for message %s returned NULL.\n\n",
                    name);
    }
    return IPC_Message_Not_Defined;
}

void registry_forget_targets(struct message *message)
{
    for (size_t i = 0; i < message->n_targets; i++) {
        peer_unref(message->targets[i].peer);
    }
    free(message->targets);
    message->targets = NULL;
    message->n_targets = 0;
}

/* Frees the list of a message's handlers, and what has been made of it. */
static void forget_handlers(const struct _X_IPC_CONTEXT *context, struct message *message)
{
    (void)format_release(context->library->catalogue.handler_list, &message->handlers);
    registry_forget_targets(message);
}

void registry_lose(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        struct message *message = entry->value;
        message->lost = message->lost || message->known;
        message->known = false;
        message->handlers_known = false;
        forget_handlers(context, message);
    }
}

void registry_renew(struct message *message)
{
    message->known = false;
    message->lost = false;
}

void registry_clear(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        struct message *message = entry->value;
        forget_handlers(context, message);
        definition_free(message->definition);
        free(message->name);
        free(message);
    }
    table_fini(&context->messages);
    table_init(&context->messages, TABLE_FOLDING);
}

static int unwrap_variable(const uint8_t *data, size_t length, enum byte_order order,
                           const uint8_t **content, size_t *content_length)
{
    *content = NULL;
    *content_length = 0;
    if (length == 0) {
        return 0;
    }
    if (length < 8) {
        return ERR_CONTENT;
    }
    const uint32_t said = load_32(data, order);
    if (said != load_32(data + 4, order) || said != length - 8) {
        return ERR_CONTENT;
    }
    *content = data + 8;
    *content_length = length - 8;
    return 0;
}

int registry_unwrap(const struct message *message, const uint8_t *data, size_t length,
                    enum byte_order order, const uint8_t **content, size_t *content_length)
{
    if (message->wire == WIRE_VARIABLE) {
        return unwrap_variable(data, length, order, content, content_length);
    }
    *content = data;
    *content_length = length;
    return length == message->fixed_length ? 0 : ERR_CONTENT;
}
