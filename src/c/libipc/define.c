/*
 * Defining messages and named formats.
 */
#include "libipc/define.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"
#include "libipc/registry.h"
#include "libipc/report.h"

#define VARIABLE_WIRE "{int, <byte:1>}"

/* Whether length and format fit each other; the format is parsed to know its size. */
static IPC_ERROR_TYPE check(struct library *library, unsigned int length, const char *text)
{
    struct format *format;
    const enum formatter_result result = formatter_parse(library, text, &format);
    if (length == IPC_VARIABLE_LENGTH) {
        /* A name that is not known yet may still be defined. */
        return result == FORMATTER_ILLEGAL ? IPC_Illegal_Formatter : IPC_No_Error;
    }
    if (result != FORMATTER_OK || (format != NULL && format_size(format) != length)) {
        return IPC_Mismatched_Formatter;
    }
    return length <= LIMIT_DATA ? IPC_No_Error : IPC_Argument_Out_Of_Range;
}

static void warn_of_change(const char *name, const struct format *before, const char *text)
{
    char *canonical = before != NULL ? format_canonical(before) : NULL;
    report_warning("WARNING: Redefining message %s\n  format before: %s\n  format now: %s\n", name,
                   canonical != NULL ? canonical : "none",
                   text != NULL && *text != '\0' ? text : "none");
    free(canonical);
}

/* A definition that this module has used before is not what it will use from now on. */
static void renew(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                  const char *text)
{
    struct message *message = table_find(&context->messages, name);
    struct format *format;
    if (message == NULL || !message->known) {
        return;
    }
    const enum wire_kind wire = length == IPC_VARIABLE_LENGTH ? WIRE_VARIABLE
                                : length == 0                 ? WIRE_NONE
                                                              : WIRE_FIXED;
    const bool same_format = formatter_parse(context->library, text, &format) == FORMATTER_OK &&
                             format_equal(format, message->content);
    if (message->wire != wire || (wire == WIRE_FIXED && message->fixed_length != length) ||
        !same_format) {
        warn_of_change(name, message->content, text);
    }
    registry_renew(message);
}

/* ---------------------------------------------------------------- definitions */

/* What this module has said of a message, as central is told it. */
struct definition {
    char *name;    /* in this spelling */
    char *wire;    /* NULL: no data */
    char *content; /* NULL: no format */
};

/* The text of the frame's format; the caller frees it. */
static char *wire_text(unsigned int length)
{
    char fixed[32];
    snprintf(fixed, sizeof fixed, "[byte:%u]", length);
    return length == 0 ? NULL : mem_copy_string(length == IPC_VARIABLE_LENGTH ? VARIABLE_WIRE : fixed);
}

static struct definition *definition_new(struct library *library, const char *name,
                                         unsigned int length, const char *text)
{
    struct definition *definition = mem_new(sizeof *definition);
    definition->name = mem_copy_string(name);
    definition->wire = wire_text(length);
    definition->content = formatter_portable(library, text);
    return definition;
}

static void definition_free(struct definition *definition)
{
    if (definition != NULL) {
        free(definition->name);
        free(definition->wire);
        free(definition->content);
        free(definition);
    }
}

static struct message_definition notice_of(const struct definition *definition)
{
    const struct message_definition notice = {definition->name, CLASS_BROADCAST, definition->wire,
                                              definition->content};
    return notice;
}

void define_forget(struct message *message)
{
    definition_free(message->definition);
    message->definition = NULL;
}

void define_tell_all(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        const struct message *message = entry->value;
        if (message->definition != NULL) {
            const struct message_definition notice = notice_of(message->definition);
            exchange_tell(context, LM_DEFINE_MESSAGE, &notice);
        }
    }
}

/* With texts of its own: sending may wait, and another thread define the message meanwhile. */
static IPC_ERROR_TYPE send(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                           const char *text)
{
    struct definition *definition = definition_new(context->library, name, length, text);
    const struct message_definition notice = notice_of(definition);
    const IPC_ERROR_TYPE error = exchange_notice(context, LM_DEFINE_MESSAGE, &notice);
    definition_free(definition);
    return error;
}

IPC_ERROR_TYPE define_again(struct _X_IPC_CONTEXT *context, const struct message *message)
{
    const unsigned int length = message->wire == WIRE_NONE    ? 0
                                : message->wire == WIRE_FIXED ? (unsigned int)message->fixed_length
                                                              : IPC_VARIABLE_LENGTH;
    char *text = message->content != NULL ? format_canonical(message->content) : NULL;
    const IPC_ERROR_TYPE error = format_is_bad(message->content)
                                     ? IPC_Illegal_Formatter
                                     : send(context, message->name, length, text);
    free(text);
    return error;
}

IPC_ERROR_TYPE define_message(struct _X_IPC_CONTEXT *context, const char *name,
                              unsigned int length, const char *text)
{
    struct library *library = context->library;
    const IPC_ERROR_TYPE error = check(library, length, text);
    if (error != IPC_No_Error) {
        return error;
    }
    renew(context, name, length, text);
    struct message *message = registry_get(context, name);
    define_forget(message);
    message->definition = definition_new(library, name, length, text);
    return send(context, name, length, text);
}

IPC_ERROR_TYPE define_format(struct library *library, struct _X_IPC_CONTEXT *context,
                             const char *name, const char *text)
{
    const int error = formatter_define(library, name, text);
    if (error != 0) {
        return report_code(error);
    }
    if (context == NULL) {
        return IPC_No_Error;
    }
    char *portable = formatter_portable(library, text);
    struct two_names definition = {(char *)(uintptr_t)name, portable};
    const IPC_ERROR_TYPE told = exchange_notice(context, LM_DEFINE_FORMAT, &definition);
    free(portable);
    return told;
}
