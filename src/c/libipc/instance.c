/*
 * Message instances and their handles.
 */
#include "libipc/instance.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/peer.h"

struct instance *instance_new(struct _X_IPC_CONTEXT *context, enum instance_kind kind)
{
    struct library *library = context->library;
    struct instance *instance;
    if (list_is_empty(&library->spare_instances)) {
        instance = mem_new(sizeof *instance);
    } else {
        instance = LIST_OWNER(library->spare_instances.next, struct instance, in_queue);
        list_remove(&instance->in_queue);
        memset(instance, 0, sizeof *instance);
    }
    list_init(&instance->in_queue);
    instance->number = idpool_take(&library->instances, instance);
    instance->kind = kind;
    instance->context = context;
    instance->connection = context->connection;
    instance->dispatch = NO_ID;
    return instance;
}

void instance_free(struct instance *instance)
{
    struct library *library = instance->context->library;
    instance_passivate(instance);
    list_remove(&instance->in_queue);
    idpool_release(&library->instances, instance->number);
    free(instance->content);
    free(instance->notice_name);
    peer_unref(instance->peer);
    list_prepend(&library->spare_instances, &instance->in_queue);
}

MSG_INSTANCE instance_handle(const struct instance *instance)
{
    return (MSG_INSTANCE)idpool_handle(&instance->context->library->instances, instance->number);
}

struct instance *instance_find(const struct library *library, MSG_INSTANCE handle)
{
    return idpool_find(&library->instances, (uintptr_t)handle);
}

bool instance_is_stale(const struct instance *instance)
{
    return instance->connection != instance->context->connection;
}

bool instance_may_run(const struct instance *instance)
{
    const struct _X_IPC_CONTEXT *context = instance->context;
    if (!context_is_connected(context)) {
        return instance->dispatch == NO_ID && instance->peer == NULL;
    }
    return instance->dispatch == NO_ID || context->active < context->capacity;
}

void instance_activate(struct instance *instance)
{
    if (instance->dispatch != NO_ID && !instance->active) {
        instance->active = true;
        instance->context->active++;
    }
}

void instance_passivate(struct instance *instance)
{
    if (instance->active) {
        instance->active = false;
        if (!instance_is_stale(instance)) {
            instance->context->active--;
        }
    }
}

void instance_acknowledge(struct instance *instance)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    if (instance->dispatch == NO_ID || instance_is_stale(instance) || !context_is_open(context)) {
        return;
    }
    context_acknowledge(context, instance->dispatch);
    instance->dispatch = NO_ID;
}
