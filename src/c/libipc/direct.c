/*
 * Direct mode.
 */
#include "libipc/direct.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "libipc/address.h"
#include "libipc/exchange.h"
#include "libipc/handler_watch.h"
#include "libipc/receive.h"
#include "libipc/report.h"
#include "libipc/wait.h"

enum {
    FIRST_PORT = 8000, /* as CMU IPC: firewalls are set up for it */
    LAST_PORT = 9000,
    CONNECT_TIMEOUT_MS = 2000,
    MAX_INBOX_BYTES = 64 * 1024 * 1024 /* with more, others have to wait until some is handled */
};

static struct peer *peer_at(struct list *position)
{
    return LIST_OWNER(position, struct peer, in_context);
}

/* ----------------------------------------------------------------------- peers */

static struct peer *peer_new(struct _X_IPC_CONTEXT *context, int fd, bool incoming)
{
    struct peer *peer = mem_new(sizeof *peer);
    peer->context = context;
    peer->incoming = incoming;
    peer->references = 1;
    link_init(&peer->link, fd, FROM_PEER);
    list_append(&context->peers, &peer->in_context);
    if (fd > context->library->max_fd) {
        context->library->max_fd = fd;
    }
    return peer;
}

struct peer *peer_ref(struct peer *peer)
{
    peer->references++;
    return peer;
}

void peer_unref(struct peer *peer)
{
    if (peer != NULL && --peer->references == 0) {
        free(peer->host);
        free(peer);
    }
}

/* Takes a peer off the list; who still refers to it sees that its link is closed. */
static void peer_forget(struct peer *peer)
{
    list_remove(&peer->in_context);
    peer_unref(peer);
}

void direct_peer_ended(struct peer *peer)
{
    if (peer->link.fd >= 0) {
        report_warning("Closed Connection Detected from: Module: sd: %d:\n", peer->link.fd);
        link_fini(&peer->link); /* the next wait forgets the peer */
    }
}

static void peer_flush(struct peer *peer)
{
    if (peer->link.fd >= 0 && link_flush(&peer->link) < 0) {
        direct_peer_ended(peer);
    }
}

void direct_drain(struct peer *peer, uint64_t mark)
{
    struct _X_IPC_CONTEXT *context = peer->context;
    (void)peer_ref(peer); /* the list may give up the last other reference */
    context->draining++;
    const bool broken = peer->link.fd >= 0 && link_flush(&peer->link) < 0;
    bool given_up = false; /* then it leaves later */
    while (!broken && !given_up && peer->link.fd >= 0 && peer->link.written < mark) {
        given_up = !wait_turn(context->library, NO_DEADLINE) && link_keep_borrowed(&peer->link);
    }
    context->draining--;
    if (broken) {
        direct_peer_ended(peer);
    }
    peer_unref(peer);
}

/* ------------------------------------------------------------- being reachable */

int direct_listen(struct _X_IPC_CONTEXT *context)
{
    for (int port = FIRST_PORT; port <= LAST_PORT; port++) {
        char path[NET_PATH_SIZE];
        int actual = port;
        if (net_listen_tcp(NULL, &actual, &context->direct_tcp) != 0) {
            context->direct_tcp = -1;
            continue;
        }
        snprintf(path, sizeof path, "%s/%d", NET_SOCKET_DIRECTORY, port);
        if (net_listen_local(path, 0777, &context->direct_local) != 0) {
            context->direct_local.fd = -1; /* others then come by TCP */
        }
        context->direct_port = port;
        return 0;
    }
    return ERR_IO;
}

IPC_ERROR_TYPE direct_announce(struct _X_IPC_CONTEXT *context)
{
    const struct number_and_name port = {context->direct_port, context->module_name};
    return exchange_notice(context, LM_DIRECT_PORT, &port);
}

static void accept_all(struct _X_IPC_CONTEXT *context, int listener, const char *kind)
{
    int fd;
    while (net_accept(listener, &fd) == 0) {
        (void)peer_new(context, fd, true); /* it is in the list */
        report_warning("New %s Connection Established for a Module at sd: %d\n", kind, fd);
    }
}

/* --------------------------------------------------------------------- waiting */

void direct_each_fd(struct _X_IPC_CONTEXT *context,
                    void (*add)(void *waiting, int fd, int wanted, struct _X_IPC_CONTEXT *context),
                    void *waiting)
{
    const bool full = context->inbox_bytes > MAX_INBOX_BYTES && context->draining == 0;
    if (context->direct_tcp >= 0) {
        add(waiting, context->direct_tcp, READY_READ, context);
    }
    if (context->direct_local.fd >= 0) {
        add(waiting, context->direct_local.fd, READY_READ, context);
    }
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &context->peers) {
        struct peer *peer = peer_at(position);
        const int wanted = (full ? 0 : READY_READ) |
                           (link_waiting(&peer->link) > 0 ? READY_WRITE : 0);
        if (peer->link.fd >= 0) {
            add(waiting, peer->link.fd, wanted, context);
        } else {
            peer_forget(peer);
        }
    }
}

static struct peer *peer_of_fd(struct _X_IPC_CONTEXT *context, int fd)
{
    struct list *position = context->peers.next;
    for (; position != &context->peers; position = position->next) {
        if (peer_at(position)->link.fd == fd) {
            return peer_at(position);
        }
    }
    return NULL;
}

void direct_ready(struct _X_IPC_CONTEXT *context, int fd, int found)
{
    if (fd == context->direct_tcp) {
        accept_all(context, fd, "TCP");
        return;
    }
    if (fd == context->direct_local.fd) {
        accept_all(context, fd, "UNIX");
        return;
    }
    struct peer *peer = peer_of_fd(context, fd);
    if (peer == NULL) {
        return;
    }
    (void)peer_ref(peer);
    if (found & READY_WRITE) {
        peer_flush(peer);
    }
    if (found & (READY_READ | READY_ERROR)) {
        (void)receive_from_peer(peer); /* what came is in the inbox */
    }
    peer_unref(peer);
}

void direct_look(struct _X_IPC_CONTEXT *context)
{
    struct list *position;
    struct list *following;
    LIST_EACH (position, following, &context->peers) {
        (void)receive_from_peer(peer_at(position)); /* what came is in the inbox */
    }
}

/* --------------------------------------------------------------------- targets */

static struct peer *find_outgoing(struct _X_IPC_CONTEXT *context, const char *host, int port)
{
    struct list *position = context->peers.next;
    for (; position != &context->peers; position = position->next) {
        struct peer *peer = peer_at(position);
        if (!peer->incoming && peer->link.fd >= 0 && peer->port == port &&
            table_same_name(TABLE_FOLDING, peer->host, host)) {
            return peer;
        }
    }
    return NULL;
}

/* Opens a link, giving up the lock while the kernel connects; NULL when nobody is there. */
static struct peer *open_outgoing(struct _X_IPC_CONTEXT *context, const char *host, int port,
                                  const char *message, const char *module)
{
    struct address address;
    int fd = -1;
    if (address_parse(host, &address) != 0) {
        return NULL;
    }
    address.port = port;
    int (*const give_up)(void) = context->library->give_up;
    library_leave(context->library);
    const int error = address_connect(&address, CONNECT_TIMEOUT_MS, give_up, &fd, NULL);
    mutex_lock(context->library->lock);
    if (error != 0) {
        return NULL;
    }
    if (!context_is_connected(context)) {
        net_close(fd);
        return NULL;
    }
    struct peer *peer = peer_new(context, fd, false);
    peer->host = mem_copy_string(host);
    peer->port = port;
    report_warning("Direct Connection Established for %s to %s at sd: %d\n", message, module, fd);
    return peer;
}

/* A link to where that handler is; NULL when there is none to be had. */
static struct peer *reach(struct _X_IPC_CONTEXT *context, const char *message,
                          const struct handler_address *address)
{
    if (address->host == NULL || address->port <= 0 || address->port > 65535) {
        return NULL;
    }
    /* The list may change while a link is opened, so this needs its own copies. */
    char *host = mem_copy_string(address->host);
    char *module = mem_copy_string(address->module != NULL ? address->module : "");
    const int port = address->port;
    struct peer *peer = find_outgoing(context, host, port);
    if (peer == NULL) {
        peer = open_outgoing(context, host, port, message, module);
    }
    free(host);
    free(module);
    return peer;
}

void direct_forget_targets(struct message *message)
{
    for (size_t i = 0; i < message->n_targets; i++) {
        peer_unref(message->targets[i].peer);
    }
    free(message->targets);
    message->targets = NULL;
    message->n_targets = 0;
}

/* Connects to whoever is listed, from the oldest subscription on.  Starts again when the list changes
 * meanwhile. */
static void make_targets(struct _X_IPC_CONTEXT *context, struct message *message)
{
    char *name = mem_copy_string(message->name);
    while (context_is_connected(context) && message->targets_stale) {
        const int count = message->handlers.count;
        message->targets_stale = false;
        direct_forget_targets(message);
        message->targets = mem_resize(NULL, (size_t)count + 1, sizeof *message->targets);
        for (int i = count - 1; i >= 0 && !message->targets_stale; i--) {
            const int32_t handler = message->handlers.handlers[i].id;
            struct peer *peer = reach(context, name, &message->handlers.handlers[i]);
            if (!context_is_connected(context)) {
                break;
            }
            struct direct_target *target = &message->targets[message->n_targets++];
            target->handler = handler;
            target->peer = peer != NULL ? peer_ref(peer) : NULL;
        }
    }
    free(name);
}

IPC_ERROR_TYPE direct_find_targets(struct _X_IPC_CONTEXT *context, struct message *message)
{
    if (!message->handlers_watched) {
        IPC_ERROR_TYPE error = handler_watch_start(context, message);
        if (error == IPC_No_Error) {
            error = handler_watch_ask(context, message);
        }
        if (error != IPC_No_Error) {
            return error;
        }
    }
    (void)receive(context); /* central may have news of the list */
    if (context_is_connected(context) && message->targets_stale) {
        make_targets(context, message);
        if (context_is_connected(context) && message->n_targets == 0) {
            report_warning("No handlers for direct message %s\n", message->name);
        }
    }
    return context_is_connected(context) ? IPC_No_Error : IPC_Not_Connected;
}

void direct_close(struct _X_IPC_CONTEXT *context)
{
    if (context->direct_tcp >= 0) {
        net_close(context->direct_tcp);
        context->direct_tcp = -1;
    }
    net_close_local(&context->direct_local);
    while (!list_is_empty(&context->peers)) {
        struct peer *peer = peer_at(context->peers.next);
        if (peer->link.fd >= 0) {
            link_fini(&peer->link);
        }
        peer_forget(peer);
    }
}
