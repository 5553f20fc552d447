/*
 * Requests of modules that connect and leave.
 */
#include "central/service/request.h"

#include "central/routing/ending.h"
#include "central/routing/notify.h"
#include "central/service/services.h"
#include "central/routing/start.h"
#include "central/settings/version.h"

/* Notes what a look-up tells about the module that asks. */
static void learn_from_look_up(struct request *request)
{
    const struct message_info_request *asked = &request->payload->message_info;
    if (table_same_name(TABLE_FOLDING, asked->message, ABILITY_IN_ORDER)) {
        request->module->in_order = true;
    }
    if (table_same_name(TABLE_FOLDING, asked->message, ABILITY_AHEAD)) {
        request->module->takes_ahead = true;
    }
    if (asked->handler != NULL && handler_find(request->module, asked->handler) == NULL) {
        log_notice(&request->server->log, "\nWARNING: msgInfoHnd: Missing handler: %s\n",
                   asked->handler);
    }
}

static void log_bad_format(const struct request *request, struct message *message)
{
    if (!message->bad_is_logged) {
        message->bad_is_logged = true;
        log_status(&request->server->log, "WARNING: the format of %s is bad\n", message->name);
    }
}

void service_message_info(struct request *request)
{
    struct server *server = request->server;
    struct optional_message_info reply = {NULL};
    struct message *message = NULL;
    if (request_names(request, request->payload->message_info.message)) {
        message = message_find(&server->messages, request->payload->message_info.message);
        learn_from_look_up(request);
    }
    if (message == NULL) {
        request_answer(request, &reply);
        return;
    }
    if (message_parse(message, server->names) != 0) {
        log_bad_format(request, message);
    }
    struct message_info info = {message->direct ? -message->id : message->id, message->name,
                                message->class, message->wire, message->content};
    reply.info = &info;
    request_answer(request, &reply);
}

/* Formats of class data; all but those of 2 and 13 belong to classes that nobody sends any more. */
static const char *class_format(int class)
{
    switch (class) {
    case 4:
    case 7:
    case 9:
    case 14:
        return "int";
    case 5:
    case 16:
        return "{int, int}";
    case CLASS_DELIVERY:
    case CLASS_FAILURE:
        return "string";
    case 8:
    case 10:
        return "{{int, {int, int}}, {int, {int, int}}, *{int, int, int, int, int}}";
    default:
        return NULL;
    }
}

void service_class_info(struct request *request)
{
    const char *text = class_format(request->payload->number);
    struct class_info info = {request->payload->number, NULL};
    struct optional_class_info reply = {NULL};
    if (text != NULL && format_parse(text, NULL, &info.format, NULL) == 0) {
        reply.info = &info;
    }
    request_answer(request, &reply);
    format_unref(info.format);
}

void service_introduction(struct request *request)
{
    struct server *server = request->server;
    struct module *module = request->module;
    const struct introduction *introduction = &request->payload->introduction;
    if (module->state != MODULE_GREETED) {
        request_ignore(request, "the module has introduced itself before");
        return;
    }
    if (!request_names(request, introduction->module)) {
        return;
    }
    list_remove(&module->in_state);
    server->n_greeted--;
    module_introduce(module, introduction->module,
                     introduction->host == NULL ? "" : introduction->host, &server->places);
    module->when_full = full_policies_of(&server->options->when_full, module->name);
    log_always(&server->log, " Received a new connection: %d\n   modName : %s\n   hostName: %s\n",
               module->shown_fd, module->name, module->host);
    notify(server, LM_CONNECTED, module);
    namesakes_add(&server->module_names, module->name, &module->same_name);
    namesakes_add(&server->resource_names, module->name, &module->own->same_name);
    const struct introduction_reply reply = {PROTOCOL_MAJOR, PROTOCOL_MINOR,
                                             server->options->direct};
    request_answer(request, &reply);
    start_check(server);
}

void service_ready(struct request *request)
{
    start_ask(request->server, request->module, request_keep(request));
}

void service_close(struct request *request)
{
    ending(request->server, request->module, ENDING_NOTICE);
}
