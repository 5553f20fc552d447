/*
 * The start: modules may begin when enough of them are there.
 *
 * While connecting, every module asks whether it may start.  The answer is
 * withheld until as many have asked as the operator expects; from then on it
 * waits only for the names that the module itself requires.
 */
#ifndef IPC_CENTRAL_START_H
#define IPC_CENTRAL_START_H

#include "central/routing/server.h"

/* A module asks to start. */
void start_ask(struct server *server, struct module *module, struct dispatch *request);

/* A module that waits is going. */
void start_withdraw(struct server *server, struct module *module);

/* Something is there that a waiting module may require. */
void start_check(struct server *server);

#endif
