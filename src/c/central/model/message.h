/*
 * Message registry.
 *
 * Knows every message name that was ever used: by a definition, a subscription,
 * a priority, an option.  A name that nobody has defined yet has no number and
 * no formats.  Messages are never removed; their numbers are never reused.
 *
 * Formats are kept as text and parsed when somebody asks for them, because the
 * named formats that they use may be defined in any order before.
 */
#ifndef IPC_CENTRAL_MESSAGE_H
#define IPC_CENTRAL_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/list.h"
#include "base/table.h"
#include "central/model/meter.h"
#include "central/model/pending.h"
#include "format/names.h"
#include "wire/catalogue.h"

enum message_kind {
    MESSAGE_USER,    /* defined by modules, handled by modules */
    MESSAGE_SERVICE, /* a request or notice to the server */
    MESSAGE_NOTICE,  /* published by the server, subscribed to by modules */
    MESSAGE_SET,     /* the four messages of a variable */
    MESSAGE_GET,
    MESSAGE_GET_SET,
    MESSAGE_WATCH /* published by the server, too */
};

struct variable;
struct dispatch;

struct message {
    char *name; /* owned; spelling of the latest definition */
    enum message_kind kind;
    int id;                       /* 0: not defined */
    int class;                    /* enum frame_class */
    enum library_message service; /* of services and notices */
    struct variable *variable;    /* of MESSAGE_SET to MESSAGE_WATCH */

    char *definer;   /* owned; the module that has defined it last, as the log names it */
    char *wire_text; /* owned, NULL: none */
    char *content_text;
    struct format *wire;    /* of the frame's data; references */
    struct format *content; /* user messages: the user's format; requests: format of the reply */
    bool parsed;            /* wire and content say what the texts say */
    bool bad_is_logged;     /* ... or do not, which the log has said */

    uint8_t *label; /* class data of every delivery: the name, encoded in this host's order */
    uint32_t label_length;

    bool has_lost_handlers;         /* with a module that is just ending */
    struct pending_subject subject; /* its priority, and where it waits */
    struct list subscriptions;      /* of struct subscription, oldest first */
    size_t n_subscriptions;
    struct list waiting; /* queries that nobody handles yet: struct dispatch, oldest first */
    size_t n_waiting;
    uint64_t waiting_bytes;

    struct meter published;
    uint64_t delivered;
    uint64_t dropped; /* deliveries given up because a queue was full */

    bool direct;               /* modules deliver it to each other */
    bool ignored;              /* left out by logs that ignore */
    bool handlers_wanted;      /* its list of handlers is to be kept as a variable */
    struct variable *handlers; /* that variable, once it exists */
    bool listed;               /* stands in the list of active broadcasts */
    struct list in_broadcasts;
    struct list taps; /* of struct tap_entry */
};

struct message_registry {
    struct table names; /* -> struct message */
    struct message **by_id;
    int n_ids; /* numbers below it are given out, from FIRST_MESSAGE_ID on */
    int room;
};

/* 0 would have no sign to turn, and 1 would become the number that means none. */
enum { FIRST_MESSAGE_ID = 2 };

void message_registry_init(struct message_registry *registry);
void message_registry_fini(struct message_registry *registry);

/* The message of that name, or NULL. */
struct message *message_find(const struct message_registry *registry, const char *name);

/* The same, known by name only if it is new; NULL when there are too many. */
struct message *message_get(struct message_registry *registry, const char *name);

/* The defined message of that number, or NULL. */
static inline struct message *message_by_id(const struct message_registry *registry, int64_t id)
{
    return id >= FIRST_MESSAGE_ID && id < registry->n_ids ? registry->by_id[id] : NULL;
}

struct message_definition_texts {
    const char *definer;
    int class;
    const char *wire; /* NULL: none */
    const char *content;
};

/* Defines a message, or defines it anew: it keeps its number, gets the spelling and the rest. */
void message_define(struct message_registry *registry, struct message *message, const char *name,
                    const struct message_definition_texts *texts);

/* Defines a message of the server itself, whose formats are compiled already (references stay the
 * caller's). */
void message_define_internal(struct message_registry *registry, struct message *message,
                             enum message_kind kind, int class, struct format *wire,
                             struct format *content);

/* The format of a text, in whatever notation: a reference, NULL for none, the bad one if it is
 * illegal. */
struct format *message_parse_text(const char *text, const struct format_names *names);

/* Parses the formats unless that is done: 0, or ERR_FORMAT when one is bad now (it is then tried
 * again the next time). */
int message_parse(struct message *message, const struct format_names *names);

static inline bool message_is_defined(const struct message *message)
{
    return message->id != 0;
}

/* Whether modules may define it and decide who handles it. */
static inline bool message_is_internal(const struct message *message)
{
    return message->kind != MESSAGE_USER;
}

/* Whether modules may subscribe to it. */
static inline bool message_is_open(const struct message *message)
{
    return message->kind == MESSAGE_USER || message->kind == MESSAGE_NOTICE ||
           message->kind == MESSAGE_WATCH;
}

#endif
