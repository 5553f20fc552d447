/*
 * Callbacks: a user's function runs, without the lock.
 *
 * Callbacks of one context run on one thread at a time, which may nest them; so do
 * those that belong to no context.
 */
#ifndef IPC_LIBIPC_CALLBACK_H
#define IPC_LIBIPC_CALLBACK_H

#include "libipc/context.h"

/*
 * A callback that belongs to a context; to none if that is NULL or has ended.  dispatch is
 * the parent of what it sends.  Stays on the caller's stack until callback_end.
 */
struct running callback_of(struct library *library, struct _X_IPC_CONTEXT *context,
                           int32_t dispatch);

/* It begins: the lock is given up. */
void callback_begin(struct library *library, struct running *running);

/* It has returned: the lock is held again. */
void callback_end(struct library *library, struct running *running);

/* This thread alone runs callbacks of that turn from now on, until it has given it back as often. */
void callback_take_turn(struct turn *turn);
void callback_give_turn(struct library *library, struct turn *turn);

/* Whether this thread may run callbacks of that context (see callback_of) now: nobody does, or it
 * does itself. */
bool callback_turn_is_free(struct library *library, struct _X_IPC_CONTEXT *context);

#endif
