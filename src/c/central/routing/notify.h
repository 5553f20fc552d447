/*
 * Notices of modules that come and go.
 */
#ifndef IPC_CENTRAL_NOTIFY_H
#define IPC_CENTRAL_NOTIFY_H

#include "central/routing/server.h"

/* Publishes the name of a module as LM_CONNECTED or LM_DISCONNECTED. */
void notify(struct server *server, enum library_message which, const struct module *module);

#endif
