/*
 * The sockets that modules connect to, and how newcomers become connections.
 *
 * There is a TCP socket and a Unix socket, opened here or handed over by a
 * supervisor; either may be missing.  When descriptors run out, newcomers are
 * refused one by one, and those that are connected notice nothing.
 */
#ifndef IPC_CENTRAL_LISTENERS_H
#define IPC_CENTRAL_LISTENERS_H

#include "central/access.h"
#include "central/routing/server.h"
#include "platform/platform.h"

struct listeners {
    struct server *server;
    int tcp;                /* -1: none */
    struct net_local local; /* fd -1: none */
    bool accepting;         /* both are watched */
    uint64_t accept_again_ns;
    uint64_t warn_again_ns; /* that there are no descriptors */
    int spare;              /* descriptor by which to refuse when there are no others */
    struct access access;
};

/* The waker, and the server's poller, outlive the listeners. */
void listeners_init(struct listeners *listeners, struct server *server, const struct waker *waker);
void listeners_fini(struct listeners *listeners);

/* Takes over a socket that listens already: 0, or ERR_IO (it does not), ERR_LIMIT (there is one of
 * that kind), ERR_REFUSED (the options forbid that kind). */
int listeners_adopt(struct listeners *listeners, int fd);

/* Opens what the options ask for, unless sockets were taken over, and watches; the port in the
 * options becomes the real one.  0, or an error when modules could not connect (of ERR_IO errno
 * says why). */
int listeners_open(struct listeners *listeners);

/* Whether the options allow a TCP socket: it does not tell whose program connects. */
bool listeners_want_tcp(const struct listeners *listeners);

/* Whether an event of the poller belongs to them; if so newcomers are accepted. */
bool listeners_take_event(struct listeners *listeners, const void *owner);

/* A connection has ended, so there is room again. */
void listeners_have_room(struct listeners *listeners);

/* Does what is due in this turn. */
void listeners_turn(struct listeners *listeners);

/* When to do so at the latest. */
uint64_t listeners_deadline_ns(const struct listeners *listeners);

#endif
