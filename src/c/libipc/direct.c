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
#include "libipc/peer.h"
#include "libipc/receive.h"
#include "libipc/report.h"
#include "libipc/wait.h"

enum {
    FIRST_PORT = 8000, /* as CMU IPC: firewalls are set up for it */
    LAST_PORT = 9000,
    CONNECT_TIMEOUT_MS = 2000,
    MAX_INBOX_BYTES = 64 * 1024 * 1024 /* with more, others have to wait until some is handled */
};

/* ----------------------------------------------------------------------- peers */

static struct peer *peer_of(const struct source *source)
{
    return LIST_OWNER(source, struct peer, source);
}

static int wanted_from_peer(const struct source *source)
{
    const struct peer *peer = peer_of(source);
    const struct _X_IPC_CONTEXT *context = peer->context;
    const bool full = context->inbox_bytes > MAX_INBOX_BYTES && context->draining == 0;
    return (full ? 0 : READY_READ) | (link_waiting(&peer->link) > 0 ? READY_WRITE : 0);
}

static void take_found(struct source *source, int found)
{
    struct peer *peer = peer_ref(peer_of(source));
    if (found & READY_WRITE) {
        peer_flush(peer);
    }
    if (found & (READY_READ | READY_ERROR)) {
        (void)receive_from_peer(peer); /* what came is in the inbox */
    }
    peer_unref(peer);
}

static const struct source_kind peer_kind = {NULL, wanted_from_peer, take_found};

/* ------------------------------------------------------------------- listeners */

static int wanted_from_listener(const struct source *listener)
{
    (void)listener;
    return READY_READ;
}

static void accept_all(struct _X_IPC_CONTEXT *context, int listener, const char *kind)
{
    int fd;
    while (net_accept(listener, &fd) == 0) {
        (void)peer_new(context, &peer_kind, fd, true); /* it is in the list */
        report_warning("New %s Connection Established for a Module at sd: %d\n", kind, fd);
    }
}

static void accept_tcp(struct source *listener, int found)
{
    (void)found;
    accept_all(LIST_OWNER(listener, struct _X_IPC_CONTEXT, direct_tcp), listener->fd, "TCP");
}

static void accept_unix(struct source *listener, int found)
{
    (void)found;
    accept_all(LIST_OWNER(listener, struct _X_IPC_CONTEXT, direct_unix), listener->fd, "UNIX");
}

static const struct source_kind tcp_kind = {NULL, wanted_from_listener, accept_tcp};
static const struct source_kind unix_kind = {NULL, wanted_from_listener, accept_unix};

/* ------------------------------------------------------------- being reachable */

/*
 * The process ends: files of sockets would outlive it.  Without the lock, since a signal handler may
 * have called exit() while this thread held it; contexts are never freed.
 */
static void remove_files(void)
{
    struct library *library = library_at_end();
    struct list *position = library->contexts.next;
    for (; position != &library->contexts; position = position->next) {
        net_remove_local(&context_at(position)->direct_local);
    }
}

static void remove_files_at_end(struct library *library)
{
    if (!library->removes_files) {
        library->removes_files = true;
        (void)atexit(remove_files); /* at worst a stale file stays */
    }
}

/* Where the user wants modules to listen for each other; NULL: everywhere, since they may be on any
 * host, and those of CMU IPC have nothing to choose by. */
static const char *chosen_address(void)
{
    const char *address = getenv("IPC_DIRECT_ADDRESS");
    return address != NULL && *address != '\0' ? address : NULL;
}

/* Listens on that port by TCP and, if that works, by Unix socket: whether others can come. */
static bool listen_on(struct _X_IPC_CONTEXT *context, const char *address, int port)
{
    struct library *library = context->library;
    char path[NET_PATH_SIZE];
    int fd;
    if (net_listen_tcp(address, &port, &fd) != 0) {
        return false;
    }
    source_init(&context->direct_tcp, &tcp_kind, fd);
    wait_add(library, &context->direct_tcp);
    remove_files_at_end(library);
    snprintf(path, sizeof path, "%s/%d", NET_SOCKET_DIRECTORY, port);
    if (net_listen_local(path, 0777, &context->direct_local) == 0) {
        source_init(&context->direct_unix, &unix_kind, context->direct_local.fd);
        wait_add(library, &context->direct_unix);
    } else {
        context->direct_local.fd = -1; /* others then come by TCP */
    }
    return true;
}

int direct_listen(struct _X_IPC_CONTEXT *context)
{
    const char *address = chosen_address();
    for (int port = FIRST_PORT; port <= LAST_PORT; port++) {
        if (listen_on(context, address, port)) {
            context->direct_port = port;
            return 0;
        }
    }
    report_warning("Warning: no port from %d to %d for direct links%s%s\n", FIRST_PORT, LAST_PORT,
                   address != NULL ? " at IPC_DIRECT_ADDRESS=" : "",
                   address != NULL ? address : "");
    return ERR_IO;
}

void direct_tell_port(struct _X_IPC_CONTEXT *context)
{
    const struct number_and_name port = {context->direct_port, context->module_name};
    exchange_tell(context, LM_DIRECT_PORT, &port);
}

IPC_ERROR_TYPE direct_announce(struct _X_IPC_CONTEXT *context)
{
    const struct number_and_name port = {context->direct_port, context->module_name};
    return exchange_notice(context, LM_DIRECT_PORT, &port);
}

void direct_each_fd(struct _X_IPC_CONTEXT *context, void (*add)(void *set, int fd), void *set)
{
    struct list *position = context->peers.next;
    add(set, context->direct_tcp.fd);
    add(set, context->direct_unix.fd);
    for (; position != &context->peers; position = position->next) {
        add(set, peer_at(position)->link.fd);
    }
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
    struct peer *peer = peer_new(context, &peer_kind, fd, false);
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

/* Connects to whoever is listed, from the oldest subscription on.  Starts again when the list changes
 * meanwhile. */
static void make_targets(struct _X_IPC_CONTEXT *context, struct message *message)
{
    const unsigned connection = context->connection;
    char *name = mem_copy_string(message->name);
    while (context_is_connected_as(context, connection) && message->targets_stale) {
        const int count = message->handlers.count;
        message->targets_stale = false;
        registry_forget_targets(message);
        message->targets = mem_resize(NULL, (size_t)count + 1, sizeof *message->targets);
        for (int i = count - 1; i >= 0 && !message->targets_stale; i--) {
            const int32_t handler = message->handlers.handlers[i].id;
            struct peer *peer = reach(context, name, &message->handlers.handlers[i]);
            if (!context_is_connected_as(context, connection)) {
                break; /* and the lists have gone */
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
    IPC_ERROR_TYPE error = handler_watch_start(context, message);
    if (error == IPC_No_Error && !message->handlers_known) {
        error = handler_watch_ask(context, message);
    }
    if (error != IPC_No_Error) {
        return error;
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
    struct library *library = context->library;
    /* The file first: who gets the port then makes one of that name. */
    wait_remove(library, &context->direct_unix);
    net_close_local(&context->direct_local);
    context->direct_unix.fd = -1;
    if (context->direct_tcp.fd >= 0) {
        wait_remove(library, &context->direct_tcp);
        net_close(context->direct_tcp.fd);
        context->direct_tcp.fd = -1;
    }
    while (!list_is_empty(&context->peers)) {
        peer_close(peer_at(context->peers.next));
    }
}
