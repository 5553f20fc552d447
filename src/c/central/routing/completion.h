/*
 * What modules report about deliveries: finished, failed, or a response.
 */
#ifndef IPC_CENTRAL_COMPLETION_H
#define IPC_CENTRAL_COMPLETION_H

#include "central/routing/server.h"

/* Takes a frame of class success, failure or reply. */
void completion(struct server *server, struct module *module, const struct frame *frame);

#endif
