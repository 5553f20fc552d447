/*
 * Requests about resources: capacity, limits, locks and reservations.
 */
#include "central/service/request.h"

#include "central/routing/claim.h"
#include "central/routing/flow.h"
#include "central/service/services.h"
#include "central/routing/start.h"

/* ------------------------------------------------------------------- capacity */

static void set_capacity(struct server *server, struct resource *resource, int capacity)
{
    const int fd = resource->owner->shown_fd;
    if (capacity < 1) {
        capacity = 1;
        log_status(&server->log, "\nWARNING: Capacity of %d:%s set to 1\n", fd, resource->name);
    } else if (capacity != resource->capacity) {
        log_status(&server->log, "\nWARNING: Capacity of %d:%s changed to %d\n", fd, resource->name,
                   capacity);
    }
    resource->capacity = capacity;
    flow_release(server, resource);
}

static void add_resource(struct request *request, const struct number_and_name *wanted)
{
    struct server *server = request->server;
    struct module *module = request->module;
    if (module->n_resources >= LIMIT_RESOURCES) {
        request_ignore(request, "the module has too many resources");
        return;
    }
    struct resource *resource = resource_new(
        wanted->name, module, wanted->number < 1 ? 1 : wanted->number, &server->places);
    module->n_resources++;
    list_append(&module->resources, &resource->in_owner);
    namesakes_add(&server->resource_names, resource->name, &resource->same_name);
    start_check(server);
}

void service_resource(struct request *request)
{
    const struct number_and_name *wanted = &request->payload->number_and_name;
    if (!request_names(request, wanted->name)) {
        return;
    }
    struct resource *resource = module_find_resource(request->module, wanted->name);
    if (resource != NULL) {
        set_capacity(request->server, resource, wanted->number);
    } else {
        add_resource(request, wanted);
    }
}

void service_add_to_resource(struct request *request)
{
    const struct two_names *names = &request->payload->names;
    if (!request_names(request, names->first) || !request_names(request, names->second)) {
        return;
    }
    struct handler *handler = handler_find(request->module, names->first);
    struct resource *resource = module_find_resource(request->module, names->second);
    if (handler == NULL || resource == NULL) {
        request_ignore(request, "the module has no handler %s or no resource %s", names->first,
                       names->second);
        return;
    }
    if (handler->resource != resource) {
        log_status(&request->server->log,
                   "\nWARNING: Resource for %s is being changed from %s to %s.\n", handler->name,
                   handler->resource->name, resource->name);
        flow_move(request->server, handler, resource);
    }
}

/* --------------------------------------------------------------------- limits */

/* How many resources bear a name, and the first of them. */
static size_t find_resources(const struct server *server, const char *name, struct resource **first)
{
    const struct list *group = namesakes_find(&server->resource_names, name);
    size_t count = 0;
    *first = NULL;
    if (group != NULL) {
        *first = LIST_OWNER(group->next, struct resource, same_name);
        for (const struct list *at = group->next; at != group; at = at->next) {
            count++;
        }
    }
    return count;
}

/* The resource that a limit is meant for: the sender's own of several; NULL is logged. */
static struct resource *find_limited(const struct request *request, const char *name)
{
    struct log *log = &request->server->log;
    struct resource *resource = module_find_resource(request->module, name);
    if (resource != NULL) {
        return resource;
    }
    const size_t count = find_resources(request->server, name, &resource);
    if (count == 0) {
        log_status(log, "\aERROR: Non-existent resource %s; Pending limit not applied\n", name);
    } else if (count > 1) {
        log_status(log, "\aERROR: Multiple resources named %s; Pending limit not applied\n", name);
    }
    return count == 1 ? resource : NULL;
}

static void limit_resource(struct log *log, struct resource *resource, int limit)
{
    if (resource->pending.limit != NO_LIMIT && resource->pending.limit != limit) {
        log_status(log, "WARNING: Changing pending resource limit of %s from %d to %d\n",
                   resource->name, resource->pending.limit, limit);
    }
    resource->pending.limit = limit;
    resource->limited = true;
}

static void limit_message(struct log *log, struct resource *resource, struct message *message,
                          int limit)
{
    const int before = pending_set_limit(&resource->pending, &message->subject, limit);
    resource->limited = true;
    if (before != NO_LIMIT && before != limit) {
        log_status(log, "WARNING: Changing pending message limit of %s from %d to %d\n",
                   message->name, before, limit);
    }
}

void service_limit_pending(struct request *request)
{
    const struct pending_limit *wanted = &request->payload->limit;
    struct log *log = &request->server->log;
    if (!request_names(request, wanted->resource)) {
        return;
    }
    if (wanted->limit < 0) {
        request_ignore(request, "%d cannot be a limit", wanted->limit);
        return;
    }
    struct resource *resource = find_limited(request, wanted->resource);
    if (resource == NULL) {
        return;
    }
    if (wanted->message == NULL) {
        limit_resource(log, resource, wanted->limit);
        return;
    }
    struct message *message = request_get_message(request, wanted->message);
    if (message != NULL) {
        limit_message(log, resource, message, wanted->limit);
    }
}

/* ------------------------------------------------------- locks and reservations */

void service_claim(struct request *request)
{
    const char *name = request->payload->name;
    struct resource *resource = NULL;
    if (request_names(request, name)) {
        resource = module_find_resource(request->module, name);
        if (resource == NULL && find_resources(request->server, name, &resource) != 1) {
            request_ignore(request, "%s is no resource, or several", name);
            resource = NULL;
        }
    }
    if (resource == NULL) {
        claim_refuse(request->server, request_keep(request));
    } else {
        claim_enter(request->server, request_keep(request), resource);
    }
}

/* The resource of that name of a module of that name, or NULL. */
static struct resource *find_of_module(const struct server *server, const struct two_names *names)
{
    const struct list *group = namesakes_find(&server->module_names, names->first);
    for (struct list *at = group == NULL ? NULL : group->next; at != NULL && at != group;
         at = at->next) {
        struct resource *resource =
            module_find_resource(LIST_OWNER(at, struct module, same_name), names->second);
        if (resource != NULL) {
            return resource;
        }
    }
    return NULL;
}

void service_claim_of_module(struct request *request)
{
    const struct two_names *names = &request->payload->names;
    struct resource *resource = NULL;
    if (request_names(request, names->first) && request_names(request, names->second)) {
        resource = find_of_module(request->server, names);
        if (resource == NULL) {
            request_ignore(request, "%s has no resource %s", names->first, names->second);
        }
    }
    if (resource == NULL) {
        claim_refuse(request->server, request_keep(request));
    } else {
        claim_enter(request->server, request_keep(request), resource);
    }
}

void service_give_back(struct request *request)
{
    struct server *server = request->server;
    const int number = request->payload->number;
    const struct dispatch *claim = dispatch_find(&server->dispatches, number);
    if (claim == NULL || claim->state != DISPATCH_HELD || claim->sender != request->module) {
        request_ignore(request, "%d is no lock or reservation of the module", number);
        return;
    }
    struct resource *resource = claim->resource;
    claim_give_back(server, resource);
    flow_release(server, resource);
}
