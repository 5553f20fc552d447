/*
 * Requests and notices of modules to the server: one table says, for every
 * library message, which function carries it out.
 */
#ifndef IPC_CENTRAL_SERVICE_H
#define IPC_CENTRAL_SERVICE_H

#include "central/routing/server.h"

/* Carries out a frame of a module to a message that the server handles. */
void service(struct server *server, struct module *module, const struct frame *frame,
             struct message *message);

#endif
