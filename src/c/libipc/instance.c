/*
 * Message instances and their handles.
 */
#include "libipc/instance.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/direct.h"
#include "libipc/subscription.h"

/* A handle is generation and number + 1, so that it is never NULL. */
#define NUMBER_BITS (sizeof(uintptr_t) * 4)
#define NUMBER_MASK (((uintptr_t)1 << NUMBER_BITS) - 1)

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
    const struct library *library = instance->context->library;
    const uintptr_t generation = idpool_generation(&library->instances, instance->number);
    return (MSG_INSTANCE)(generation << NUMBER_BITS | ((uintptr_t)instance->number + 1));
}

struct instance *instance_find(const struct library *library, MSG_INSTANCE handle)
{
    const uintptr_t number = ((uintptr_t)handle & NUMBER_MASK) - 1;
    struct instance *instance = idpool_get(&library->instances, (int64_t)number);
    return instance != NULL && instance_handle(instance) == handle ? instance : NULL;
}

bool instance_may_run(const struct instance *instance)
{
    const struct _X_IPC_CONTEXT *context = instance->context;
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
        instance->context->active--;
    }
}

void instance_acknowledge(struct instance *instance)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    if (instance->dispatch == NO_ID || !context_is_connected(context)) {
        return;
    }
    struct frame frame;
    frame_init(&frame, CLASS_SUCCESS);
    frame.parent = instance->dispatch;
    frame.dispatch = instance->dispatch;
    link_queue(&context->link, &frame);
    if (context->acknowledged_ns == 0) {
        context->acknowledged_ns = clock_ns();
    }
    instance->dispatch = NO_ID;
    context->unfinished--;
}
