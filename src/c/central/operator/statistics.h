/*
 * What the memory command shows, and every orderly end.
 */
#ifndef IPC_CENTRAL_STATISTICS_H
#define IPC_CENTRAL_STATISTICS_H

#include "central/routing/server.h"

/* Appends the statistics.  The labels of the first lines are as old as the program. */
void statistics_append(const struct server *server, struct buffer *out);

#endif
