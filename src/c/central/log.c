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
#include "central/log_output.h"
#include "central/version.h"

const struct log_switches *log_switches_of(const struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->options->terminal : &log->options->file;
}

static struct sink *sink_of(struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->terminal : &log->file;
}

bool log_is_open(const struct log *log, enum which_log which)
{
    return !log->closed && (which == LOG_TERMINAL ? !log->options->silent : log->file_is_open);
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
    sink_init(&log->file, -1);
    buffer_init(&log->line);
    log_switched(log);
}

void log_close(struct log *log)
{
    (void)sink_flush(&log->terminal); /* what a blocked terminal does not take is lost */
    log_close_file(log);
    log->closed = true;
    log_switched(log);
}

void log_fini(struct log *log)
{
    log_close(log);
    sink_fini(&log->terminal);
    buffer_fini(&log->line);
    free(log->file_name);
}

void log_switched(struct log *log)
{
    log->messages_on = false;
    log->data_on = false;
    log->summary_on = false;
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (log_is_open(log, which)) {
            log->messages_on |= log_switches_of(log, which)->messages;
            log->data_on |= log_switches_of(log, which)->data;
            log->summary_on |= log_switches_of(log, which)->summary;
        }
    }
}

void log_flush(struct log *log)
{
    if (sink_flush(&log->terminal) < 0) {
        log_switched(log); /* the reader has gone: nobody minds */
    }
    log_flush_file(log);
}

/* ------------------------------------------------------------ whole lines */

void log_put_line(struct log *log, enum which_log which)
{
    const uint8_t *text = log->line.bytes;
    size_t length = log->line.length;
    while (which == LOG_FILE && length > 1 && (*text == '\n' || *text == '\a')) {
        text++;
        length--;
    }
    sink_put(sink_of(log, which), text, length);
}

/* Starts a line anew. */
static void write_line(struct log *log, const char *format, va_list arguments)
{
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
}

/* Whether a log with these switches shows lines of a kind. */
typedef bool (*kind_of_line)(const struct log_switches *on);

static bool of_everything(const struct log_switches *on)
{
    (void)on;
    return true;
}

static bool of_status(const struct log_switches *on)
{
    return on->status;
}

static bool of_registrations(const struct log_switches *on)
{
    return on->status && !on->ignore;
}

static bool of_messages(const struct log_switches *on)
{
    return on->messages;
}

/* Puts the line into the logs that show its kind. */
static void put_where_shown(struct log *log, kind_of_line kind)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (log_is_open(log, which) && kind(log_switches_of(log, which))) {
            log_put_line(log, which);
        }
    }
}

void log_always(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, of_everything);
}

void log_status(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, of_status);
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
    put_where_shown(log, of_status);
}

void log_redefined(struct log *log, const struct message *message)
{
    buffer_clear(&log->line);
    text_append(&log->line, "Registration: Message %s Found. Updating.\n", message->name);
    put_where_shown(log, of_registrations);
}

void log_notice(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    write_line(log, format, arguments);
    va_end(arguments);
    put_where_shown(log, of_messages);
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
        sink_put(&log->file, log->line.bytes, log->line.length); /* as it is, empty lines too */
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
}
