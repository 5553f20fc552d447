/*
 * Conflicts: two modules that define a message differently.
 */
#include "central/routing/conflict.h"

#include <string.h>

#include "base/text.h"

enum { LONGEST_TEXT = 1000 }; /* of a format in the log */

/* A definition, as far as it can be understood now. */
struct meaning {
    struct format *wire; /* references; NULL: none */
    struct format *content;
    const char *text; /* of content */
};

static void understand(struct meaning *meaning, const struct server *server, const char *wire,
                       const char *content)
{
    meaning->wire = message_parse_text(wire, server->names);
    meaning->content = message_parse_text(content, server->names);
    meaning->text = content == NULL || content[0] == '\0' ? NULL : content;
}

static void forget(struct meaning *meaning)
{
    format_unref(meaning->wire);
    format_unref(meaning->content);
}

/* The wire format is that of a fixed number of bytes, that of any number, or none. */
static void append_length(struct buffer *out, const struct meaning *meaning)
{
    if (meaning->wire != NULL && !format_is_flat(meaning->wire)) {
        text_append(out, "variable length");
    } else {
        text_append(out, "%zu bytes", format_size(meaning->wire)); /* 0 for a bad one, too */
    }
}

static void append_format(struct buffer *out, const struct meaning *meaning)
{
    const char *text = meaning->text == NULL ? "no format" : meaning->text;
    size_t i;
    for (i = 0; i < LONGEST_TEXT && text[i] != '\0'; i++) {
        const bool is_control = (unsigned char)text[i] < ' '; /* it is to be one line */
        text_append(out, "%c", is_control ? ' ' : text[i]);
    }
    text_append(out, "%s (", text[i] == '\0' ? "" : "...");
    append_length(out, meaning);
    text_append(out, ")");
}

/* The first part that differs; false when the definitions mean the same. */
static bool append_difference(struct buffer *out, const struct meaning *before,
                              const struct meaning *now)
{
    struct format_difference difference;
    if (!format_is_bad(before->wire) && !format_is_bad(now->wire) &&
        !format_equal(before->wire, now->wire)) {
        append_length(out, now);
        text_append(out, " instead of ");
        append_length(out, before);
        return true;
    }
    if (format_is_bad(before->content) || format_is_bad(now->content)) {
        text_append(out, "one of them is not understood");
        return before->text == NULL || now->text == NULL || strcmp(before->text, now->text) != 0;
    }
    if (!format_difference(now->content, before->content, &difference)) {
        return false;
    }
    text_append(out, "%s%s is %.*s instead of %.*s", difference.part[0] == '\0' ? "it" : "part ",
                difference.part, LONGEST_TEXT, difference.first, LONGEST_TEXT, difference.second);
    format_difference_fini(&difference);
    return true;
}

static void say(struct server *server, const struct module *module, const struct message *message,
                const struct meaning *before, const struct meaning *now)
{
    struct buffer text, difference;
    buffer_init(&text);
    buffer_init(&difference);
    if (append_difference(&difference, before, now)) {
        append_format(&text, now);
        text_append(&text, ", but %s as ", message->definer);
        append_format(&text, before);
        log_warning(&server->log, module, "it defines %s as %.*s: %.*s", message->name,
                    (int)text.length, (const char *)text.bytes, (int)difference.length,
                    (const char *)difference.bytes);
    }
    buffer_fini(&text);
    buffer_fini(&difference);
}

static bool same_text(const char *a, const char *b)
{
    return strcmp(a == NULL ? "" : a, b == NULL ? "" : b) == 0;
}

void conflict_check(struct server *server, const struct module *module,
                    const struct message *message, const struct message_definition_texts *texts)
{
    struct meaning before, now;
    if (same_text(message->wire_text, texts->wire) &&
        same_text(message->content_text, texts->content)) {
        return;
    }
    understand(&before, server, message->wire_text, message->content_text);
    understand(&now, server, texts->wire, texts->content);
    say(server, module, message, &before, &now);
    forget(&before);
    forget(&now);
}
