/*
 * Defining messages and named formats at central.
 */
#ifndef IPC_LIBIPC_DEFINE_H
#define IPC_LIBIPC_DEFINE_H

#include "libipc/context.h"
#include "libipc/registry.h"

IPC_ERROR_TYPE define_message(struct _X_IPC_CONTEXT *context, const char *name,
                              unsigned int length, const char *format);

/* Defines a message as another module had defined it at a central that has been lost. */
IPC_ERROR_TYPE define_again(struct _X_IPC_CONTEXT *context, const struct message *message);

/* Queues what this module has defined, for a central that does not know it. */
void define_tell_all(struct _X_IPC_CONTEXT *context);

/* Frees what this module has said of a message. */
void define_forget(struct message *message);

/* context NULL: in this process only. */
IPC_ERROR_TYPE define_format(struct library *library, struct _X_IPC_CONTEXT *context,
                             const char *name, const char *text);

#endif
