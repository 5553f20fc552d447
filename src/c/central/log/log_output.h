/*
 * The state of the log, and its three outputs as the files that write lines see them.
 *
 * Two logs for people, the terminal and a file, each with its own switches, and one of
 * JSON for programs.  Nothing here waits: text gathers in sinks.
 */
#ifndef IPC_CENTRAL_LOG_OUTPUT_H
#define IPC_CENTRAL_LOG_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"
#include "central/log/sink.h"
#include "central/model/dispatch.h"
#include "central/settings/options.h"
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

/* Has to be called after the options were changed. */
void log_switched(struct log *log);

const struct log_switches *log_switches_of(const struct log *log, enum which_log which);

/* Whether lines of any kind go there. */
bool log_is_open(const struct log *log, enum which_log which);

/* Puts a text, or log->line, into one log.  Bells and empty lines in front are for people only: a
 * file gets none. */
void log_put_text(struct log *log, enum which_log which, const struct buffer *text);
void log_put_line(struct log *log, enum which_log which);

/* Class of a message as the logs name it. */
const char *log_class_name(uint16_t class);

/* The file of LOG_FILE or LOG_JSON. */
struct log_file *log_file_of(struct log *log, enum which_log which);

#endif
