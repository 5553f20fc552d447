/*
 * Values of variables: set here, told to those who watch.
 */
#ifndef IPC_CENTRAL_VALUE_H
#define IPC_CENTRAL_VALUE_H

#include "central/routing/variable.h"

/* Sets an encoded value that is known to fit the format; tells those who watch.  0 or ERR_MEMORY.
 */
int value_set(struct server *server, struct variable *variable, const uint8_t *bytes, size_t length,
              enum byte_order order);

/* Encodes and sets a value of one of the server's own variables, with the lines that the log has
 * for it. */
void value_set_own(struct server *server, struct variable *variable, const void *value);

#endif
