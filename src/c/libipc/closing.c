/*
 * Taking contexts apart.
 */
#include "libipc/closing.h"

#include <stdlib.h>

#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/reconnect.h"
#include "libipc/registry.h"
#include "libipc/subscription.h"
#include "libipc/timer.h"
#include "libipc/wait.h"
#include "libipc/watch_fd.h"
#include "libipc/watcher.h"

/* ------------------------------------------------------------- the connection */

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

/* Closes the sockets of an open context, drops what is queued, fails whoever waits. */
static void drop_connection(struct _X_IPC_CONTEXT *context)
{
    wait_remove(context->library, &context->source);
    link_fini(&context->link);
    fail_awaited(context);
    free_delayed(context);
    direct_close(context);
}

/* ---------------------------------------------------------------- the context */

/* Frees what the connection left behind, once no callback of it runs any more. */
static void settle(struct _X_IPC_CONTEXT *context)
{
    if (context->turn.depth > 0) {
        return;
    }
    watcher_clear(context);
    subscription_clear(context);
    registry_clear(context);
    table_fini(&context->broadcasts);
    table_init(&context->broadcasts, TABLE_FOLDING);
    intmap_fini(&context->awaited);
    intmap_init(&context->awaited);
    free(context->module_name);
    context->module_name = NULL;
}

static bool is_settled(const struct _X_IPC_CONTEXT *context)
{
    return context->module_name == NULL;
}

void closing_settle(struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context_has_ended(context) && !is_settled(context)) {
            settle(context);
        }
    }
}

void closing_end(struct _X_IPC_CONTEXT *context, enum context_state state)
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
        drop_connection(context);
    }
    reconnect_end(context);
    inbox_clear(context);
    settle(context);
    if (seen && !context_any_live(library)) {
        timer_clear(library);
        watch_fd_clear(library);
        library->initialised = false;
    }
    wait_changed(library);
}

void closing_lost(struct _X_IPC_CONTEXT *context, bool noticed)
{
    if (!context->unseen && context->reconnect != IPCX_RECONNECT_NEVER) {
        drop_connection(context);
        reconnect_begin(context);
    } else {
        context->loss_noticed = noticed;
        closing_end(context, context->unseen ? CONTEXT_CLOSED : CONTEXT_LOST);
    }
}

/* ---------------------------------------------------------------------- leaving */

/* Unread bytes would make the kernel reset the connection, and the last words could be lost. */
static void read_rest(struct _X_IPC_CONTEXT *context)
{
    bool more = true;
    while (more && link_read(&context->link, &more) > 0) {
        context->link.reader.start = context->link.reader.end;
    }
}

void closing_disconnect(struct _X_IPC_CONTEXT *context, bool tell_central)
{
    context->reconnect = IPCX_RECONNECT_NEVER; /* whatever this finds is no loss any more */
    if (context_is_open(context) && !tell_central) {
        net_close_copy(context->link.fd);
        context->link.fd = -1;
    } else if (context_is_connected(context)) {
        if (context->library_ids[LM_CLOSE] != 0) {
            (void)exchange_queue_notice(context, context->library_ids[LM_CLOSE], NULL, NULL);
        }
        if (exchange_flush(context) == IPC_No_Error) {
            read_rest(context);
        }
    }
    closing_end(context, CONTEXT_CLOSED);
}
