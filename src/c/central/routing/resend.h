/*
 * Sending again what modules did not finish before they ended (option -r).
 *
 * A query goes to another handler at once, or to the next one that comes.  A
 * broadcast goes only to who has lost it: it waits until a module of the same name
 * subscribes to the message.  Somebody at a terminal is asked before; meanwhile
 * the server goes on, and the deliveries wait.
 */
#ifndef IPC_CENTRAL_RESEND_H
#define IPC_CENTRAL_RESEND_H

#include <stdbool.h>

#include "central/routing/server.h"

/* Takes over a list of deliveries, which may be empty, that were lost with a resource. */
void resend(struct server *server, const char *resource, struct list *lost);

/* Whether the next typed line answers a question. */
bool resend_asks(const struct server *server);

/* Takes an answer: yes if it ends in y. */
void resend_answer(struct server *server, const char *line);

/* Nobody is asked any more, or from here on somebody is. */
void resend_set_asking(struct server *server, bool asking);

/* Gives up all that waits for an answer. */
void resend_fini(struct server *server);

#endif
