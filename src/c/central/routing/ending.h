/*
 * The end of a connection, in the order that everybody relies on.
 */
#ifndef IPC_CENTRAL_ENDING_H
#define IPC_CENTRAL_ENDING_H

#include "central/routing/server.h"

enum ending {
    ENDING_NOTICE,  /* the module has said goodbye */
    ENDING_LOSS,    /* the connection has ended or failed */
    ENDING_COMMAND, /* an operator wants it (the line that says so is the command's) */
};

/* Ends a connection; harmless for one that has ended.  The record is let go at the end of the turn.
 */
void ending(struct server *server, struct module *module, enum ending why);

/* Ends a connection whose peer breaks the protocol; one log line names it and the reason. */
void ending_for_violation(struct server *server, struct module *module, const char *reason);

/* Ends the condemned connections. */
void ending_carry_out(struct server *server);

/* Lets go of the records of connections that have ended. */
void ending_sweep(struct server *server);

#endif
