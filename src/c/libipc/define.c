/*
 * Defining messages and named formats.
 */
#include "libipc/define.h"

#include <stdlib.h>

#include "base/error.h"
#include "base/limits.h"
#include "libipc/definition.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"
#include "libipc/registry.h"
#include "libipc/report.h"

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

void define_tell_all(struct _X_IPC_CONTEXT *context)
{
    struct table_entry *entry = table_first(&context->messages);
    for (; entry != NULL; entry = table_next(&context->messages, entry)) {
        const struct message *message = entry->value;
        if (message->definition != NULL) {
            definition_tell(context, message->definition);
        }
    }
}

IPC_ERROR_TYPE define_message(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                              const char *text)
{
    struct library *library = context->library;
    const IPC_ERROR_TYPE error = check(library, length, text);
    if (error != IPC_No_Error) {
        return error;
    }
    renew(context, name, length, text);
    struct message *message = registry_get(context, name);
    definition_free(message->definition);
    message->definition = definition_new(library, name, length, text);
    return definition_send(context, name, length, text);
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
