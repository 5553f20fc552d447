/*
 * Resources: how much a module is given at a time.
 *
 * Every module has a resource of its own name with capacity 1 and may make
 * more.  Deliveries that were sent and not yet reported finished are active;
 * as many as the capacity may be so at a time, the rest is pending.  A resource
 * may be locked (nothing is sent) or reserved (only what its holder sends).
 */
#ifndef IPC_CENTRAL_RESOURCE_H
#define IPC_CENTRAL_RESOURCE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/list.h"
#include "central/model/pending.h"

struct module;
struct dispatch;

enum resource_state { RESOURCE_ACTIVE, RESOURCE_RESERVED, RESOURCE_LOCKED };

struct resource {
    char *name; /* owned */
    struct module *owner;
    struct list in_owner;
    struct list same_name;
    int capacity;
    size_t attending;   /* active deliveries that count against the capacity */
    struct list active; /* of struct dispatch, first sent first */
    struct list ahead;  /* the next after these, sent before their turn */
    size_t n_ahead;
    size_t ahead_bytes; /* data of these */
    bool limited;       /* a limit has been set, so what waits may have to be dropped */
    struct pending pending;
    uint64_t dropped;   /* of pending, because it was full */
    struct list losses; /* what a burst of too many has cost, first lost first: see drops.h */
    struct intmap lost; /* the same by message */
    struct list waited_for_by; /* modules that have filled pending and are not read meanwhile */
    struct list in_crowded;    /* of the server, while that may be so */

    enum resource_state state;
    struct dispatch *claim;     /* the request that locked or reserved it, NULL while active */
    struct pending holders_own; /* what the holder of a reservation sent meanwhile */
    struct list claims;         /* waiting requests to lock or reserve, oldest first */
};

/* capacity is at least 1. */
struct resource *resource_new(const char *name, struct module *owner, int capacity,
                              struct pending_pool *pool);

/* Nothing may be active, pending or waiting in it any more. */
void resource_free(struct resource *resource);

static inline bool resource_has_room(const struct resource *resource)
{
    return resource->attending < (size_t)resource->capacity;
}

static inline bool resource_has_waiting(const struct resource *resource)
{
    return !pending_is_empty(&resource->pending) || !pending_is_empty(&resource->holders_own);
}

/* How many deliveries wait for their turn, here or already at the module. */
static inline size_t resource_count_waiting(const struct resource *resource)
{
    return resource->pending.count + resource->n_ahead;
}

/* The state as the status command names it. */
const char *resource_state_name(const struct resource *resource);

#endif
