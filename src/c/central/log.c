/*
 * The two logs: where they go, and lines that are the same in both.
 */
#include "central/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/log_json.h"
#include "central/log_output.h"
#include "central/version.h"

const struct log_switches *log_switches_of(const struct log *log, enum which_log which)
{
    const struct options *options = log->options;
    return which == LOG_TERMINAL ? &options->terminal
           : which == LOG_FILE   ? &options->file
                                 : &options->json;
}

struct log_file *log_file_of(struct log *log, enum which_log which)
{
    return which == LOG_FILE ? &log->file : &log->json;
}

static struct sink *sink_of(struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->terminal : &log_file_of(log, which)->sink;
}

bool log_is_open(const struct log *log, enum which_log which)
{
    const bool is_open = which == LOG_TERMINAL ? !log->options->silent
                         : which == LOG_FILE   ? log->file.is_open
                                               : log->json.is_open;
    return is_open && !log->closed;
}

/* ---------------------------------------------------------------- life cycle */

void log_init(struct log *log, struct options *options, int terminal_fd)
{
    struct local_time now;
    memset(log, 0, sizeof *log);
    log->options = options;
    log->clock = clock_local;
    clock_local(&now);
    log->start = now.epoch;
    sink_init(&log->terminal, terminal_fd);
    sink_init(&log->file.sink, -1);
    sink_init(&log->json.sink, -1);
    buffer_init(&log->line);
    buffer_init(&log->value);
    buffer_init(&log->object);
    log_switched(log);
}

void log_close(struct log *log)
{
    (void)sink_flush(&log->terminal); /* what a blocked terminal does not take is lost */
    log_end_files(log);
    log->closed = true;
    log_switched(log);
}

void log_fini(struct log *log)
{
    log_close(log);
    sink_fini(&log->terminal);
    buffer_fini(&log->line);
    buffer_fini(&log->value);
    buffer_fini(&log->object);
    free(log->file.name);
    free(log->json.name);
}

void log_switched(struct log *log)
{
    log->messages_on = false;
    log->data_on = false;
    log->summary_on = false;
    for (enum which_log which = LOG_TERMINAL; which <= LOG_JSON; which++) {
        if (log_is_open(log, which)) {
            log->messages_on |= log_switches_of(log, which)->messages;
            log->data_on |= log_switches_of(log, which)->data;
            log->summary_on |= log_switches_of(log, which)->summary;
        }
    }
}

void log_flush(struct log *log)
{
    log_flush_files(log); /* first, so that what the terminal shows is in the file */
    if (sink_flush(&log->terminal) < 0) {
        log_switched(log); /* the reader has gone: nobody minds */
    }
}

/* ------------------------------------------------------------ whole lines */

void log_put_text(struct log *log, enum which_log which, const struct buffer *text)
{
    const uint8_t *bytes = text->bytes;
    size_t length = text->length;
    while (which == LOG_FILE && length > 1 && (*bytes == '\n' || *bytes == '\a')) {
        bytes++;
        length--;
    }
    sink_put(sink_of(log, which), bytes, length);
}

void log_put_line(struct log *log, enum which_log which)
{
    log_put_text(log, which, &log->line);
}

/* Starts a line anew. */
static void write_line(struct log *log, const char *format, va_list arguments)
{
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
}

/* Kinds of lines: what JSON calls them, and whether a log with these switches shows them. */
struct kind_of_line {
    const char *name;
    bool (*is_shown)(const struct log_switches *on);
};

static bool always(const struct log_switches *on)
{
    (void)on;
    return true;
}

static bool with_status(const struct log_switches *on)
{
    return on->status;
}

static bool with_registrations(const struct log_switches *on)
{
    return on->status && !on->ignore;
}

static bool with_messages(const struct log_switches *on)
{
    return on->messages;
}

static bool with_summary(const struct log_switches *on)
{
    return on->summary;
}

static const struct kind_of_line of_everything = {"always", always};
static const struct kind_of_line of_status = {"status", with_status};
static const struct kind_of_line of_registrations = {"status", with_registrations};
static const struct kind_of_line of_messages = {"messages", with_messages};
static const struct kind_of_line of_summary = {"summary", with_summary};

/* Puts the line into the logs that show its kind. */
static void put_where_shown(struct log *log, const struct kind_of_line *kind)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (log_is_open(log, which) && kind->is_shown(log_switches_of(log, which))) {
            log_put_line(log, which);
        }
    }
    if (log_is_open(log, LOG_JSON) && kind->is_shown(&log->options->json)) {
        log_json_text(log, kind->name, log->line.bytes, log->line.length);
    }
}

void log_always(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, &of_everything);
}

void log_status(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, &of_status);
}

void log_warning(struct log *log, const struct module *module, const char *format, ...)
{
    va_list arguments;
    buffer_clear(&log->line);
    text_append(&log->line, "WARNING: %s on %s: ", module->name, module->host);
    va_start(arguments, format);
    text_append_list(&log->line, format, arguments);
    va_end(arguments);
    text_append(&log->line, "\n");
    put_where_shown(log, &of_status);
}

void log_redefined(struct log *log, const struct message *message)
{
    buffer_clear(&log->line);
    text_append(&log->line, "Registration: Message %s Found. Updating.\n", message->name);
    put_where_shown(log, &of_registrations);
}

void log_notice(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, &of_messages);
}

void log_terminal(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    if (log_is_open(log, LOG_TERMINAL)) {
        log_put_line(log, LOG_TERMINAL);
    }
}

void log_file(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    if (log_is_open(log, LOG_FILE)) {
        sink_put(&log->file.sink, log->line.bytes,
                 log->line.length); /* as it is, empty lines too */
    }
}

void log_question(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    if (log_is_open(log, LOG_TERMINAL)) {
        log_put_line(log, LOG_TERMINAL);
    }
    if (log_is_open(log, LOG_FILE)) {
        text_append(&log->line, "\n");
        log_put_line(log, LOG_FILE);
    }
    if (log_is_open(log, LOG_JSON)) {
        log_json_text(log, "always", log->line.bytes, log->line.length);
    }
}

void log_summarise(struct log *log, const struct log_summary *summary)
{
    buffer_clear(&log->line);
    text_append(&log->line,
                "%5" PRIu64 ": Msg: %.2f%%, Mon: 0.00%%, Wait %.2f%%, Msg: (%" PRIu64 ", %" PRIu64
                ") Ave: (%" PRIu64 ", %" PRIu64 ")\n",
                summary->count, summary->message_share,
                summary->count > 1 ? 100.0 - summary->message_share : 0.0, summary->bytes,
                summary->milliseconds, summary->average_bytes, summary->average_milliseconds);
    put_where_shown(log, &of_summary);
}
