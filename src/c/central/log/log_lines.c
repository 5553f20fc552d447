/*
 * Lines that are the same in both logs for people.
 */
#include "central/log/log_lines.h"

#include <inttypes.h>

#include "central/log/log_json.h"

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
