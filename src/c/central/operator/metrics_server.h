/*
 * Where the server's numbers are asked for: a small part of HTTP.
 *
 * Served by the same loop as the modules and bounded in every respect: a few
 * connections at a time, one short request each, two seconds' patience.  Those
 * that come while all places are taken wait in the kernel's queue.
 */
#ifndef IPC_CENTRAL_METRICS_SERVER_H
#define IPC_CENTRAL_METRICS_SERVER_H

#include "central/routing/server.h"
#include "platform/platform.h"

enum { METRICS_CALLERS = 4, METRICS_REQUEST = 2048 };

/* One connection: it asks, then it is answered. */
struct metrics_caller {
    int fd; /* -1: the place is free */
    uint64_t deadline_ns;
    char request[METRICS_REQUEST];
    size_t asked;         /* bytes of it */
    struct buffer answer; /* owned; empty while it asks */
    size_t sent;          /* bytes of it */
};

struct metrics_server {
    struct server *server;
    int tcp;                /* -1: none */
    struct net_local local; /* fd -1: none */
    bool watched;           /* the listener is */
    uint64_t again_ns;      /* until then nobody is taken, for want of descriptors; 0: not so */
    struct metrics_caller callers[METRICS_CALLERS];
};

void metrics_server_init(struct metrics_server *metrics, struct server *server);
void metrics_server_fini(struct metrics_server *metrics);

/* Takes over a socket that listens already: 0 or ERR_IO. */
int metrics_server_adopt(struct metrics_server *metrics, int fd);

/*
 * Listens at an address: a path with a slash in front, or a port, which is this
 * machine's only, or host:port.  0, ERR_RANGE (it is no address), or an error as of
 * net_listen_tcp and net_listen_local.  Says in the terminal's log where it listens.
 */
int metrics_server_open(struct metrics_server *metrics, const char *address);

/* Whether an event of the poller belongs to it; if so it is dealt with. */
bool metrics_server_take_event(struct metrics_server *metrics, const void *owner);

/* Ends what takes too long. */
void metrics_server_turn(struct metrics_server *metrics);

/* When to do so at the latest. */
uint64_t metrics_server_deadline_ns(const struct metrics_server *metrics);

#endif
