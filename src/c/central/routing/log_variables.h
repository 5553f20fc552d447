/*
 * The switches of the two logs as variables, for modules that want to know.
 */
#ifndef IPC_CENTRAL_LOG_VARIABLES_H
#define IPC_CENTRAL_LOG_VARIABLES_H

#include "central/routing/server.h"

/* Makes the variables and sets them. */
void log_variables_define(struct server *server);

/* Sets one of them anew, after its log's switches were changed. */
void log_variables_set_terminal(struct server *server);
void log_variables_set_file(struct server *server);

#endif
