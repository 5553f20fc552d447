/*
 * Requests about messages, formats and subscriptions.
 */
#include "central/service/request.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/routing/broadcasts.h"
#include "central/routing/conflict.h"
#include "central/routing/flow.h"
#include "central/routing/handler_list.h"
#include "central/service/services.h"

/* ---------------------------------------------------------------- definitions */

/* Names that the library looks up and relies on. */
static bool is_reserved(const char *name)
{
    static const char prefix[] = "x_ipc_";
    char beginning[sizeof prefix];
    if (strlen(name) < sizeof prefix - 1) {
        return false;
    }
    memcpy(beginning, name, sizeof prefix - 1);
    beginning[sizeof prefix - 1] = '\0';
    return table_same_name(TABLE_FOLDING, beginning, prefix);
}

static bool is_too_long(const char *text)
{
    return text != NULL && strlen(text) > LIMIT_FORMAT_TEXT;
}

/* Whether the definition may be carried out; if not, the log says why. */
static bool may_define(const struct request *request, const struct message_definition *definition,
                       const struct message *message)
{
    if (message_is_internal(message) || is_reserved(definition->name)) {
        request_ignore(request, "%s belongs to the server", definition->name);
        return false;
    }
    if (definition->class != CLASS_BROADCAST && definition->class != CLASS_QUERY &&
        definition->class != CLASS_INFORM) {
        request_ignore(request, "%s cannot be of class %d", definition->name, definition->class);
        return false;
    }
    if (is_too_long(definition->wire) || is_too_long(definition->content)) {
        request_ignore(request, "the format of %s is too long", definition->name);
        return false;
    }
    return true;
}

static void define(struct server *server, const struct module *module, struct message *message,
                   const struct message_definition *definition)
{
    const struct message_definition_texts texts = {module->name, definition->class,
                                                   definition->wire, definition->content};
    if (message_is_defined(message)) {
        log_redefined(&server->log, message);
        conflict_check(server, module, message, &texts);
    }
    message_define(&server->messages, message, definition->name, &texts);
    broadcasts_update(server, message, message->n_subscriptions);
    message->direct |= server->options->direct;
    if (message->handlers != NULL) {
        handler_list_changed(server, message);
    } else if (message->direct || message->handlers_wanted) {
        handler_list_keep(server, message);
    }
}

void service_define_message(struct request *request)
{
    const struct message_definition *definition = &request->payload->definition;
    struct message *message = request_get_message(request, definition->name);
    if (message != NULL && may_define(request, definition, message)) {
        define(request->server, request->module, message, definition);
    }
}

/* -------------------------------------------------------------- subscriptions */

static void subscribe(struct server *server, struct handler *handler, struct message *message)
{
    broadcasts_update(server, message, message->n_subscriptions + 1);
    (void)subscription_new(handler, message); /* its owners are handler and message */
    handler_list_changed(server, message);
    flow_adopt(server, message, handler);
}

void service_subscribe(struct request *request)
{
    const struct subscription_notice *notice = &request->payload->subscription;
    if (!request_names(request, notice->handler)) {
        return;
    }
    struct message *message = request_get_message(request, notice->message);
    if (message == NULL) {
        return;
    }
    if (!message_is_open(message)) {
        request_ignore(request, "%s is handled by the server", message->name);
        return;
    }
    if (notice->id < 0 && handler_find(request->module, notice->handler) == NULL) {
        request_ignore(request, "%d cannot be the number of a handler", notice->id);
        return;
    }
    struct handler *handler = handler_get(request->module, notice->handler, notice->id);
    if (handler == NULL || handler->n_subscriptions >= LIMIT_SUBSCRIPTIONS) {
        request_ignore(request, "there are too many handlers");
    } else if (subscription_find(handler, message) == NULL) {
        subscribe(request->server, handler, message);
    }
}

void service_unsubscribe(struct request *request)
{
    struct server *server = request->server;
    const struct subscription_notice *notice = &request->payload->subscription;
    if (!request_names(request, notice->message) || !request_names(request, notice->handler)) {
        return;
    }
    struct message *message = message_find(&server->messages, notice->message);
    const struct handler *handler = handler_find(request->module, notice->handler);
    struct subscription *subscription =
        message == NULL || handler == NULL ? NULL : subscription_find(handler, message);
    if (subscription == NULL) {
        request_ignore(request, "%s does not handle %s", notice->handler, notice->message);
        return;
    }
    subscription_free(subscription);
    handler_list_changed(server, message);
    broadcasts_update(server, message, message->n_subscriptions);
}

/* -------------------------------------------------------------- named formats */

void service_define_format(struct request *request)
{
    struct server *server = request->server;
    const struct two_names *definition = &request->payload->names;
    if (!request_names(request, definition->first)) {
        return;
    }
    if (definition->second == NULL || is_too_long(definition->second)) {
        request_ignore(request, "the format %s has no text, or too long a one", definition->first);
        return;
    }
    if (!format_names_holds(server->names, definition->first) &&
        server->n_named_formats >= LIMIT_NAMED_FORMATS) {
        request_ignore(request, "there are too many named formats");
        return;
    }
    server->n_named_formats += !format_names_holds(server->names, definition->first);
    if (format_names_define(server->names, definition->first, definition->second) != 0) {
        request_ignore(request, "%s cannot be the name of a format", definition->first);
    }
}

void service_get_format(struct request *request)
{
    const struct format_names *names = request->server->names;
    const char *name = request->payload->name;
    struct format *format = NULL;
    if (!request_names(request, name) || !format_names_holds(names, name) ||
        format_parse(name, names, &format, NULL) != 0) {
        format = format_ref(format_bad());
    }
    request_answer(request, &format);
    format_unref(format);
}

/* ---------------------------------------------------------------- about messages */

void service_priority(struct request *request)
{
    const struct name_and_number *priority = &request->payload->name_and_number;
    struct message *message = request_get_message(request, priority->name);
    if (message != NULL) {
        pending_subject_set_priority(&message->subject, priority->number);
        request->server->has_priorities = true;
    }
}

void service_messages(struct request *request)
{
    const struct table *names = &request->server->messages.names;
    struct name_list list = {0, 0, NULL};
    list.names = mem_new(names->count * sizeof *list.names);
    for (struct table_entry *at = table_first(names); at != NULL; at = table_next(names, at)) {
        const struct message *message = at->value;
        if (!message->ignored) {
            list.names[list.used++] = message->name;
        }
    }
    list.room = list.used;
    request_answer(request, &list);
    free(list.names);
}

/* The text of a format as it was given, or as it is written; malloc, NULL: none. */
static char *text_of(const char *given, const struct format *format)
{
    return given != NULL || format == NULL ? mem_copy_string(given) : format_canonical(format);
}

void service_message_details(struct request *request)
{
    const char *name = request->payload->name;
    struct message_details details = {(char *)(uintptr_t)name, NULL, NULL, 0, NULL, 0};
    const struct message *message =
        request_names(request, name) ? message_find(&request->server->messages, name) : NULL;
    if (message != NULL) {
        const struct subscription *latest = subscription_latest(message);
        details.name = message->name;
        details.wire = text_of(message->wire_text, message->wire);
        details.content = text_of(message->content_text, message->content);
        details.class = message->class;
        details.resource = latest == NULL ? NULL : latest->handler->resource->name;
        details.n_handlers = (int)message->n_subscriptions;
    }
    request_answer(request, &details);
    free(details.wire);
    free(details.content);
}

static void set_ignored(const struct request *request, bool ignored)
{
    struct message *message = request_get_message(request, request->payload->name);
    if (message != NULL) {
        message->ignored = ignored;
    }
}

void service_ignore_logging(struct request *request)
{
    set_ignored(request, true);
}

void service_resume_logging(struct request *request)
{
    set_ignored(request, false);
}
