/*
 * Coming back after the loss of central.
 *
 * A context whose program wants it so does not end when its connection breaks.  It is
 * away: everything that the program has told the library stays, and another connection
 * to the same central is tried to be had, again and again, by whoever waits in the
 * library or calls it.  Nothing here waits.
 */
#ifndef IPC_LIBIPC_RECONNECT_H
#define IPC_LIBIPC_RECONNECT_H

#include "libipc/context.h"
#include "libipc/handshake.h"

/* How far a context that is away has come. */
struct reconnect {
    /* State away: the TCP connection under way if there is one, due at the next try or the end of the
     * present one.  State connecting: the link, due at the end of the handshake's time. */
    struct source source;
    int fd; /* TCP connection under way; -1: none */
    struct _X_IPC_CONTEXT *context;
    uint64_t pause_ns;          /* before the next try */
    struct handshake handshake; /* state connecting */
};

/* The connection broke, and has been closed: the one that the program has, or one that should become it. */
void reconnect_begin(struct _X_IPC_CONTEXT *context);

/* Ends that, if it has begun. */
void reconnect_end(struct _X_IPC_CONTEXT *context);

/* Goes on with every context that is away, as far as it can; waits do so as well. */
void reconnect_turn(struct library *library);

#endif
