/*
 * Subscriptions of this module, and the handlers that central knows them by.
 *
 * Central identifies a handler by its name and keeps the number of its first
 * registration as long as the connection lasts, so handler entries stay when a
 * subscription ends, and are used again.
 */
#ifndef IPC_LIBIPC_SUBSCRIPTION_H
#define IPC_LIBIPC_SUBSCRIPTION_H

#include "libipc/context.h"
#include "libipc/registry.h"

struct handler;

/* A handler of the library's own.  It runs while frames are taken in, so it neither waits nor
 * calls user code.  Returns whether the delivery is done with and to be acknowledged at once. */
typedef bool (*subscription_internal)(struct _X_IPC_CONTEXT *context, struct handler *handler,
                                      const struct frame *frame);

struct handler {
    struct list in_context; /* in its context's list of subscriptions while subscribed */
    char *name;             /* HND-<message><address>, or a name that a binding chose; owned */
    uint32_t id;
    bool registered; /* central has had its number */
    bool subscribed;
    bool unmarshall; /* hand over data instead of bytes */
    HANDLER_TYPE function;
    void *client_data;
    struct message *message;
    subscription_internal internal; /* instead of function */
};

/* Subscribes; central has it when this returns. */
IPC_ERROR_TYPE subscription_add(struct _X_IPC_CONTEXT *context, const char *message,
                                const char *handler_name, HANDLER_TYPE function, void *client_data,
                                bool unmarshall);

/* Subscribes the library itself, under the message's name. */
IPC_ERROR_TYPE subscription_add_internal(struct _X_IPC_CONTEXT *context, const char *message,
                                         subscription_internal internal);

/* The same without telling central, which the caller does. */
struct handler *subscription_prepare_internal(struct _X_IPC_CONTEXT *context, const char *message,
                                              subscription_internal internal);

/* Ends the subscription under that handler name, if there is one. */
IPC_ERROR_TYPE subscription_remove(struct _X_IPC_CONTEXT *context, const char *handler_name);

/* Ends all subscriptions of this module to the message. */
IPC_ERROR_TYPE subscription_remove_all(struct _X_IPC_CONTEXT *context, const char *message);

/* The usual handler name for a function; the caller frees it. */
char *subscription_name(const char *message, HANDLER_TYPE function);

/* Queues all subscriptions, oldest first, for a central that does not know them. */
void subscription_tell_all(struct _X_IPC_CONTEXT *context);

/* Central has gone, and the numbers with it. */
void subscription_lose(struct _X_IPC_CONTEXT *context);

void subscription_clear(struct _X_IPC_CONTEXT *context);

#endif
