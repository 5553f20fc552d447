/*
 * What the server does of its own accord stands in the log like a request that
 * it sends to itself, with everything that it causes between its two lines.
 */
#ifndef IPC_CENTRAL_OWN_REQUEST_H
#define IPC_CENTRAL_OWN_REQUEST_H

#include "central/routing/server.h"

/* Begins a request of that message with an encoded value; NULL when no log shows any. */
struct dispatch *own_request_begin(struct server *server, struct message *message,
                                   const struct buffer *data);

/* The same, encoding the value by the message's format first. */
struct dispatch *own_request_begin_value(struct server *server, struct message *message,
                                         const void *value);

/* Ends what one of them returned. */
void own_request_end(struct server *server, struct dispatch *dispatch);

#endif
