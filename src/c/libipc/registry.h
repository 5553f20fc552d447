/*
 * What this module knows of the messages of one connection.
 *
 * A message that central has told about is never asked for again; a message
 * that nobody has defined yet is asked for at each use.
 */
#ifndef IPC_LIBIPC_REGISTRY_H
#define IPC_LIBIPC_REGISTRY_H

#include "libipc/context.h"

enum wire_kind {
    WIRE_NONE,    /* no data */
    WIRE_FIXED,   /* fixed_length bytes */
    WIRE_VARIABLE /* length, length again, bytes */
};

struct definition;
struct peer;

/* Where a message goes that is delivered directly. */
struct direct_target {
    int32_t handler;
    struct peer *peer; /* one reference; NULL: cannot be reached */
};

struct message {
    char *name; /* spelled as defined, once it is; owned */
    bool known; /* central has told its definition */
    bool lost;  /* an earlier central had; what it said is still here */
    int32_t id; /* of central; negative: deliver directly */
    enum wire_kind wire;
    size_t fixed_length;
    struct format *content;   /* NULL: none; the bad format if it is illegal; kept by the library */
    unsigned n_subscriptions; /* of this module */
    int queue_limit;          /* 0: none */
    int priority;             /* -1: none */
    struct definition *definition; /* by this module; NULL: none; owned */

    bool handlers_watched;         /* central keeps handlers up to date here */
    bool handlers_known;           /* and has told them */
    struct handler_list handlers;  /* newest subscription first; owned, of catalogue.handler_list */
    bool targets_stale;            /* handlers have changed since targets were made */
    struct direct_target *targets; /* oldest subscription first, owned */
    size_t n_targets;
};

/* The entry of a name, made if there is none; not looked up. */
struct message *registry_get(struct _X_IPC_CONTEXT *context, const char *name);

/*
 * The message with its definition, asking central if need be; *message is NULL
 * with IPC_Message_Not_Defined or an error of exchange.  loud: it is needed, so that is
 * printed, and what another module had defined before central was lost, and has not
 * yet defined again, is defined on its behalf.
 */
IPC_ERROR_TYPE registry_find(struct _X_IPC_CONTEXT *context, const char *name, bool loud,
                             struct message **message);

/* Takes the answer of central to a look-up into the entry of that name. */
void registry_learn(struct _X_IPC_CONTEXT *context, const char *name,
                    const struct message_info *info);

/* Central has gone: its numbers are forgotten, and where messages go; what they are is kept. */
void registry_lose(struct _X_IPC_CONTEXT *context);

/* Forgets where a message goes. */
void registry_forget_targets(struct message *message);

/* Makes the next use ask again, after this module has defined the message. */
void registry_renew(struct message *message);

/* Frees all entries. */
void registry_clear(struct _X_IPC_CONTEXT *context);

/* Finds the content bytes within a frame's data: 0, or ERR_CONTENT when it does not fit the message. */
int registry_unwrap(const struct message *message, const uint8_t *data, size_t length,
                    enum byte_order order, const uint8_t **content, size_t *content_length);

#endif
