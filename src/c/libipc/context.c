/*
 * Contexts: making, closing, and what is left of them.
 */
#include "libipc/context.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/direct.h"
#include "libipc/inbox.h"
#include "libipc/notify.h"
#include "libipc/reconnect.h"
#include "libipc/registry.h"
#include "libipc/subscription.h"
#include "libipc/timer.h"
#include "libipc/wait.h"
#include "libipc/watch_fd.h"

/* A husk that no program has ever seen, left by a failed handshake, or a new one. */
static struct _X_IPC_CONTEXT *context_allocate(struct library *library)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &library->contexts) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context->unseen && context->state == CONTEXT_CLOSED) {
            list_remove(position);
            free(context->server_name);
            memset(context, 0, sizeof *context);
            return context;
        }
    }
    return mem_new(sizeof(struct _X_IPC_CONTEXT));
}

struct _X_IPC_CONTEXT *context_new(struct library *library, int fd, const char *module_name,
                                   const char *server_name, int port, bool will_listen)
{
    struct _X_IPC_CONTEXT *context = context_allocate(library);
    context->library = library;
    context->unseen = true;
    context->state = CONTEXT_CONNECTING;
    context->server_name = mem_copy_string(server_name);
    context->module_name = mem_copy_string(module_name);
    context->port = port;
    context->will_listen = will_listen;
    context->reconnect = library->reconnect;
    context->capacity = 1;
    link_init(&context->link, fd, FROM_CENTRAL);
    source_init(&context->source, NULL, -1);
    intmap_init(&context->awaited);
    table_init(&context->messages, TABLE_FOLDING);
    table_init(&context->handlers, TABLE_FOLDING);
    list_init(&context->subscribed);
    idpool_init(&context->handler_ids);
    list_init(&context->inbox);
    list_init(&context->delayed);
    table_init(&context->broadcasts, TABLE_FOLDING);
    source_init(&context->direct_tcp, NULL, -1);
    source_init(&context->direct_unix, NULL, -1);
    context->direct_local.fd = -1;
    list_init(&context->peers);
    list_init(&context->connect_watchers);
    list_init(&context->disconnect_watchers);
    list_init(&context->change_watchers);
    list_init(&context->connection_watchers);
    list_append(&library->contexts, &context->in_library);
    return context;
}

void context_discard(struct _X_IPC_CONTEXT *context)
{
    context_close(context, CONTEXT_CLOSED);
}

void context_connected(struct _X_IPC_CONTEXT *context)
{
    struct library *library = context->library;
    context->state = CONTEXT_CONNECTED;
    if (context->link.fd > library->max_fd) {
        library->max_fd = context->link.fd;
    }
    wait_changed(library);
}

bool context_is_known(const struct library *library, const struct _X_IPC_CONTEXT *pointer)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        if (context_at(position) == pointer) {
            return true;
        }
    }
    return false;
}

void context_acknowledge(struct _X_IPC_CONTEXT *context, int32_t dispatch)
{
    struct frame frame;
    frame_init(&frame, CLASS_SUCCESS);
    frame.parent = dispatch;
    frame.dispatch = dispatch;
    link_queue(&context->link, &frame);
    if (context->acknowledged_ns == 0) {
        context->acknowledged_ns = clock_ns();
    }
    context->unfinished--;
}

/* Everybody who waits for an answer is told that none will come. */
static void fail_awaited(struct _X_IPC_CONTEXT *context)
{
    for (size_t i = 0; i < context->awaited.n_slots; i++) {
        struct awaited *awaited = context->awaited.slots[i].value;
        if (awaited == NULL) {
            continue;
        }
        awaited->failed = true;
        if (awaited->notify) {
            free(awaited);
        }
    }
    intmap_fini(&context->awaited);
    intmap_init(&context->awaited);
}

static void free_delayed(struct _X_IPC_CONTEXT *context)
{
    while (!list_is_empty(&context->delayed)) {
        instance_free(LIST_OWNER(context->delayed.next, struct instance, in_queue));
    }
}

void context_drop_connection(struct _X_IPC_CONTEXT *context)
{
    wait_remove(context->library, &context->source);
    link_fini(&context->link);
    fail_awaited(context);
    free_delayed(context);
    direct_close(context);
}

void context_close(struct _X_IPC_CONTEXT *context, enum context_state state)
{
    struct library *library = context->library;
    if (context_has_ended(context)) {
        if (context->state == CONTEXT_LOST) {
            context->state = state;
        }
        return;
    }
    const bool seen = !context->unseen;
    const bool open = context_is_open(context);
    context->state = state;
    if (open) {
        context_drop_connection(context);
    }
    reconnect_end(context);
    inbox_clear(context);
    context_settle(context);
    if (seen && !library_any_live(library)) {
        timer_clear(library);
        watch_fd_clear(library);
        library->initialised = false;
    }
    wait_changed(library);
}

void context_settle(struct _X_IPC_CONTEXT *context)
{
    if (!context_has_ended(context) || context->turn.depth > 0) {
        return;
    }
    notify_clear(context);
    subscription_clear(context);
    registry_clear(context);
    table_fini(&context->broadcasts);
    table_init(&context->broadcasts, TABLE_FOLDING);
    intmap_fini(&context->awaited);
    intmap_init(&context->awaited);
    free(context->module_name);
    context->module_name = NULL;
}

void context_lose(struct _X_IPC_CONTEXT *context, bool noticed)
{
    if (!context_is_open(context)) {
        return;
    }
    if (!context->unseen && context->reconnect != IPCX_RECONNECT_NEVER) {
        reconnect_begin(context);
    } else {
        context->loss_noticed = noticed;
        context_close(context, context->unseen ? CONTEXT_CLOSED : CONTEXT_LOST);
    }
}

struct _X_IPC_CONTEXT *context_take_loss(struct library *library, bool all)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context->state == CONTEXT_LOST && (all || context->loss_noticed)) {
            context->state = CONTEXT_CLOSED;
            return context;
        }
    }
    return NULL;
}
