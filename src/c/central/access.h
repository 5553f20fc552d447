/*
 * Access control: who may be a module.
 *
 * Over TCP the machine's hosts.allow and hosts.deny decide, under the service
 * name "central".  Where they speak of names, a newcomer waits for the look-up of
 * its own, and nobody else does; what takes too long counts as unknown.  Unix
 * sockets tell the user at the other end, and an option says which users may.
 */
#ifndef IPC_CENTRAL_ACCESS_H
#define IPC_CENTRAL_ACCESS_H

#include "central/routing/server.h"
#include "platform/resolve.h"

struct access {
    struct server *server;
    const struct waker *waker; /* woken when a look-up is done */
    struct resolver *resolver; /* NULL until it is needed */
    struct list waiting;       /* newcomers whose names are being looked up, oldest first */
    size_t n_waiting;
    uint64_t n_looked_up; /* by the resolver, when those that wait were last seen */
};

void access_init(struct access *access, struct server *server, const struct waker *waker);

/* Closes the connections of those that wait. */
void access_fini(struct access *access);

enum access_answer {
    ACCESS_GRANTED,
    ACCESS_REFUSED, /* the connection is closed, and the log says so */
    ACCESS_LATER    /* the connection is kept: see access_next */
};

/* Decides about a connection that has just been accepted, from a Unix socket (local) or TCP. */
enum access_answer access_ask(struct access *access, int fd, bool local);

/* Whether anything has happened to those that wait since access_next last found none. */
bool access_has_news(const struct access *access);

/* A connection that has waited and is granted access, which is the caller's again; -1: none now. */
int access_next(struct access *access);

/* When to look again at the latest; UINT64_MAX: when woken. */
uint64_t access_deadline_ns(const struct access *access);

#endif
