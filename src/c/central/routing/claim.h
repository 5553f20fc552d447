/*
 * Claims: requests to lock or to reserve a resource.
 *
 * A claim is granted when nothing else holds the resource and it has room, or
 * at once if it is the requester's own; otherwise it waits.  The answer is the
 * number of the request, by which the holder gives the resource back; the
 * request lives on until then.
 */
#ifndef IPC_CENTRAL_CLAIM_H
#define IPC_CENTRAL_CLAIM_H

#include "central/routing/server.h"

/* Grants a request to lock or reserve, lets it wait, or refuses it. */
void claim_enter(struct server *server, struct dispatch *request, struct resource *resource);

/* Answers a request that cannot be granted. */
void claim_refuse(struct server *server, struct dispatch *request);

/* Grants what waits and can be granted now. */
void claim_grant_waiting(struct server *server, struct resource *resource);

/* Makes a resource active again; the caller releases what waits in it. */
void claim_give_back(struct server *server, struct resource *resource);

/* The same for one of the resources that a module holds; NULL when it holds none. */
struct resource *claim_give_back_any(struct server *server, struct module *holder);

/* Withdraws what a module waits for. */
void claim_withdraw_all(struct server *server, struct module *module);

/* The resource goes: its holder holds nothing any more, who waits for it is refused. */
void claim_end_of_resource(struct server *server, struct resource *resource);

#endif
