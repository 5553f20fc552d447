/*
 * Requests about modules and their handlers.
 */
#include "central/service/request.h"

#include <stdlib.h>

#include "base/memory.h"
#include "central/routing/answer.h"
#include "central/routing/handler_list.h"
#include "central/service/services.h"
#include "central/routing/start.h"
#include "central/settings/version.h"
#include "platform/owner.h"

enum { HIGHEST_PORT = 65535 };

void service_is_connected(struct request *request)
{
    const char *name = request->payload->name;
    const int is_connected = request_names(request, name) &&
                             (namesakes_find(&request->server->module_names, name) != NULL ||
                              table_same_name(TABLE_FOLDING, name, SERVER_NAME));
    request_answer(request, &is_connected);
}

/* Where the modules of a name run, so that who may can end them: see killModule. */
void service_processes(struct request *request)
{
    enum { MOST = 1000 };
    const char *name = request->payload->name;
    struct process_list list = {0, NULL};
    struct list *modules =
        request_names(request, name) ? namesakes_find(&request->server->module_names, name) : NULL;
    struct list *at, *following;
    list.processes = mem_new(MOST * sizeof *list.processes);
    if (modules != NULL) {
        LIST_EACH (at, following, modules) {
            const struct module *module = LIST_OWNER(at, struct module, same_name);
            if (list.count < MOST) {
                list.processes[list.count].process = owner_of_peer(module->link.fd);
                list.processes[list.count++].port = owner_peer_port(module->link.fd);
            }
        }
    }
    request_answer(request, &list);
    free(list.processes);
}

/* ------------------------------------------------------------------- handlers */

/* The message that the request names, NULL if there is none. */
static struct message *find_message(const struct request *request, const char *name)
{
    return request_names(request, name) ? message_find(&request->server->messages, name) : NULL;
}

void service_handlers(struct request *request)
{
    const struct message *message = find_message(request, request->payload->name);
    struct handler_list list = {0, NULL};
    if (message != NULL) {
        handler_list_init(request->server, &list, message);
    }
    answer_state(request->server, request_keep(request), list.count > 0 ? &list : NULL);
    handler_list_fini(&list);
}

void service_watch_handlers(struct request *request)
{
    struct message *message = request_get_message(request, request->payload->name);
    if (message == NULL) {
        return;
    }
    if (message_is_internal(message)) {
        request_ignore(request, "%s belongs to the server", message->name);
        return;
    }
    if (!message_is_defined(message)) {
        request_ignore(request, "%s is not defined yet", message->name);
    }
    handler_list_keep(request->server, message); /* or from its definition on */
}

void service_handler_info(struct request *request)
{
    const char *name = request->payload->names.first;
    const struct message *message = find_message(request, name);
    const struct subscription *latest = message == NULL ? NULL : subscription_latest(message);
    const struct two_names reply = {(char *)(uintptr_t)name,
                                    latest == NULL ? NULL : latest->handler->name};
    request_answer(request, &reply);
}

/* ----------------------------------------------------------------- direct mode */

/* Tells the new port to all who know this module as a handler. */
static void tell_port(struct server *server, const struct module *module)
{
    struct list *at, *following;
    for (struct table_entry *entry = table_first(&module->handlers); entry != NULL;
         entry = table_next(&module->handlers, entry)) {
        const struct handler *handler = entry->value;
        LIST_EACH (at, following, &handler->subscriptions) {
            handler_list_changed(server, LIST_OWNER(at, struct subscription, in_handler)->message);
        }
    }
}

void service_direct_port(struct request *request)
{
    struct module *module = request->module;
    const struct number_and_name *notice = &request->payload->number_and_name;
    struct log *log = &request->server->log;
    if (!request_names(request, notice->name)) {
        return;
    }
    if (!table_same_name(TABLE_FOLDING, notice->name, module->name)) {
        log_notice(log, "Direct Connection: Not Made: %s did not originate call.\n", notice->name);
        return;
    }
    if (notice->number < 1 || notice->number > HIGHEST_PORT) {
        request_ignore(request, "%d cannot be a port", notice->number);
        return;
    }
    log_notice(log, "Direct Connection Established For: %s at %d\n", module->name, notice->number);
    if (module->direct_port != notice->number) {
        module->direct_port = notice->number;
        tell_port(request->server, module);
    }
}

void service_direct_info(struct request *request)
{
    const struct message *message = find_message(request, request->payload->name);
    const struct subscription *latest = message == NULL ? NULL : subscription_latest(message);
    if (latest == NULL) {
        request_answer(request, NULL);
        return;
    }
    const struct module *module = latest->handler->module;
    const struct handler_address reply = {
        0, 0, module->direct_port, latest->handler->id, module->host, module->name};
    request_answer(request, &reply);
}

/* ---------------------------------------------- what modules provide and require */

static void add_names(const struct request *request, struct table *names)
{
    const struct name_list *list = &request->payload->list;
    if (list->used < 0 || list->used > list->room) {
        request_ignore(request, "the list holds fewer names than it says");
        return;
    }
    for (int i = 0; i < list->used; i++) {
        if (names->count >= LIMIT_PROVIDED) {
            request_ignore(request, "there are too many names");
            return;
        }
        if (request_names(request, list->names[i])) {
            (void)table_put(names, list->names[i], request->module); /* any value will do */
        }
    }
}

void service_provides(struct request *request)
{
    add_names(request, &request->module->provides);
    start_check(request->server);
}

void service_requires(struct request *request)
{
    add_names(request, &request->module->needs);
}

/* Adds the names of a table to a list that has room for them. */
static void list_names(struct name_list *list, const struct table *names)
{
    for (struct table_entry *at = table_first(names); at != NULL; at = table_next(names, at)) {
        list->names[list->used++] = at->name;
    }
}

void service_available(struct request *request)
{
    const struct server *server = request->server;
    struct name_list list = {0, 0, NULL};
    struct list *at, *following;
    size_t room = server->resource_names.groups.count;
    LIST_EACH (at, following, &server->modules) {
        room += LIST_OWNER(at, struct module, in_server)->provides.count;
    }
    list.names = mem_new(room * sizeof *list.names);
    list_names(&list, &server->resource_names.groups);
    LIST_EACH (at, following, &server->modules) {
        list_names(&list, &LIST_OWNER(at, struct module, in_server)->provides);
    }
    list.room = list.used;
    request_answer(request, &list);
    free(list.names);
}
