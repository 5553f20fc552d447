/*
 * Definitions of messages.
 */
#include "libipc/definition.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"

#define VARIABLE_WIRE "{int, <byte:1>}"

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
    return length == 0 ? NULL
                       : mem_copy_string(length == IPC_VARIABLE_LENGTH ? VARIABLE_WIRE : fixed);
}

struct definition *definition_new(struct library *library, const char *name, unsigned int length,
                                  const char *text)
{
    struct definition *definition = mem_new(sizeof *definition);
    definition->name = mem_copy_string(name);
    definition->wire = wire_text(length);
    definition->content = formatter_portable(library, text);
    return definition;
}

void definition_free(struct definition *definition)
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

void definition_tell(struct _X_IPC_CONTEXT *context, const struct definition *definition)
{
    const struct message_definition notice = notice_of(definition);
    exchange_tell(context, LM_DEFINE_MESSAGE, &notice);
}

/* With texts of its own: sending may wait, and another thread define the message meanwhile. */
IPC_ERROR_TYPE definition_send(struct _X_IPC_CONTEXT *context, const char *name,
                               unsigned int length, const char *text)
{
    struct definition *definition = definition_new(context->library, name, length, text);
    const struct message_definition notice = notice_of(definition);
    const IPC_ERROR_TYPE error = exchange_notice(context, LM_DEFINE_MESSAGE, &notice);
    definition_free(definition);
    return error;
}
