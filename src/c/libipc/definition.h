/*
 * What a module says of a message, as central is told it.
 */
#ifndef IPC_LIBIPC_DEFINITION_H
#define IPC_LIBIPC_DEFINITION_H

#include "libipc/context.h"

struct definition;

struct definition *definition_new(struct library *library, const char *name, unsigned int length,
                                  const char *text);

/* NULL is fine. */
void definition_free(struct definition *definition);

/* Queues it for central. */
void definition_tell(struct _X_IPC_CONTEXT *context, const struct definition *definition);

/* Sends such a one to central. */
IPC_ERROR_TYPE definition_send(struct _X_IPC_CONTEXT *context, const char *name,
                               unsigned int length, const char *text);

#endif
