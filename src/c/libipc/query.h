/*
 * Queries of this module and responses to those of others.
 */
#ifndef IPC_LIBIPC_QUERY_H
#define IPC_LIBIPC_QUERY_H

#include "libipc/instance.h"

/* A response as the asker gets it. */
struct response {
    uint8_t *content; /* malloc block, NULL for no content */
    size_t length;
    enum byte_order order;
    struct message *message;
};

/* Sends a query whose response goes to handler (NULL: to nobody). */
IPC_ERROR_TYPE query_notify(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                            const void *content, HANDLER_TYPE handler, void *client_data);

/* Sends a query and listens until the response is there; *timed_out tells when it did not come. */
IPC_ERROR_TYPE query_response(struct _X_IPC_CONTEXT *context, const char *name, unsigned int length,
                              const void *content, unsigned int timeout_ms,
                              struct response *response, bool *timed_out);

/* Answers an instance. */
IPC_ERROR_TYPE query_respond(struct library *library, MSG_INSTANCE handle, const char *name,
                             unsigned int length, const void *content);

/* Lets an instance be answered after its handler has returned. */
IPC_ERROR_TYPE query_delay(struct library *library, MSG_INSTANCE handle);

#endif
