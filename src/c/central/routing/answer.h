/*
 * Answers of the server to requests of modules.
 */
#ifndef IPC_CENTRAL_ANSWER_H
#define IPC_CENTRAL_ANSWER_H

#include "central/routing/server.h"

/* Answers with a value in the message's reply format (NULL: without data) and ends the request. */
void answer(struct server *server, struct dispatch *request, const void *value);

/* The same, but the request lives on. */
void answer_and_keep(struct server *server, struct dispatch *request, const void *value);

/* Answers with something that can be watched, too, and ends the request: the answer goes before
 * values that are newer. */
void answer_state(struct server *server, struct dispatch *request, const void *value);

/* The same with bytes that are encoded already. */
void answer_encoded(struct server *server, struct dispatch *request, const uint8_t *bytes,
                    size_t length, enum byte_order order);

/* Ends a request without an answer. */
void answer_nothing(struct server *server, struct dispatch *request);

#endif
