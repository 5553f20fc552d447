/*
 * Variables: values that the server keeps for everybody.
 */
#include "central/routing/variable.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/routing/own_request.h"

struct variable *variable_find(const struct server *server, const char *name)
{
    return table_find(&server->variables, name);
}

/* ------------------------------------------------------------- four messages */

struct role {
    const char *prefix;
    int class;
    bool takes_value;
    bool gives_value;
};

/* By kind of message, from MESSAGE_SET on. */
static const struct role roles[N_VARIABLE_MESSAGES] = {
    [MESSAGE_SET - MESSAGE_SET] = {VARIABLE_SET, CLASS_INFORM, true, false},
    [MESSAGE_GET - MESSAGE_SET] = {VARIABLE_GET, CLASS_QUERY, false, true},
    [MESSAGE_GET_SET - MESSAGE_SET] = {VARIABLE_GET_SET, CLASS_QUERY, true, true},
    [MESSAGE_WATCH - MESSAGE_SET] = {VARIABLE_WATCH, CLASS_BROADCAST, true, false},
};

/* The message of that prefix for a variable of that name, NULL when there are too many. */
static struct message *get_message(struct server *server, const char *prefix,
                                   const char *variable_name)
{
    const size_t size = strlen(prefix) + strlen(variable_name) + 1;
    char *name = mem_new(size);
    (void)snprintf(name, size, "%s%s", prefix, variable_name);
    struct message *message = message_get(&server->messages, name);
    free(name);
    return message;
}

/* Finds the four messages; false when one cannot be had or is a user's already. */
static bool get_messages(struct server *server, const char *name, struct message **messages)
{
    for (size_t i = 0; i < N_VARIABLE_MESSAGES; i++) {
        messages[i] = get_message(server, roles[i].prefix, name);
        if (messages[i] == NULL ||
            (message_is_defined(messages[i]) && !message_is_internal(messages[i]))) {
            return false;
        }
    }
    return true;
}

static void define_messages(struct server *server, struct variable *variable)
{
    for (size_t i = 0; i < N_VARIABLE_MESSAGES; i++) {
        struct message *message = variable->messages[i];
        message_define_internal(&server->messages, message,
                                (enum message_kind)(MESSAGE_SET + (int)i), roles[i].class,
                                roles[i].takes_value ? variable->format : NULL,
                                roles[i].gives_value ? variable->format : NULL);
        message->variable = variable;
    }
}

/* ---------------------------------------------------------------- definition */

static struct variable *get(struct server *server, const char *name)
{
    struct variable *variable = variable_find(server, name);
    if (variable != NULL || server->variables.count >= LIMIT_VARIABLES) {
        return variable;
    }
    variable = mem_new(sizeof *variable);
    variable->name = mem_copy_string(name);
    (void)table_put(&server->variables, name, variable); /* replaces nothing */
    return variable;
}

struct variable *variable_define(struct server *server, const char *name, struct format *format)
{
    struct message *messages[N_VARIABLE_MESSAGES];
    if (!get_messages(server, name, messages)) {
        return NULL;
    }
    struct variable *variable = get(server, name);
    if (variable == NULL) {
        return NULL;
    }
    struct format *before = variable->format;
    variable->format = format_ref(format);
    format_unref(before);
    block_unref(variable->value);
    variable->value = NULL;
    memcpy(variable->messages, messages, sizeof messages);
    define_messages(server, variable);
    return variable;
}

struct variable *variable_define_own(struct server *server, const char *name, const char *text,
                                     struct format *format)
{
    /* Encoding writes through no pointer, whatever the payload's type says. */
    const struct two_names definition = {(char *)(uintptr_t)name, (char *)(uintptr_t)text};
    struct dispatch *request =
        own_request_begin_value(server, server->library[LM_REGISTER_VARIABLE], &definition);
    struct variable *variable = variable_define(server, name, format);
    if (variable != NULL) {
        variable->of_server = true;
        for (size_t i = 0; i < N_VARIABLE_MESSAGES; i++) {
            variable->messages[i]->ignored = true;
        }
    }
    own_request_end(server, request);
    return variable;
}

void variable_free_all(struct server *server)
{
    for (struct table_entry *entry = table_first(&server->variables); entry != NULL;
         entry = table_next(&server->variables, entry)) {
        struct variable *variable = entry->value;
        format_unref(variable->format);
        block_unref(variable->value);
        free(variable->name);
        free(variable);
    }
    table_fini(&server->variables);
}
