/*
 * Defining messages and named formats at central.
 */
#ifndef IPC_LIBIPC_DEFINE_H
#define IPC_LIBIPC_DEFINE_H

#include "libipc/context.h"
#include "libipc/registry.h"

IPC_ERROR_TYPE define_message(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                              const char *format);

/* Queues what this module has defined, for a central that does not know it. */
void define_tell_all(struct _X_IPC_CONTEXT *context);

/* context NULL: in this process only. */
IPC_ERROR_TYPE define_format(struct library *library, struct _X_IPC_CONTEXT *context,
                             const char *name, const char *text);

#endif
