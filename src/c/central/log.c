/*
 * The lines of the log.
 */
#include "central/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/version.h"

enum { DATA_INDENT = 4 };

/* Both logs, so that what is done to one is done to the other. */
enum which_log { LOG_TERMINAL, LOG_FILE, N_LOGS };

static const struct log_switches *switches_of(const struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->options->terminal : &log->options->file;
}

static struct sink *sink_of(struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->terminal : &log->file;
}

static bool is_open(const struct log *log, enum which_log which)
{
    return !log->closed && (which == LOG_TERMINAL ? !log->options->silent : log->file_is_open);
}

/* ---------------------------------------------------------------- life cycle */

void log_init(struct log *log, struct options *options, int terminal_fd)
{
    memset(log, 0, sizeof *log);
    log->options = options;
    log->clock = clock_local;
    sink_init(&log->terminal, terminal_fd);
    sink_init(&log->file, -1);
    buffer_init(&log->line);
    log_switched(log);
}

static void close_file(struct log *log)
{
    if (log->file_is_open) {
        (void)sink_flush(&log->file); /* what a failing file does not take is lost */
        stream_close(log->file.fd);
        log->file_is_open = false;
    }
    sink_fini(&log->file);
    sink_init(&log->file, -1);
}

void log_close(struct log *log)
{
    (void)sink_flush(&log->terminal); /* what a blocked terminal does not take is lost */
    close_file(log);
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
        if (is_open(log, which)) {
            log->messages_on |= switches_of(log, which)->messages;
            log->data_on |= switches_of(log, which)->data;
            log->summary_on |= switches_of(log, which)->summary;
        }
    }
}

bool log_wants_file(const struct log *log)
{
    const struct log_switches *on = &log->options->file;
    return on->messages || on->status || on->data || on->time || on->summary;
}

static void write_header(struct log *log)
{
    static const char *const weekdays[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    static const char *const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    struct local_time now;
    log->clock(&now);
    buffer_clear(&log->line);
    text_append(&log->line, "Logging " SERVER_BANNER " on %s %s %2d %02d:%02d:%02d %d\n",
                weekdays[now.weekday], months[now.month - 1], now.day, now.hour, now.minute,
                now.second, now.year);
    sink_put(&log->file, log->line.bytes, log->line.length);
}

/* Opens the file of log->file_name. */
static int open_file(struct log *log, bool append)
{
    int fd;
    if (stream_open(log->file_name, append, &fd) != 0) {
        return ERR_IO;
    }
    sink_init(&log->file, fd);
    log->file_is_open = true;
    log_switched(log);
    return 0;
}

int log_open_file(struct log *log)
{
    struct local_time now;
    log->clock(&now);
    free(log->file_name);
    if (log->options->file_name != NULL) {
        log->file_name = mem_copy_string(log->options->file_name);
    } else {
        char generated[64];
        (void)snprintf(generated, sizeof generated, "x_ipc.log.%" PRId64, now.epoch);
        log->file_name = mem_copy_string(generated);
    }
    const int error = open_file(log, false);
    if (error == 0) {
        log_terminal(log, "Logging to %s;\n", log->file_name);
        write_header(log);
    }
    return error;
}

int log_reopen_file(struct log *log)
{
    if (!log->file_is_open) {
        return 0;
    }
    close_file(log);
    const int error = open_file(log, true);
    log_switched(log);
    return error;
}

void log_flush(struct log *log)
{
    if (sink_flush(&log->terminal) < 0) {
        log_switched(log); /* the reader has gone: nobody minds */
    }
    const bool lazy = !log->options->file.flush && sink_waiting(&log->file) < BUFSIZ;
    if (log->file_is_open && !lazy && sink_flush(&log->file) < 0) {
        (void)fprintf(stderr, "ERROR: Can not write file %s.\n", log->file_name);
        close_file(log);
        log_switched(log);
    }
}

/* ------------------------------------------------------------ whole lines */

/* Puts log->line into one log.  Bells and empty lines in front are for people only. */
static void put_line(struct log *log, enum which_log which)
{
    const uint8_t *text = log->line.bytes;
    size_t length = log->line.length;
    while (which == LOG_FILE && length > 1 && (*text == '\n' || *text == '\a')) {
        text++;
        length--;
    }
    sink_put(sink_of(log, which), text, length);
}

void log_always(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
    va_end(arguments);
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which)) {
            put_line(log, which);
        }
    }
}

static void put_status(struct log *log)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which) && switches_of(log, which)->status) {
            put_line(log, which);
        }
    }
}

void log_status(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
    va_end(arguments);
    put_status(log);
}

void log_warning(struct log *log, const struct module *module, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buffer_clear(&log->line);
    text_append(&log->line, "WARNING: %s on %s: ", module->name, module->host);
    text_append_list(&log->line, format, arguments);
    text_append(&log->line, "\n");
    va_end(arguments);
    put_status(log);
}

void log_redefined(struct log *log, const struct message *message)
{
    buffer_clear(&log->line);
    text_append(&log->line, "Registration: Message %s Found. Updating.\n", message->name);
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        const struct log_switches *on = switches_of(log, which);
        if (is_open(log, which) && on->status && !on->ignore) {
            put_line(log, which);
        }
    }
}

void log_notice(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
    va_end(arguments);
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which) && switches_of(log, which)->messages) {
            put_line(log, which);
        }
    }
}

void log_terminal(struct log *log, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buffer_clear(&log->line);
    text_append_list(&log->line, format, arguments);
    va_end(arguments);
    if (is_open(log, LOG_TERMINAL)) {
        put_line(log, LOG_TERMINAL);
    }
}

/* ------------------------------------------------------------ parts of lines */

struct stamp {
    bool taken; /* one reading of the clock serves both logs */
    struct local_time time;
};

static bool shows(const struct log *log, enum which_log which, const struct message *message)
{
    const struct log_switches *on = switches_of(log, which);
    return is_open(log, which) && on->messages && !(on->ignore && message->ignored);
}

static void add_reference(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    if (switches_of(log, which)->references) {
        text_append(&log->line, " {%" PRIu32 "}", dispatch->id);
    }
}

static void add_parent(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    if (switches_of(log, which)->parents) {
        text_append(&log->line, " {%" PRId32 "}", dispatch->parent);
    }
}

/* Ends the line, with the time where wanted, and puts it into the log. */
static void end_line(struct log *log, enum which_log which, struct stamp *stamp)
{
    if (switches_of(log, which)->time) {
        if (!stamp->taken) {
            log->clock(&stamp->time);
            stamp->taken = true;
        }
        const struct local_time *time = &stamp->time;
        text_append(&log->line, "%3d:%02d:%02d.%02d", time->hour, time->minute, time->second,
                    time->hundredths);
    }
    text_append(&log->line, "\n");
    put_line(log, which);
}

static const char *class_name(uint16_t class)
{
    switch (class) {
    case CLASS_QUERY:
        return "Query";
    case CLASS_INFORM:
        return "Inform";
    case CLASS_BROADCAST:
        return "Broadcast";
    default:
        return "UNKNOWN CLASS";
    }
}

/* Class, message and reference: the beginning of every line about a dispatch under way. */
static void begin_line(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    buffer_clear(&log->line);
    text_append(&log->line, "%-9s %15s", class_name(dispatch->class), dispatch->message->name);
    add_reference(log, which, dispatch);
}

/* The same, and who sent it. */
static void begin_line_from(struct log *log, enum which_log which,
                            const struct dispatch *dispatch)
{
    begin_line(log, which, dispatch);
    text_append(&log->line, ": %10s", dispatch_sender_name(dispatch));
    add_parent(log, which, dispatch);
}

/* --------------------------------------------------------------------- data */

/* Appends the printed value of some bytes, or what is the matter with them. */
static void add_value(struct buffer *out, const struct format *format,
                      const struct format_source *source)
{
    void *value = NULL;
    if (format == NULL) {
        return;
    }
    if (source->length == 0) {
        text_append(out, "    NO DATA\n");
        return;
    }
    if (format_is_bad(format) || format_decode_new(format, source, &value, NULL) != 0) {
        text_append(out, "    Bad Format\n");
        return;
    }
    if (format_print(format, value, DATA_INDENT, out) != 0) {
        text_append(out, "    Bad Format\n");
    }
    (void)format_release(format, value); /* fails for illegal formats only */
    free(value);
}

/* Whether the user's value stands behind two lengths, as in all messages of variable length. */
static bool is_wrapped(const struct message *message)
{
    static const char variable[] = "{int,<byte:1>}";
    size_t matched = 0;
    if (message->wire_text == NULL) {
        return false;
    }
    for (const char *at = message->wire_text; *at != '\0'; at++) {
        if (*at == ' ') {
            continue;
        }
        if (*at != variable[matched]) { /* its NUL matches nothing */
            return false;
        }
        matched++;
    }
    return variable[matched] == '\0';
}

enum { WRAPPING = 8 };

/* Appends the value of a user message's or a request's data. */
static void add_message_value(struct log *log, struct message *message,
                              struct format_source source)
{
    (void)message_parse(message, log->names); /* a bad format prints as such */
    const struct format *format = message->wire;
    if (message->kind == MESSAGE_USER && message->content != NULL) {
        format = message->content;
        if (is_wrapped(message) && source.length >= WRAPPING) {
            source.bytes += WRAPPING;
            source.length -= WRAPPING;
        }
    }
    add_value(&log->line, format, &source);
}

/* Puts log->line into the logs that show data and this message. */
static void put_data(struct log *log, const struct message *message)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        const struct log_switches *on = switches_of(log, which);
        if (is_open(log, which) && on->data && !(on->ignore && message->ignored)) {
            put_line(log, which);
        }
    }
}

static void add_data(struct log *log, struct dispatch *dispatch)
{
    if (!log->data_on) {
        return;
    }
    const struct format_source source = {dispatch->data, dispatch->data_length,
                                         (enum byte_order)dispatch->data_order};
    buffer_clear(&log->line);
    add_message_value(log, dispatch->message, source);
    put_data(log, dispatch->message);
}

/* ----------------------------------------------------- the life of a dispatch */

void log_write_sent(struct log *log, struct dispatch *dispatch, const char *receiver)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_line_from(log, which, dispatch);
            text_append(&log->line, " --> %-15s (Sent)", receiver);
            end_line(log, which, &stamp);
        }
    }
    add_data(log, dispatch);
}

void log_write_queued(struct log *log, const struct dispatch *dispatch, const char *resource)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_line_from(log, which, dispatch);
            text_append(&log->line, " --> Resource %-6s (Pending)", resource);
            end_line(log, which, &stamp);
        }
    }
}

void log_request_waits(struct log *log, const struct dispatch *dispatch)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; log->messages_on && which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_line_from(log, which, dispatch);
            text_append(&log->line, " --> %-15s (Pending)", SERVER_NAME);
            end_line(log, which, &stamp);
        }
    }
}

void log_write_released(struct log *log, struct dispatch *dispatch)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_line(log, which, dispatch);
            text_append(&log->line, ": Resource %s --> %-15s (Sent)", dispatch->resource->name,
                        dispatch->resource->owner->name);
            end_line(log, which, &stamp);
        }
    }
    add_data(log, dispatch);
}

/* How a dispatch ended (with the blanks up to the message's column), its message and reference. */
static void begin_end(struct log *log, enum which_log which, const char *how,
                      const struct dispatch *dispatch)
{
    buffer_clear(&log->line);
    text_append(&log->line, "%s%15s", how, dispatch->message->name);
    add_reference(log, which, dispatch);
}

void log_write_done(struct log *log, const struct dispatch *dispatch)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_end(log, which, "  Done    ", dispatch);
            text_append(&log->line, ":");
            end_line(log, which, &stamp);
        }
    }
}

void log_failed(struct log *log, const struct dispatch *dispatch, const char *reason, int length)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; log->messages_on && which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_end(log, which, "  Failure ", dispatch);
            text_append(&log->line, ": %.*s", length, reason);
            end_line(log, which, &stamp);
        }
    }
}

void log_replied(struct log *log, const struct dispatch *dispatch, const struct log_reply *reply)
{
    struct stamp stamp = {.taken = false};
    if (!log->messages_on) {
        return;
    }
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (shows(log, which, dispatch->message)) {
            begin_end(log, which, "  Reply  ", dispatch);
            text_append(&log->line, ": %10s --> %-15s", reply->replier,
                        dispatch_sender_name(dispatch));
            add_parent(log, which, dispatch);
            end_line(log, which, &stamp);
        }
    }
    if (log->data_on) {
        const struct format_source source = {reply->data, reply->length, reply->order};
        buffer_clear(&log->line);
        if (reply->message != NULL) {
            add_message_value(log, reply->message, source);
        } else {
            add_value(&log->line, reply->format, &source);
        }
        put_data(log, dispatch->message);
    }
}

void log_limited(struct log *log, const struct dispatch *dispatch)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        const struct log_switches *on = switches_of(log, which);
        if (is_open(log, which) && on->status && !(on->ignore && dispatch->message->ignored)) {
            buffer_clear(&log->line);
            text_append(&log->line, "PENDING LIMIT: Deleted message %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            end_line(log, which, &stamp);
        }
    }
}

void log_cleared(struct log *log, const struct dispatch *dispatch)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which)) {
            buffer_clear(&log->line);
            text_append(&log->line, "Clearing handler for message %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            text_append(&log->line, "\n");
            put_line(log, which);
        }
    }
}

void log_transferred(struct log *log, const struct dispatch *dispatch,
                     const struct resource *resource)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which) && switches_of(log, which)->status) {
            buffer_clear(&log->line);
            text_append(&log->line, "   Transferring %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            /* Both names are the new resource's, as viewers know it. */
            text_append(&log->line, " from Resource %s to %s\n", resource->name, resource->name);
            put_line(log, which);
        }
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
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (is_open(log, which) && switches_of(log, which)->summary) {
            put_line(log, which);
        }
    }
}
