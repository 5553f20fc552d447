/*
 * Message instances: one arrival of a message, from the inbox to the end of its
 * handler, or to the response where that is delayed.
 *
 * A MSG_INSTANCE is a number in disguise, not an address, so that a program that
 * uses one too late gets an error and not another message.
 */
#ifndef IPC_LIBIPC_INSTANCE_H
#define IPC_LIBIPC_INSTANCE_H

#include "libipc/context.h"
#include "libipc/registry.h"

struct handler;
struct peer;

enum instance_kind {
    INSTANCE_DELIVERY, /* of a message, for a subscription */
    INSTANCE_REPLY,    /* of the response to a query, for its handler */
    INSTANCE_NOTICE    /* for the watchers of modules or subscriptions */
};

struct instance {
    struct list in_queue; /* inbox, delayed, or spare */
    uint32_t number;
    enum instance_kind kind;
    struct _X_IPC_CONTEXT *context;
    unsigned connection; /* of the context, over which it came */
    struct message *message;
    struct handler *handler; /* deliveries */
    HANDLER_TYPE function;   /* replies */
    void *client_data;
    uint16_t class;    /* enum frame_class */
    int32_t dispatch;  /* deliveries: central's number; NO_ID: nothing to acknowledge */
    struct peer *peer; /* deliveries that came directly, one reference; else NULL */
    int32_t reference; /* of those, the sender's number */
    bool wrapped;      /* content is still the whole frame's data */
    uint8_t *content;  /* malloc block, owned until given to a handler; NULL if length is 0 */
    size_t length;
    enum byte_order order;
    bool running; /* its handler has been called and has not returned */
    bool active;  /* counts against the capacity */
    bool responded;
    bool delayed;
    struct list *watchers; /* notices: of this list of the context */
    char *notice_name;     /* malloc */
    int notice_count;
};

struct instance *instance_new(struct _X_IPC_CONTEXT *context, enum instance_kind kind);

/* Frees content and number; handles of it are stale from now on. */
void instance_free(struct instance *instance);

/* The disguise. */
MSG_INSTANCE instance_handle(const struct instance *instance);

/* The live instance behind a handle, NULL if stale. */
struct instance *instance_find(const struct library *library, MSG_INSTANCE handle);

/* Whether the connection over which it came has gone: central, or a new one, knows nothing of it. */
bool instance_is_stale(const struct instance *instance);

/* Whether the capacity lets it run now.  Central may send more than that ahead; and what does not
 * come from central does not count.  While central is away, that is what it had sent before. */
bool instance_may_run(const struct instance *instance);

/* It counts against the capacity from now on, or (instance_passivate) no longer. */
void instance_activate(struct instance *instance);
void instance_passivate(struct instance *instance);

/* Acknowledges a delivery of central, once; the frame leaves with the next write. */
void instance_acknowledge(struct instance *instance);

#endif
