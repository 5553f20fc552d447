/*
 * Listening: timers, descriptors and messages, in the manual's order.
 */
#ifndef IPC_LIBIPC_LISTEN_H
#define IPC_LIBIPC_LISTEN_H

#include "libipc/library.h"

struct awaited;

enum listen_mode {
    LISTEN_BATCH, /* everything that waits when the first handler starts */
    LISTEN_ONE    /* one message, or else one descriptor */
};

enum listen_result {
    LISTEN_HANDLED,        /* a message or a descriptor */
    LISTEN_NOTHING,        /* until the deadline */
    LISTEN_GIVEN_UP,       /* by the program; something may have been handled */
    LISTEN_BAD_DESCRIPTOR, /* a watched one is not open */
    LISTEN_DISCONNECTED
};

/* Handles what comes first, for all contexts, until the deadline. */
enum listen_result listen_pass(struct library *library, uint64_t deadline_ns,
                               enum listen_mode mode);

/* The same on behalf of a query: also ends as soon as that is done or has failed, and does not
 * care whether the current context is connected.  The query's result is in awaited. */
enum listen_result listen_pass_for(struct library *library, uint64_t deadline_ns,
                                   const struct awaited *awaited);

#endif
