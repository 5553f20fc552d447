/*
 * Claims: requests to lock or to reserve a resource.
 */
#include "central/routing/claim.h"

#include "central/routing/answer.h"
#include "central/settings/version.h"

/* What the request wants follows from its message. */
static enum resource_state wanted_by(const struct dispatch *request)
{
    const enum library_message service = request->message->service;
    return service == LM_LOCK || service == LM_LOCK_OF_MODULE ? RESOURCE_LOCKED : RESOURCE_RESERVED;
}

static bool can_grant(const struct resource *resource, const struct dispatch *request)
{
    return resource->state == RESOURCE_ACTIVE &&
           (resource_has_room(resource) || resource->owner == request->sender);
}

static void grant(struct server *server, struct dispatch *request, struct resource *resource)
{
    const int number = (int)request->id;
    resource->state = wanted_by(request);
    resource->claim = request;
    request->resource = resource;
    request->state = DISPATCH_HELD;
    list_append(&request->sender->held, &request->link);
    answer_and_keep(server, request, &number);
}

void claim_refuse(struct server *server, struct dispatch *request)
{
    const int none = NO_ID;
    answer(server, request, &none);
}

void claim_enter(struct server *server, struct dispatch *request, struct resource *resource)
{
    struct module *module = request->sender;
    const bool again = resource->state == RESOURCE_RESERVED && resource->claim->sender == module &&
                       wanted_by(request) == RESOURCE_RESERVED;
    if (again || module->n_claims >= LIMIT_CLAIMS) {
        claim_refuse(server, request);
        return;
    }
    module->n_claims++;
    if (can_grant(resource, request) && list_is_empty(&resource->claims)) {
        grant(server, request, resource);
        return;
    }
    request->resource = resource;
    list_append(&resource->claims, &request->link);
    log_request_waits(&server->log, request);
}

void claim_grant_waiting(struct server *server, struct resource *resource)
{
    while (!list_is_empty(&resource->claims)) {
        struct dispatch *request = LIST_OWNER(resource->claims.next, struct dispatch, link);
        if (!can_grant(resource, request)) {
            return;
        }
        list_remove(&request->link);
        log_sent(&server->log, request, SERVER_NAME);
        grant(server, request, resource);
    }
}

/* Ends a claim, wherever it stands. */
static void forget(struct server *server, struct dispatch *request)
{
    request->sender->n_claims--;
    list_remove(&request->link);
    dispatch_free(&server->dispatches, request);
}

void claim_give_back(struct server *server, struct resource *resource)
{
    struct dispatch *claim = resource->claim;
    if (claim == NULL) {
        return;
    }
    resource->claim = NULL;
    resource->state = RESOURCE_ACTIVE;
    forget(server, claim);
}

struct resource *claim_give_back_any(struct server *server, struct module *holder)
{
    if (list_is_empty(&holder->held)) {
        return NULL;
    }
    struct resource *resource = LIST_OWNER(holder->held.next, struct dispatch, link)->resource;
    claim_give_back(server, resource);
    return resource;
}

static void withdraw_from(struct server *server, struct resource *resource,
                          const struct module *module)
{
    struct list *at, *following;
    LIST_EACH (at, following, &resource->claims) {
        struct dispatch *request = LIST_OWNER(at, struct dispatch, link);
        if (request->sender == module) {
            forget(server, request);
        }
    }
}

void claim_withdraw_all(struct server *server, struct module *module)
{
    struct list *outer, *after, *at, *following;
    if (module->n_claims == 0) {
        return;
    }
    LIST_EACH (outer, after, &server->modules) {
        struct module *owner = LIST_OWNER(outer, struct module, in_server);
        LIST_EACH (at, following, &owner->resources) {
            withdraw_from(server, LIST_OWNER(at, struct resource, in_owner), module);
        }
    }
}

void claim_end_of_resource(struct server *server, struct resource *resource)
{
    claim_give_back(server, resource);
    while (!list_is_empty(&resource->claims)) {
        struct dispatch *request = LIST_OWNER(resource->claims.next, struct dispatch, link);
        request->sender->n_claims--;
        claim_refuse(server, request);
    }
}
