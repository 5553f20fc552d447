/*
 * The start: modules may begin when enough of them are there.
 */
#include "central/routing/start.h"

#include "central/routing/answer.h"
#include "central/routing/flow.h"
#include "central/routing/watch.h"

static bool provides(const struct module *module, const char *name)
{
    return table_find(&module->provides, name) != NULL;
}

/* Whether a name is that of a module, of a resource, or provided by some module. */
static bool is_provided(const struct server *server, const char *name)
{
    struct list *at, *following;
    if (namesakes_find(&server->module_names, name) != NULL ||
        namesakes_find(&server->resource_names, name) != NULL) {
        return true;
    }
    LIST_EACH (at, following, &server->modules) {
        if (provides(LIST_OWNER(at, struct module, in_server), name)) {
            return true;
        }
    }
    return false;
}

static bool has_what_it_requires(const struct server *server, const struct module *module)
{
    for (struct table_entry *entry = table_first(&module->needs); entry != NULL;
         entry = table_next(&module->needs, entry)) {
        if (!is_provided(server, entry->name)) {
            return false;
        }
    }
    return true;
}

/* Takes a module off the list of those that wait and returns its request. */
static struct dispatch *stop_waiting(struct server *server, struct module *module)
{
    struct dispatch *request = module->start_request;
    module->start_request = NULL;
    list_remove(&module->in_state);
    server->n_waiting--;
    return request;
}

static void let_start(struct server *server, struct module *module, struct dispatch *request)
{
    const int yes = 1;
    module_enter(module, MODULE_READY);
    answer_state(server, request, &yes); /* nothing is to come before it, values neither */
    watch_send_due(server, module, false);
    flow_release_all(server, module);
}

void start_check(struct server *server)
{
    struct list *at, *following;
    if (server->n_waiting >= (size_t)server->options->expected) {
        server->started = true;
    }
    if (!server->started) {
        return;
    }
    LIST_EACH (at, following, &server->waiting) {
        struct module *module = LIST_OWNER(at, struct module, in_state);
        if (has_what_it_requires(server, module)) {
            let_start(server, module, stop_waiting(server, module));
        }
    }
}

void start_ask(struct server *server, struct module *module, struct dispatch *request)
{
    const int yes = 1;
    if (module->state == MODULE_READY) {
        answer(server, request, &yes);
        return;
    }
    if (module->state == MODULE_WAITING) {
        answer_nothing(server, module->start_request); /* the later request counts */
        module->start_request = request;
        return;
    }
    module_enter(module, MODULE_WAITING);
    module->start_request = request;
    list_append(&server->waiting, &module->in_state);
    server->n_waiting++;
    start_check(server);
}

void start_withdraw(struct server *server, struct module *module)
{
    if (module->state == MODULE_WAITING) {
        dispatch_free(&server->dispatches, stop_waiting(server, module));
    }
}
