/*
 * The inbox of a context.
 */
#include "libipc/inbox.h"

#include "libipc/report.h"

static struct instance *at(struct list *position)
{
    return LIST_OWNER(position, struct instance, in_queue);
}

static int priority_of(const struct instance *instance)
{
    return instance->message != NULL ? instance->message->priority : -1;
}

/* Before the first one of lower priority. */
static void insert(struct _X_IPC_CONTEXT *context, struct instance *instance)
{
    struct list *position = &context->inbox;
    const int priority = priority_of(instance);
    if (priority >= 0) {
        position = context->inbox.next;
        while (position != &context->inbox && priority_of(at(position)) >= priority) {
            position = position->next;
        }
    }
    list_insert(position, &instance->in_queue);
}

static bool is_delivery_of(const struct instance *instance, const struct message *message)
{
    return instance->kind == INSTANCE_DELIVERY && instance->message == message;
}

static int count_of(struct _X_IPC_CONTEXT *context, const struct message *message,
                    struct instance **oldest)
{
    int count = 0;
    struct list *position = context->inbox.next;
    for (; position != &context->inbox; position = position->next) {
        if (is_delivery_of(at(position), message)) {
            *oldest = count++ == 0 ? at(position) : *oldest;
        }
    }
    return count;
}

/* The new instance takes the place of the newest of its message, which takes that of the one
 * before it, and so on: the message keeps its turns among the others. */
static void move_up(struct _X_IPC_CONTEXT *context, struct instance *dropped,
                    struct instance *added)
{
    const struct message *message = added->message;
    struct list *place = &dropped->in_queue;
    struct list *position = place->next;
    while (position != &context->inbox) {
        struct list *following = position->next;
        if (is_delivery_of(at(position), message)) {
            /* Exchange the two neighbours of one message: position goes where place is. */
            struct list *after = following;
            list_remove(position);
            list_insert(place, position);
            list_remove(place);
            list_insert(after, place);
        }
        position = following;
    }
    list_insert(place, &added->in_queue);
    list_remove(place);
}

void inbox_add(struct instance *instance)
{
    struct _X_IPC_CONTEXT *context = instance->context;
    struct message *message = instance->message;
    struct instance *oldest = NULL;
    if (instance->kind != INSTANCE_DELIVERY || message->queue_limit == 0 ||
        count_of(context, message, &oldest) < message->queue_limit) {
        insert(context, instance);
        context->n_inbox++;
        context->inbox_bytes += instance->length;
        return;
    }
    report_warning("WARNING: Removing a %s message from queue (has %d)\n", message->name,
                   message->queue_limit);
    move_up(context, oldest, instance);
    context->inbox_bytes += instance->length - oldest->length;
    instance_acknowledge(oldest);
    instance_free(oldest);
}

struct instance *inbox_first(struct _X_IPC_CONTEXT *context)
{
    struct list *position = context->inbox.next;
    for (; position != &context->inbox; position = position->next) {
        if (instance_may_run(at(position))) {
            return at(position);
        }
    }
    return NULL;
}

bool inbox_is_any_waiting(const struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_is_live(context) && inbox_first(context) != NULL) {
            return true;
        }
    }
    return false;
}

void inbox_tell(const struct library *library)
{
    if (library->event_set != NULL && inbox_is_any_waiting(library)) {
        waker_wake(&library->waker);
    }
}

static void take_out(struct instance *instance)
{
    list_remove(&instance->in_queue);
    instance->context->n_inbox--;
    instance->context->inbox_bytes -= instance->length;
}

struct instance *inbox_take(struct _X_IPC_CONTEXT *context)
{
    struct instance *instance = inbox_first(context);
    if (instance != NULL) {
        take_out(instance);
    }
    return instance;
}

void inbox_lose(struct _X_IPC_CONTEXT *context)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &context->inbox) {
        struct instance *instance = at(position);
        instance->dispatch = NO_ID;
        if (instance->kind == INSTANCE_DELIVERY && instance->class == CLASS_QUERY) {
            take_out(instance);
            instance_free(instance);
        }
    }
}

void inbox_clear(struct _X_IPC_CONTEXT *context)
{
    while (!list_is_empty(&context->inbox)) {
        struct instance *instance = at(context->inbox.next);
        take_out(instance);
        instance_free(instance);
    }
}
