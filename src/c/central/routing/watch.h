/*
 * Those who watch a variable get its new value, and only the newest.
 *
 * A value never waits behind a busy module's other deliveries.  What does hold it
 * back:
 *
 *   - the module is not ready;
 *   - the value before is still unsent, because the module does not read;
 *   - the module has not handled the value before.  The library of CMU IPC
 *     handles the first messages of a kind that it finds together in reverse
 *     order, and would end up with the oldest value.  A library that has the
 *     ability to take in all in order gets every value at once.
 *
 * A subscription that is held back is "due"; nothing else goes to its module
 * before the value, as far as the module takes it.  It is looked at again when
 * its module starts, reports or has been written to, and not in between: thousands
 * may be due.
 *
 * To a library that takes in all in order a value counts nothing against the
 * capacity.  To others it does, so that what follows waits until it is handled: a
 * module of CMU IPC would otherwise answer what follows before it knows who listens.
 */
#ifndef IPC_CENTRAL_WATCH_H
#define IPC_CENTRAL_WATCH_H

#include "central/routing/server.h"

struct variable;

/* Tells those who watch that the variable has a new value. */
void watch_changed(struct server *server, const struct variable *variable);

/* A value that was sent has been reported handled, or will not be. */
void watch_handled(struct server *server, struct handler *handler, struct message *message);

/* Sends what is due to a module and may go now. */
void watch_send_due(struct server *server, struct module *module, bool before_others);

/* A value that is due to the module may go now: bytes have been written to it, for one. */
static inline void watch_look_at(struct server *server, struct module *module)
{
    if (!list_is_empty(&module->due) && list_is_empty(&module->in_due)) {
        list_append(&server->due, &module->in_due);
    }
}

/* Sends what may go to those that are to be looked at; whether anything was. */
bool watch_settle(struct server *server);

/* To be called before anything else is sent to a module. */
static inline void watch_catch_up(struct server *server, struct module *module)
{
    if (list_is_empty(&module->due)) {
        return;
    }
    if (server->holding) {
        watch_look_at(server, module); /* what is about to be sent is held until then */
    } else {
        watch_send_due(server, module, true);
    }
}

#endif
