/*
 * Conflicts: two modules that define a message differently.
 *
 * The last definition counts, as in CMU IPC; the log says who disagrees with
 * whom about what.
 */
#ifndef IPC_CENTRAL_CONFLICT_H
#define IPC_CENTRAL_CONFLICT_H

#include "central/routing/server.h"

/* A module is about to define a message that is defined already, by these texts. */
void conflict_check(struct server *server, const struct module *module,
                    const struct message *message, const struct message_definition_texts *texts);

#endif
