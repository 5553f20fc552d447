/*
 * Contexts: making and finding them.
 */
#include "libipc/context.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/wait.h"

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

void context_connected(struct _X_IPC_CONTEXT *context)
{
    struct library *library = context->library;
    context->state = CONTEXT_CONNECTED;
    library->initialised = true; /* another context may have ended meanwhile, and that with it */
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

void context_lose(struct _X_IPC_CONTEXT *context, bool noticed)
{
    if (context_is_open(context)) {
        context->lost(context, noticed);
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

/* ---------------------------------------------------------------- the current one */

struct _X_IPC_CONTEXT *context_current(const struct library *library)
{
    const struct running *running = library_running(library);
    return running != NULL && running->context != NULL ? running->context : library->current;
}

struct _X_IPC_CONTEXT *context_if_live(struct _X_IPC_CONTEXT *context)
{
    return context != NULL && context_is_live(context) ? context : NULL;
}

struct _X_IPC_CONTEXT *context_current_live(const struct library *library)
{
    return context_if_live(context_current(library));
}

struct _X_IPC_CONTEXT *context_current_connected(const struct library *library)
{
    struct _X_IPC_CONTEXT *context = context_current(library);
    return context != NULL && context_is_connected(context) ? context : NULL;
}

bool context_any_live(const struct library *library)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &library->contexts) {
        if (context_is_live(context_at(position))) {
            return true;
        }
    }
    return false;
}
