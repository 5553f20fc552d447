/*
 * Callbacks.
 */
#include "libipc/callback.h"

#include <string.h>

#include "libipc/wait.h"

/* The one that callbacks of a live context take, or (NULL) those of no context. */
static struct turn *turn_of(struct library *library, struct _X_IPC_CONTEXT *context)
{
    return context != NULL ? &context->turn : &library->turn;
}

bool callback_turn_is_free(struct library *library, struct _X_IPC_CONTEXT *context)
{
    const struct turn *turn = turn_of(library, context_if_live(context));
    return turn->thread == 0 || turn->thread == thread_number();
}

void callback_take_turn(struct turn *turn)
{
    turn->thread = thread_number();
    turn->depth++;
}

void callback_give_turn(struct library *library, struct turn *turn)
{
    if (--turn->depth == 0) {
        turn->thread = 0;
        wait_wake(library); /* others may have waited for it */
    }
}

struct running callback_of(struct library *library, struct _X_IPC_CONTEXT *context,
                           int32_t dispatch)
{
    struct running running;
    memset(&running, 0, sizeof running);
    running.context = context_if_live(context);
    running.turn = turn_of(library, running.context);
    running.dispatch = dispatch;
    return running;
}

void callback_begin(struct library *library, struct running *running)
{
    running->thread = thread_number();
    running->outer = library->running;
    library->running = running;
    callback_take_turn(running->turn);
    library_leave(library);
}

void callback_end(struct library *library, struct running *running)
{
    mutex_lock(library->lock);
    struct running **link = &library->running;
    while (*link != running) {
        link = &(*link)->outer;
    }
    *link = running->outer;
    callback_give_turn(library, running->turn);
}
