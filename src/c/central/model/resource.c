/*
 * Resources: how much a module is given at a time.
 */
#include "central/model/resource.h"

#include <stdlib.h>

#include "base/memory.h"

struct resource *resource_new(const char *name, struct module *owner, int capacity,
                              struct pending_pool *pool)
{
    struct resource *resource = mem_new(sizeof *resource);
    resource->name = mem_copy_string(name);
    resource->owner = owner;
    resource->capacity = capacity;
    resource->state = RESOURCE_ACTIVE;
    list_init(&resource->in_owner);
    list_init(&resource->same_name);
    list_init(&resource->active);
    list_init(&resource->ahead);
    list_init(&resource->claims);
    list_init(&resource->waited_for_by);
    list_init(&resource->in_crowded);
    list_init(&resource->losses);
    intmap_init(&resource->lost);
    pending_init(&resource->pending, pool);
    pending_init(&resource->holders_own, pool);
    return resource;
}

void resource_free(struct resource *resource)
{
    pending_fini(&resource->pending);
    pending_fini(&resource->holders_own);
    intmap_fini(&resource->lost);
    free(resource->name);
    free(resource);
}

const char *resource_state_name(const struct resource *resource)
{
    static const char *const names[] = {
        [RESOURCE_ACTIVE] = "Active",
        [RESOURCE_RESERVED] = "Reserved",
        [RESOURCE_LOCKED] = "Locked",
    };
    return names[resource->state];
}
