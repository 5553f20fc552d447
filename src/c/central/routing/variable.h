/*
 * Variables: values that the server keeps for everybody.
 *
 * A variable is four messages: one sets it, one gets it, one does both, and one
 * tells those who watch it (see value.h and watch.h).  The server keeps some of its own.
 */
#ifndef IPC_CENTRAL_VARIABLE_H
#define IPC_CENTRAL_VARIABLE_H

#include "central/routing/server.h"

enum { N_VARIABLE_MESSAGES = MESSAGE_WATCH - MESSAGE_SET + 1 };

struct variable {
    char *name;            /* owned */
    struct format *format; /* a reference */
    bool of_server;        /* modules may not set it */
    struct message *messages[N_VARIABLE_MESSAGES];
    struct block *value; /* encoded; NULL: never set */
    uint8_t order;       /* of value, enum byte_order */
};

/* The one of its messages that has this kind. */
static inline struct message *variable_message(const struct variable *variable,
                                               enum message_kind kind)
{
    return variable->messages[kind - MESSAGE_SET];
}

/* The variable of that name, or NULL. */
struct variable *variable_find(const struct server *server, const char *name);

/* Makes a variable of that format, whose reference stays the caller's; one that exists gets a new
 * format and loses its value.  NULL when there are too many, or a message is in the way. */
struct variable *variable_define(struct server *server, const char *name, struct format *format);

/* The same for one of the server's own, with the lines that the log has for it. */
struct variable *variable_define_own(struct server *server, const char *name, const char *text,
                                     struct format *format);

/* Frees all variables. */
void variable_free_all(struct server *server);

#endif
