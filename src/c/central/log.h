/*
 * The log: every line that the server writes about its work.
 *
 * There are two logs with the same vocabulary, the terminal and a file, each
 * with its own switches.  The exact text of every line is made here, because
 * log viewers and scripts read it.  A third log, of JSON, has the same content.
 * Nothing here waits: text gathers in sinks.
 */
#ifndef IPC_CENTRAL_LOG_H
#define IPC_CENTRAL_LOG_H

#include <stdbool.h>
#include <stdint.h>

#include "central/dispatch.h"
#include "central/options.h"
#include "central/sink.h"
#include "central/text.h"
#include "platform/process.h"

/* Both logs for people, so that what is done to one is done to the other, and the one for programs.
 */
enum which_log { LOG_TERMINAL, LOG_FILE, N_LOGS, LOG_JSON = N_LOGS };

struct log_file {
    struct sink sink;
    bool is_open;
    char *name; /* owned; of the file that is or was open */
};

struct log {
    const struct waker *waker; /* told when a file may take more; NULL: nobody is */
    struct options *options;   /* holds the switches of both logs */
    struct sink terminal;
    struct log_file file;
    struct log_file json;
    bool closed;      /* nothing is written any more */
    int64_t start;    /* seconds since 1970: a generated name holds them */
    bool messages_on; /* some log shows message lines: see log_switched */
    bool data_on;
    bool summary_on;
    const struct format_names *names; /* to read the formats of messages with */
    void (*clock)(struct local_time *time);
    struct buffer line;   /* scratch, like the next two */
    struct buffer value;  /* printed data */
    struct buffer object; /* a line of JSON */
};

/* terminal_fd -1: the terminal's text only gathers. */
void log_init(struct log *log, struct options *options, int terminal_fd);
void log_fini(struct log *log);

/* Writes what waits; from here on nothing is written any more. */
void log_close(struct log *log);

/* Has to be called after the options were changed. */
void log_switched(struct log *log);

/* Whether the switches of LOG_FILE or LOG_JSON ask for one. */
bool log_wants_file(const struct log *log, enum which_log which);

/* Opens the file of the options' name, or of a generated one: 0 or ERR_IO, which is said on standard
 * error.  What is in it goes, unless this log has written it. */
int log_open_file(struct log *log, enum which_log which);

/* Writes what waits and closes the file. */
void log_close_file(struct log *log, enum which_log which);

/* Closes all files, with more patience: nothing follows. */
void log_end_files(struct log *log);

/* Starts new files of the same names where the old ones were moved away. */
void log_reopen_files(struct log *log);

/* Lets leave what the files take, and starts a new one where an old one has its size. */
void log_flush_files(struct log *log);

/* Lets leave what the streams take; says on standard error when a log file has failed. */
void log_flush(struct log *log);

/* ------------------------------------------------------- lines of any class */

/* To both logs, whatever the switches. */
void log_always(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class. */
void log_status(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class: a message is defined anew.  Logs that ignore leave it out. */
void log_redefined(struct log *log, const struct message *message);

/* Message class, but about no dispatch. */
void log_notice(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class: something that a module did is ignored, or ends its connection. */
void log_warning(struct log *log, const struct module *module, const char *format, ...)
    LIKE_PRINTF(3, 4);

/* Terminal only, not when silent: banner, prompt, answers to commands. */
void log_terminal(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* File only. */
void log_file(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* To both logs: a question.  On the terminal its answer stands in the same line. */
void log_question(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* ----------------------------------------------------- the life of a dispatch */

/* The lines themselves; what follows asks first whether any log shows message lines. */
void log_write_sent(struct log *log, struct dispatch *dispatch, const char *receiver);
void log_write_queued(struct log *log, const struct dispatch *dispatch, const char *resource);
void log_write_released(struct log *log, struct dispatch *dispatch);
void log_write_done(struct log *log, const struct dispatch *dispatch);

/* Sent at once. */
static inline void log_sent(struct log *log, struct dispatch *dispatch, const char *receiver)
{
    if (log->messages_on) {
        log_write_sent(log, dispatch, receiver);
    }
}

/* Queued for a resource, or standing in for a handler under the message's name. */
static inline void log_queued(struct log *log, const struct dispatch *dispatch,
                              const char *resource)
{
    if (log->messages_on) {
        log_write_queued(log, dispatch, resource);
    }
}

/* Sent from the queue of its resource. */
static inline void log_released(struct log *log, struct dispatch *dispatch)
{
    if (log->messages_on) {
        log_write_released(log, dispatch);
    }
}

static inline void log_done(struct log *log, const struct dispatch *dispatch)
{
    if (log->messages_on) {
        log_write_done(log, dispatch);
    }
}

/* A request to lock or reserve has to wait. */
void log_request_waits(struct log *log, const struct dispatch *dispatch);

void log_failed(struct log *log, const struct dispatch *dispatch, const char *reason, int length);

/* Data of a reply: in the format of a message (a response), or in one of its own. */
struct log_reply {
    const char *replier;
    const uint8_t *data;
    size_t length;
    enum byte_order order;
    struct message *message; /* NULL: format says it */
    const struct format *format;
};

void log_replied(struct log *log, const struct dispatch *dispatch, const struct log_reply *reply);

/* Dropped, because as many wait as may. */
void log_limited(struct log *log, const struct dispatch *dispatch);

/* Given up, because its module has ended. */
void log_cleared(struct log *log, const struct dispatch *dispatch);

/* Handed from the stand-in of its message to a resource. */
void log_transferred(struct log *log, const struct dispatch *dispatch,
                     const struct resource *resource);

/* Handled-time summary of one message. */
struct log_summary {
    uint64_t count;
    double message_share; /* of the working time before, in percent */
    uint64_t bytes;
    uint64_t milliseconds;
    uint64_t average_bytes;
    uint64_t average_milliseconds;
};

void log_summarise(struct log *log, const struct log_summary *summary);

#endif
