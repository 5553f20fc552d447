/*
 * The log for programs.
 */
#include "central/log/log_json.h"

#include <inttypes.h>
#include <string.h>

#include "central/log/log_output.h"

/* -------------------------------------------------------------------- objects */

static void begin_object(struct buffer *out)
{
    char time[CLOCK_UTC_SIZE];
    clock_utc(time);
    buffer_clear(out);
    text_append(out, "{\"time\":\"%s\"", time);
}

/* Puts the line into the log. */
static void end_object(struct log *log)
{
    text_append(&log->object, "}\n");
    sink_put(&log->json.sink, log->object.bytes, log->object.length);
}

/* How many bytes a sequence of UTF-8 has by its first one; 0: it begins none. */
static size_t announced_length(uint8_t first)
{
    if (first < 0x80) {
        return 1;
    }
    if (first < 0xC2 || first > 0xF4) {
        return 0;
    }
    return first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

/* How many bytes the sequence has that stands here; 0: it is not well-formed. */
static size_t sequence_length(const uint8_t *at, size_t left)
{
    const size_t length = announced_length(*at);
    if (length == 0 || length > left) {
        return 0;
    }
    for (size_t i = 1; i < length; i++) {
        if ((at[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    const bool is_surrogate = at[0] == 0xED && at[1] >= 0xA0;
    const bool is_too_long = (at[0] == 0xE0 && at[1] < 0xA0) || (at[0] == 0xF0 && at[1] < 0x90);
    const bool is_too_high = at[0] == 0xF4 && at[1] >= 0x90;
    return length > 2 && (is_surrogate || is_too_long || is_too_high) ? 0 : length;
}

/* Appends a string; bytes that are no UTF-8 appear as the characters of their numbers. */
static void add_string(struct buffer *out, const uint8_t *text, size_t length)
{
    text_append(out, "\"");
    for (size_t at = 0; at < length;) {
        const size_t sequence = sequence_length(text + at, length - at);
        if (text[at] == '"' || text[at] == '\\') {
            text_append(out, "\\%c", text[at]);
        } else if (text[at] < ' ' || sequence == 0) {
            text_append(out, "\\u%04x", text[at]);
        } else {
            (void)buffer_append(out, text + at, sequence); /* without memory the line suffers */
        }
        at += sequence == 0 ? 1 : sequence;
    }
    text_append(out, "\"");
}

static void add_bytes(struct buffer *out, const char *key, const void *text, size_t length)
{
    text_append(out, ",\"%s\":", key);
    add_string(out, text, length);
}

static void add_text(struct buffer *out, const char *key, const char *text)
{
    if (text != NULL) {
        add_bytes(out, key, text, strlen(text));
    }
}

/* Appends text without white space around it, which only serves the layout of the other logs. */
static void add_trimmed(struct buffer *out, const char *key, const char *text, size_t length)
{
    while (length > 0 && strchr(" \n\a", text[length - 1]) != NULL) {
        length--;
    }
    while (length > 0 && strchr(" \n\a", *text) != NULL) {
        text++;
        length--;
    }
    add_bytes(out, key, text, length);
}

/* ---------------------------------------------------------------------- lines */

void log_json_step(struct log *log, const struct log_step *step)
{
    struct buffer *out = &log->object;
    const struct dispatch *dispatch = step->dispatch;
    const struct log_switches *on = &log->options->json;
    if (!log_is_open(log, LOG_JSON) || !on->messages ||
        (on->ignore && dispatch->message->ignored)) {
        return;
    }
    begin_object(out);
    add_text(out, "step", step->step);
    add_text(out, "class", log_class_name(dispatch->class));
    add_text(out, "message", dispatch->message->name);
    text_append(out, ",\"number\":%" PRIu64 ",\"reference\":%" PRIu32 ",\"parent\":%" PRId32,
                dispatch->number, dispatch->id, dispatch->parent);
    add_text(out, "from", step->from);
    add_text(out, "to", step->to);
    add_text(out, "resource", step->resource);
    if (step->reason != NULL) {
        add_bytes(out, "reason", step->reason, (size_t)step->reason_length);
    }
    if (step->bytes != NULL) {
        text_append(out, ",\"bytes\":%" PRIu32, *step->bytes);
    }
    if (step->data != NULL && step->data->length > 0 && on->data) {
        add_trimmed(out, "data", (const char *)step->data->bytes, step->data->length);
    }
    end_object(log);
}

void log_json_text(struct log *log, const char *kind, const void *text, size_t length)
{
    begin_object(&log->object);
    add_text(&log->object, "kind", kind);
    add_trimmed(&log->object, "text", text, length);
    end_object(log);
}
