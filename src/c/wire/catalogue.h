/*
 * The messages that library and central exchange about themselves.
 *
 * One table holds every name, class and format; one struct per payload shape
 * mirrors the format's C layout, so that the format compiler encodes and decodes
 * them like any user's data.
 */
#ifndef IPC_WIRE_CATALOGUE_H
#define IPC_WIRE_CATALOGUE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buffer.h"
#include "format/format.h"
#include "wire/frame.h"

/* Names, in the order of the table; the comment gives request -> reply. */
enum library_message {
    LM_MESSAGE_INFO,       /* message_info_request -> optional_message_info */
    LM_CLASS_INFO,         /* int -> optional_class_info */
    LM_INTRODUCTION,       /* introduction -> introduction_reply */
    LM_READY,              /* nothing -> int */
    LM_CLOSE,              /* nothing */
    LM_DEFINE_MESSAGE,     /* message_definition */
    LM_SUBSCRIBE,          /* subscription_notice */
    LM_UNSUBSCRIBE,        /* subscription_notice */
    LM_DEFINE_FORMAT,      /* two_names: format, text */
    LM_GET_FORMAT,         /* char * -> struct format * */
    LM_RESOURCE,           /* number_and_name: capacity, resource */
    LM_LIMIT_PENDING,      /* pending_limit */
    LM_PRIORITY,           /* name_and_number: message, priority */
    LM_IS_CONNECTED,       /* char * -> int */
    LM_HANDLERS,           /* char * -> handler_list */
    LM_WATCH_HANDLERS,     /* char * */
    LM_CONNECTED,          /* char *: broadcast of central */
    LM_DISCONNECTED,       /* char *: broadcast of central */
    LM_DIRECT_PORT,        /* number_and_name: port, module */
    LM_HANDLER_INFO,       /* two_names: message, handler -> two_names */
    LM_MESSAGES,           /* nothing -> name_list */
    LM_MESSAGE_DETAILS,    /* char * -> message_details */
    LM_DIRECT_INFO,        /* char * -> handler_address */
    LM_PROVIDES,           /* name_list */
    LM_REQUIRES,           /* name_list */
    LM_AVAILABLE,          /* nothing -> name_list */
    LM_IGNORE_LOGGING,     /* char * */
    LM_RESUME_LOGGING,     /* char * */
    LM_ADD_TO_RESOURCE,    /* two_names: handler, resource */
    LM_RESERVE,            /* char * -> int */
    LM_RESERVE_OF_MODULE,  /* two_names: module, resource -> int */
    LM_CANCEL_RESERVATION, /* int */
    LM_LOCK,               /* char * -> int */
    LM_LOCK_OF_MODULE,     /* two_names: module, resource -> int */
    LM_UNLOCK,             /* int */
    LM_TAP_MESSAGE,        /* tap */
    LM_REMOVE_TAP,         /* tap */
    LM_TAP_REFERENCE,      /* reference_tap */
    LM_FIND_TAPPED,        /* int -> reference_pointer */
    LM_REGISTER_VARIABLE,  /* two_names: variable, format text */
    LM_PROCESSES,          /* char *: module -> process_list; not known to CMU IPC */
    LM_COUNT
};

/* Prefixes of the four messages that every variable has. */
#define VARIABLE_SET "V_set_"
#define VARIABLE_GET "V_get_"
#define VARIABLE_GET_SET "V_get_set_"
#define VARIABLE_WATCH "V_watch_"

#define VARIABLE_BROADCASTS "X_IPC_BROADCAST_MSG_VAR"
#define VARIABLE_TAPPED "X_IPC_TAPPED_MSG_VAR"
#define VARIABLE_TERMINAL_LOG "CENTRAL_TERMINAL_LOG_VAR"
#define VARIABLE_FILE_LOG "CENTRAL_FILE_LOG_VAR"

#define FORMAT_NAME_LIST "{int, int, <string:2>}"
#define FORMAT_HANDLER_LIST "{int, <{int, int, int, int, string, string}:1>}"
#define FORMAT_LOG_OPTIONS "{*int, int, int, int, int, int, int, int, int, int, int, int}"

/*
 * Names of abilities.  No message has such a name: a library that asks central for
 * one in the handshake says by it that it has the ability.  Others never ask, and an
 * original central takes it for any unknown name.
 */
#define ABILITY_IN_ORDER "ipc_x_in_order" /* takes in everything in the order of arrival */
#define ABILITY_AHEAD "ipc_x_ahead" /* keeps to its capacity itself, so more may be sent ahead */

struct library_message_entry {
    const char *name;
    const char *alias;   /* older name of the same message; NULL: none */
    int class;           /* enum frame_class */
    const char *request; /* format of the data; NULL: none */
    const char *reply;   /* format of the answer; NULL: none */
    bool logged;         /* shown by logs that ignore internal messages */
};

extern const struct library_message_entry library_messages[LM_COUNT];

/* ------------------------------------------------------- payloads, by shape */

struct message_info_request {
    char *message;
    char *handler; /* NULL unless asked on behalf of a handler */
};

struct message_info {
    int id; /* 0: only subscribed to; negative: deliver directly */
    char *name;
    int class;              /* enum frame_class */
    struct format *wire;    /* of the frame's data */
    struct format *content; /* user messages: the user's format; requests: format of the reply */
};

struct optional_message_info {
    struct message_info *info; /* NULL: unknown */
};

struct class_info {
    int class;
    struct format *format;
};

struct optional_class_info {
    struct class_info *info;
};

struct introduction {
    char *module;
    char *host;
};

struct introduction_reply {
    int major;
    int minor;
    int direct;
};

struct message_definition {
    char *name;
    int class;
    char *wire;    /* format text, NULL: none */
    char *content; /* format text, NULL: none */
};

struct subscription_notice {
    int id;
    char *message;
    char *handler;
};

struct two_names {
    char *first;
    char *second;
};

struct number_and_name {
    int number;
    char *name;
};

struct name_and_number {
    char *name;
    int number;
};

struct pending_limit {
    char *message; /* NULL: the whole resource */
    char *resource;
    int limit;
};

struct name_list {
    int used;
    int room;
    char **names; /* room of them */
};

struct handler_address {
    int id; /* LM_DIRECT_INFO gives 0, 0, port, id instead */
    int zero_1;
    int zero_2;
    int port; /* -1: none */
    char *host;
    char *module;
};

struct handler_list {
    int count;
    struct handler_address *handlers;
};

struct message_details {
    char *name;
    char *wire;
    char *content;
    int class;
    char *resource;
    int n_handlers;
};

struct module_process {
    int process; /* 0: not known */
    int port;    /* from which it is connected, 0: not by TCP */
};

struct process_list {
    int count;
    struct module_process *processes;
};

struct tap {
    int condition;
    char *tapped;
    char *listening;
};

/* ------------------------------------------------------------------- codec */

/* The compiled formats of the table.  Owned by a server or by the library. */
struct catalogue {
    struct format *request[LM_COUNT]; /* NULL: no data */
    struct format *reply[LM_COUNT];
    struct format *name_list;
    struct format *handler_list;
    struct format *log_options;
};

/* Compiles the table: 0 or ERR_MEMORY. */
int catalogue_init(struct catalogue *catalogue);
void catalogue_fini(struct catalogue *catalogue);

/* The entry whose name or alias that is (ASCII case folded), or LM_COUNT. */
enum library_message catalogue_find(const char *name);

/*
 * Decodes a whole payload into value (zeroed first): 0 or ERR_CONTENT when bytes are
 * missing or left over, or ERR_MEMORY.  format NULL wants no bytes.  Release it
 * with format_release.
 */
int payload_decode(const struct format *format, const uint8_t *bytes, size_t length,
                   enum byte_order order, void *value);

/* Appends a payload in this host's order (nothing for format NULL): 0 or as format_encode. */
int payload_encode(const struct format *format, const void *value, struct buffer *out);

#endif
