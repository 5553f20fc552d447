/*
 * Tables of what there is and what goes through it, for people.
 */
#ifndef IPC_CENTRAL_TABLES_H
#define IPC_CENTRAL_TABLES_H

#include "central/routing/server.h"

/* All connections: what they have sent and been sent. */
void tables_modules(const struct server *server, struct buffer *out);

/* Messages: how often they are published, who handles them, what waits.  all: the server's own,
 * too. */
void tables_messages(const struct server *server, struct buffer *out, bool all);

/* Resources, and messages that wait for a handler: what is under way and what waits. */
void tables_queues(const struct server *server, struct buffer *out);

#endif
