/*
 * Coming back after the loss of central.
 *
 *     away: pause -> TCP connection under way -> connecting: handshake -> connected
 *             ^                |                        |
 *             +----------------+------------------------+    each failure: a longer pause
 */
#include "libipc/reconnect.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/receive.h"
#include "libipc/registry.h"
#include "libipc/report.h"
#include "libipc/subscription.h"
#include "libipc/wait.h"
#include "libipc/watcher.h"

#define MILLISECOND ((uint64_t)1000000)
#define FIRST_PAUSE (100 * MILLISECOND)
#define LONGEST_PAUSE (2000 * MILLISECOND)
#define LONGEST_TRY (10000 * MILLISECOND)

#define LOOPBACK "127.0.0.1"

/* --------------------------------------------------------------------- losing */

/* Numbers of the old central mean nothing to the new one, or something else. */
static void forget_numbers(struct _X_IPC_CONTEXT *context)
{
    struct running *running = context->library->running;
    for (; running != NULL; running = running->outer) {
        if (running->context == context) {
            running->dispatch = NO_ID;
        }
    }
    context->connection++;
    context->active = 0;
    context->unfinished = 0;
    context->acknowledged_ns = 0;
    context->try_first = false;
    context->broadcasts_known = false;
    registry_lose(context);
    subscription_lose(context);
    inbox_lose(context);
}

/* ------------------------------------------------------------------- as a source */

static void step(struct _X_IPC_CONTEXT *context);

static int wanted(const struct source *source)
{
    const struct reconnect *away = LIST_OWNER(source, const struct reconnect, source);
    const struct _X_IPC_CONTEXT *context = away->context;
    if (context->state == CONTEXT_CONNECTING) {
        return link_waiting(&context->link) > 0 ? READY_READ | READY_WRITE : READY_READ;
    }
    return source->fd >= 0 ? READY_WRITE : NOT_WANTED;
}

static void take_found(struct source *source, int found)
{
    struct _X_IPC_CONTEXT *context = LIST_OWNER(source, struct reconnect, source)->context;
    if (context->state == CONTEXT_CONNECTING && (found & READY_WRITE)) {
        (void)exchange_flush(context); /* a loss shows in the context's state */
    }
    step(context);
}

static const struct source_kind away_kind = {NULL, wanted, take_found};

/* What is waited for from now on, and how long. */
static void wait_for(struct reconnect *away, int fd, uint64_t due_ns)
{
    away->source.fd = fd;
    away->source.due_ns = due_ns;
    wait_changed(away->context->library);
}

/* --------------------------------------------------------------------- losing */

/* The connection that the program knows of has gone. */
static void leave(struct _X_IPC_CONTEXT *context)
{
    context->away = mem_new(sizeof *context->away);
    context->away->context = context;
    context->away->fd = -1;
    context->away->pause_ns = FIRST_PAUSE;
    source_init(&context->away->source, &away_kind, -1);
    wait_add(context->library, &context->away->source);
    report_note("Closed Connection Detected from: Central Server %s\n\n", context->server_name);
    watcher_tell_connection(context, false);
}

static void try_later(struct reconnect *away)
{
    const uint64_t pause = away->pause_ns;
    away->pause_ns = 2 * pause < LONGEST_PAUSE ? 2 * pause : LONGEST_PAUSE;
    wait_for(away, -1, clock_ns() + pause);
}

void reconnect_begin(struct _X_IPC_CONTEXT *context)
{
    context->state = CONTEXT_AWAY;
    forget_numbers(context);
    if (context->away == NULL) {
        leave(context);
    } else {
        handshake_fini(&context->away->handshake);
    }
    try_later(context->away);
}

void reconnect_end(struct _X_IPC_CONTEXT *context)
{
    struct reconnect *away = context->away;
    if (away == NULL) {
        return;
    }
    wait_remove(context->library, &away->source);
    handshake_fini(&away->handshake);
    if (away->fd >= 0) {
        net_close_copy(away->fd);
    }
    free(away);
    context->away = NULL;
}

/* --------------------------------------------------------------------- trying */

static void begin_handshake(struct _X_IPC_CONTEXT *context, int fd, bool local)
{
    struct reconnect *away = context->away;
    away->fd = -1;
    context->local = local;
    context->greeting = 0;
    context->state = CONTEXT_CONNECTING;
    link_init(&context->link, fd, FROM_CENTRAL);
    handshake_init(&away->handshake, context);
    wait_for(away, fd, away->handshake.deadline_ns);
}

/* By Unix socket there is an answer at once, by TCP later. */
static void begin_try(struct _X_IPC_CONTEXT *context)
{
    struct reconnect *away = context->away;
    const char *host = context->address[0] != '\0' ? context->address : LOOPBACK;
    char path[NET_PATH_SIZE];
    int fd;
    snprintf(path, sizeof path, "%s/%d", NET_SOCKET_DIRECTORY, context->port);
    if (context->address[0] == '\0' && net_connect_local(path, &fd) == 0) {
        begin_handshake(context, fd, true);
    } else if (net_start_tcp(host, context->port, &away->fd) == 0) {
        wait_for(away, away->fd, clock_ns() + LONGEST_TRY);
    } else {
        away->fd = -1;
        try_later(away);
    }
}

static void look_at_try(struct _X_IPC_CONTEXT *context)
{
    struct reconnect *away = context->away;
    const int result = net_look_at_start(away->fd);
    if (result == 0) {
        begin_handshake(context, away->fd, false);
    } else if (result < 0 || wait_is_over(away->source.due_ns)) {
        net_close_copy(away->fd);
        away->fd = -1;
        try_later(away);
    }
}

static void come_back(struct _X_IPC_CONTEXT *context)
{
    reconnect_end(context);
    receive_start(context);
    report_note("Connected again to: Central Server %s\n\n", context->server_name);
    watcher_tell_connection(context, true);
    context_connected(context);
}

/* A loss while it reads or steps has begun the next pause already. */
static void look_at_handshake(struct _X_IPC_CONTEXT *context)
{
    (void)receive(context);
    if (!context_is_open(context)) {
        return;
    }
    struct reconnect *away = context->away;
    const enum handshake_result result = handshake_step(&away->handshake);
    if (result == HANDSHAKE_DONE) {
        come_back(context);
    } else if (result != HANDSHAKE_GOES_ON) {
        context_lose(context, false);
    } else {
        away->source.due_ns = away->handshake.deadline_ns;
    }
}

static void step(struct _X_IPC_CONTEXT *context)
{
    struct reconnect *away = context->away;
    if (context->state == CONTEXT_AWAY && away->fd < 0 && wait_is_over(away->source.due_ns)) {
        begin_try(context);
    }
    if (context->state == CONTEXT_AWAY && away->fd >= 0) {
        look_at_try(context);
    }
    if (context->state == CONTEXT_CONNECTING) {
        look_at_handshake(context);
    }
}

void reconnect_turn(struct library *library)
{
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        struct _X_IPC_CONTEXT *context = context_at(position);
        if (context->away != NULL) {
            step(context);
        }
    }
}
