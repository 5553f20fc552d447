/*
 * The sockets that modules connect to, and how newcomers become connections.
 */
#include "central/listeners.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "central/routing/ending.h"
#include "central/routing/lifecycle.h"

enum {
    ACCEPTED_A_TURN = 64, /* connections */
    LOCAL_MODE = 0777     /* everybody may connect, as to the TCP port */
};

#define SECOND_NS UINT64_C(1000000000)
#define ACCEPT_PAUSE_NS SECOND_NS
#define WARN_PAUSE_NS (60 * SECOND_NS)

/* ------------------------------------------------------------------ life cycle */

void listeners_init(struct listeners *listeners, struct server *server, const struct waker *waker)
{
    memset(listeners, 0, sizeof *listeners);
    listeners->server = server;
    listeners->tcp = -1;
    listeners->local.fd = -1;
    listeners->spare = net_open_spare();
    access_init(&listeners->access, server, waker);
}

void listeners_fini(struct listeners *listeners)
{
    /* The file first: who gets the port then makes one of that name. */
    net_close_local(&listeners->local);
    if (listeners->tcp >= 0) {
        net_close_copy(listeners->tcp); /* a supervisor may have another */
    }
    if (listeners->spare >= 0) {
        net_close_copy(listeners->spare);
    }
    access_fini(&listeners->access);
}

/* ------------------------------------------------------------------- listening */

bool listeners_want_tcp(const struct listeners *listeners)
{
    const struct options *options = listeners->server->options;
    return !options->local_only && options->users == USERS_ALL;
}

int listeners_adopt(struct listeners *listeners, int fd)
{
    struct options *options = listeners->server->options;
    bool local;
    int port;
    if (net_adopt(fd, &local, &port) != 0) {
        return ERR_IO;
    }
    if (!local && !listeners_want_tcp(listeners)) {
        return ERR_REFUSED;
    }
    int *place = local ? &listeners->local.fd : &listeners->tcp;
    if (*place >= 0) {
        return ERR_LIMIT;
    }
    *place = fd;
    if (port != 0 && (!local || listeners->tcp < 0)) {
        options->port = port;
    }
    return 0;
}

/* A number for the Unix socket that no TCP socket has at the moment, where any will do. */
static int choose_number(int *port)
{
    int fd;
    if (*port != 0) {
        return 0;
    }
    const int error = net_listen_tcp("127.0.0.1", port, &fd);
    if (error == 0) {
        net_close(fd);
    }
    return error;
}

static int open_local(struct listeners *listeners)
{
    char path[NET_PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s/%d", NET_SOCKET_DIRECTORY,
                   listeners->server->options->port);
    const int error = net_listen_local(path, LOCAL_MODE, &listeners->local);
    if (error != 0 && !listeners->server->options->silent) {
        const int saved = errno;
        (void)fprintf(stderr, "Warning: no socket %s (%s)%s\n", path,
                      error == ERR_IO ? system_reason() : error_text(error),
                      listeners->tcp >= 0 ? ", modules use TCP" : "");
        errno = saved;
    }
    return error;
}

static int open_both(struct listeners *listeners)
{
    struct options *options = listeners->server->options;
    if (!listeners_want_tcp(listeners)) {
        const int error = choose_number(&options->port);
        return error != 0 ? error : open_local(listeners);
    }
    const int error = net_listen_tcp(options->address, &options->port, &listeners->tcp);
    if (error != 0) {
        listeners->tcp = -1;
        return error;
    }
    if (net_has_local()) {
        (void)open_local(listeners); /* modules then use TCP */
    }
    return 0;
}

/* Watches one: whether it is watched. */
static bool watch(struct listeners *listeners, int fd, void *owner)
{
    return fd >= 0 && poller_add(listeners->server->poller, fd, READY_READ, owner) == 0;
}

static void watch_both(struct listeners *listeners)
{
    const bool tcp = watch(listeners, listeners->tcp, &listeners->tcp);
    const bool local = watch(listeners, listeners->local.fd, &listeners->local);
    listeners->accepting = tcp || local;
}

int listeners_open(struct listeners *listeners)
{
    const bool given = listeners->tcp >= 0 || listeners->local.fd >= 0;
    const int error = given ? 0 : open_both(listeners);
    if (error != 0) {
        return error;
    }
    watch_both(listeners);
    return listeners->accepting ? 0 : ERR_IO;
}

/* ------------------------------------------------------------------- newcomers */

/* Leaves newcomers in the kernel's queue for a while. */
static void pause_accepting(struct listeners *listeners)
{
    struct server *server = listeners->server;
    if (listeners->tcp >= 0) {
        poller_remove(server->poller, listeners->tcp);
    }
    if (listeners->local.fd >= 0) {
        poller_remove(server->poller, listeners->local.fd);
    }
    listeners->accepting = false;
    listeners->accept_again_ns = server->now_ns + ACCEPT_PAUSE_NS;
}

static void warn(struct listeners *listeners)
{
    struct server *server = listeners->server;
    if (server->now_ns >= listeners->warn_again_ns) {
        listeners->warn_again_ns = server->now_ns + WARN_PAUSE_NS;
        log_always(&server->log, "WARNING: no descriptors left, new modules are refused\n");
    }
}

static void add_connection(struct listeners *listeners, int fd)
{
    struct server *server = listeners->server;
    struct module *module = server_add_connection(server, fd);
    module->polled = READY_READ;
    if (poller_add(server->poller, fd, module->polled, module) != 0) {
        ending_for_violation(server, module, "its socket cannot be watched");
    }
}

/* Rules are read from files, for which there has to be a descriptor: the spare one makes room. */
static bool lend_spare(struct listeners *listeners)
{
    if (listeners->spare < 0) {
        listeners->spare = net_open_spare();
    }
    if (listeners->spare < 0) {
        return false;
    }
    net_close_copy(listeners->spare);
    return true;
}

static void take_spare_back(struct listeners *listeners)
{
    listeners->spare = net_open_spare();
}

static void refuse(struct listeners *listeners)
{
    warn(listeners);
    listeners->server->statistics.n_without_descriptor++;
}

static void receive(struct listeners *listeners, int fd, bool local)
{
    if (!lend_spare(listeners)) {
        net_close(fd);
        refuse(listeners);
        return;
    }
    const enum access_answer answer = access_ask(&listeners->access, fd, local);
    take_spare_back(listeners);
    if (answer == ACCESS_GRANTED) {
        add_connection(listeners, fd);
    }
}

/* Takes those whose look-up is over.  Without any descriptor the rules cannot be read and refuse. */
static void receive_waiting(struct listeners *listeners)
{
    int fd;
    do {
        (void)lend_spare(listeners);
        fd = access_next(&listeners->access);
        take_spare_back(listeners);
        if (fd >= 0) {
            add_connection(listeners, fd);
        }
    } while (fd >= 0);
}

/* Takes one newcomer: 0, or not when there is none, or none can be taken now. */
static int accept_one(struct listeners *listeners, int listener)
{
    int fd;
    int result = net_accept(listener, &fd);
    if (result == 0) {
        receive(listeners, fd, listener == listeners->local.fd);
    } else if (result == ERR_LIMIT) {
        result = net_refuse(listener, &listeners->spare);
        if (result == 0) {
            refuse(listeners);
        }
    }
    if (result == ERR_LIMIT) {
        warn(listeners);
        pause_accepting(listeners);
    }
    return result;
}

bool listeners_take_event(struct listeners *listeners, const void *owner)
{
    if (owner != &listeners->tcp && owner != &listeners->local) {
        return false;
    }
    const int listener = owner == &listeners->tcp ? listeners->tcp : listeners->local.fd;
    for (int i = 0; i < ACCEPTED_A_TURN && listeners->accepting; i++) {
        if (accept_one(listeners, listener) != 0) {
            break;
        }
    }
    return true;
}

/* ----------------------------------------------------------------------- turns */

void listeners_have_room(struct listeners *listeners)
{
    listeners->accept_again_ns = 0;
}

void listeners_turn(struct listeners *listeners)
{
    if (access_has_news(&listeners->access)) {
        receive_waiting(listeners);
    }
    if (!listeners->accepting && listeners->server->now_ns >= listeners->accept_again_ns) {
        watch_both(listeners);
    }
}

uint64_t listeners_deadline_ns(const struct listeners *listeners)
{
    const uint64_t access_ns = access_deadline_ns(&listeners->access);
    return listeners->accepting || access_ns < listeners->accept_again_ns
               ? access_ns
               : listeners->accept_again_ns;
}
