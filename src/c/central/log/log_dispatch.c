/*
 * The lines of the log about dispatches, with the parts that each log wants.
 */
#include "central/log/log_dispatch.h"

#include <inttypes.h>
#include <stdlib.h>

#include "central/log/log_json.h"
#include "central/settings/version.h"

enum { DATA_INDENT = 4 };

/* ------------------------------------------------------------ parts of lines */

struct stamp {
    bool taken; /* one reading of the clock serves both logs */
    struct local_time time;
};

static bool shows(const struct log *log, enum which_log which, const struct message *message)
{
    const struct log_switches *on = log_switches_of(log, which);
    return log_is_open(log, which) && on->messages && !(on->ignore && message->ignored);
}

static void add_reference(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    if (log_switches_of(log, which)->references) {
        text_append(&log->line, " {%" PRIu32 "}", dispatch->id);
    }
}

static void add_parent(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    if (log_switches_of(log, which)->parents) {
        text_append(&log->line, " {%" PRId32 "}", dispatch->parent);
    }
}

/* Ends the line, with the time where wanted, and puts it into the log. */
static void end_line(struct log *log, enum which_log which, struct stamp *stamp)
{
    if (log_switches_of(log, which)->time) {
        if (!stamp->taken) {
            log->clock(&stamp->time);
            stamp->taken = true;
        }
        const struct local_time *time = &stamp->time;
        text_append(&log->line, "%3d:%02d:%02d.%02d", time->hour, time->minute, time->second,
                    time->hundredths);
    }
    text_append(&log->line, "\n");
    log_put_line(log, which);
}

/* Class, message and reference: the beginning of every line about a dispatch under way. */
static void begin_line(struct log *log, enum which_log which, const struct dispatch *dispatch)
{
    buffer_clear(&log->line);
    text_append(&log->line, "%-9s %15s", log_class_name(dispatch->class), dispatch->message->name);
    add_reference(log, which, dispatch);
}

/* The same, and who sent it. */
static void begin_line_from(struct log *log, enum which_log which, const struct dispatch *dispatch)
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
static void add_message_value(struct log *log, struct message *message, struct format_source source)
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
    add_value(&log->value, format, &source);
}

/* Puts log->value into the logs that show data and this message. */
static void put_data(struct log *log, const struct message *message)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        const struct log_switches *on = log_switches_of(log, which);
        if (log_is_open(log, which) && on->data && !(on->ignore && message->ignored)) {
            log_put_text(log, which, &log->value);
        }
    }
}

/* Prints the data of a dispatch into log->value, which is empty if no log shows data, and puts it
 * into the logs for people. */
static void put_own_data(struct log *log, struct dispatch *dispatch)
{
    const struct format_source source = {dispatch->data, dispatch->data_length,
                                         (enum byte_order)dispatch->data_order};
    /* What was sent ahead before data were wanted has none any more. */
    const bool has_data = dispatch->data != NULL || dispatch->data_length == 0;
    buffer_clear(&log->value);
    if (log->data_on && has_data) {
        add_message_value(log, dispatch->message, source);
        put_data(log, dispatch->message);
    }
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
    put_own_data(log, dispatch);
    const struct log_step step = {.step = "sent",
                                  .dispatch = dispatch,
                                  .from = dispatch_sender_name(dispatch),
                                  .to = receiver,
                                  .bytes = &dispatch->data_length,
                                  .data = &log->value};
    log_json_step(log, &step);
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
    const struct log_step step = {.step = "queued",
                                  .dispatch = dispatch,
                                  .from = dispatch_sender_name(dispatch),
                                  .resource = resource};
    log_json_step(log, &step);
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
    const struct log_step step = {.step = "queued",
                                  .dispatch = dispatch,
                                  .from = dispatch_sender_name(dispatch),
                                  .to = SERVER_NAME};
    log_json_step(log, &step);
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
    put_own_data(log, dispatch);
    const struct log_step step = {.step = "released",
                                  .dispatch = dispatch,
                                  .from = dispatch_sender_name(dispatch),
                                  .to = dispatch->resource->owner->name,
                                  .resource = dispatch->resource->name,
                                  .bytes = &dispatch->data_length,
                                  .data = &log->value};
    log_json_step(log, &step);
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
    const struct log_step step = {.step = "done", .dispatch = dispatch};
    log_json_step(log, &step);
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
    const struct log_step step = {
        .step = "failed", .dispatch = dispatch, .reason = reason, .reason_length = length};
    log_json_step(log, &step);
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
    buffer_clear(&log->value);
    if (log->data_on) {
        const struct format_source source = {reply->data, reply->length, reply->order};
        if (reply->message != NULL) {
            add_message_value(log, reply->message, source);
        } else {
            add_value(&log->value, reply->format, &source);
        }
        put_data(log, dispatch->message);
    }
    const uint32_t bytes = (uint32_t)reply->length;
    const struct log_step step = {.step = "replied",
                                  .dispatch = dispatch,
                                  .from = reply->replier,
                                  .to = dispatch_sender_name(dispatch),
                                  .bytes = &bytes,
                                  .data = &log->value};
    log_json_step(log, &step);
}

void log_limited(struct log *log, const struct dispatch *dispatch)
{
    struct stamp stamp = {.taken = false};
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        const struct log_switches *on = log_switches_of(log, which);
        if (log_is_open(log, which) && on->status && !(on->ignore && dispatch->message->ignored)) {
            buffer_clear(&log->line);
            text_append(&log->line, "PENDING LIMIT: Deleted message %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            end_line(log, which, &stamp);
        }
    }
    const struct log_step step = {.step = "dropped", .dispatch = dispatch};
    log_json_step(log, &step);
}

void log_cleared(struct log *log, const struct dispatch *dispatch)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (log_is_open(log, which)) {
            buffer_clear(&log->line);
            text_append(&log->line, "Clearing handler for message %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            text_append(&log->line, "\n");
            log_put_line(log, which);
        }
    }
    const struct log_step step = {.step = "cleared", .dispatch = dispatch};
    log_json_step(log, &step);
}

void log_transferred(struct log *log, const struct dispatch *dispatch,
                     const struct resource *resource)
{
    for (enum which_log which = LOG_TERMINAL; which < N_LOGS; which++) {
        if (log_is_open(log, which) && log_switches_of(log, which)->status) {
            buffer_clear(&log->line);
            text_append(&log->line, "   Transferring %s", dispatch->message->name);
            add_reference(log, which, dispatch);
            /* Both names are the new resource's, as viewers know it. */
            text_append(&log->line, " from Resource %s to %s\n", resource->name, resource->name);
            log_put_line(log, which);
        }
    }
    const struct log_step step = {
        .step = "transferred", .dispatch = dispatch, .resource = resource->name};
    log_json_step(log, &step);
}
