/*
 * Message registry: names, numbers, formats.
 */
#include "central/model/message.h"

#include <stdlib.h>
#include <string.h>

#include "base/byteorder.h"
#include "base/error.h"
#include "base/memory.h"
#include "central/settings/limits.h"

void message_registry_init(struct message_registry *registry)
{
    table_init(&registry->names, TABLE_FOLDING);
    registry->by_id = NULL;
    registry->n_ids = FIRST_MESSAGE_ID;
    registry->room = 0;
}

static void message_free(struct message *message)
{
    format_unref(message->wire);
    format_unref(message->content);
    free(message->wire_text);
    free(message->content_text);
    free(message->definer);
    free(message->label);
    free(message->name);
    free(message);
}

void message_registry_fini(struct message_registry *registry)
{
    for (struct table_entry *entry = table_first(&registry->names); entry != NULL;
         entry = table_next(&registry->names, entry)) {
        message_free(entry->value);
    }
    table_fini(&registry->names);
    free(registry->by_id);
}

/* The name, and the name as class data: its length and its bytes. */
static void set_name(struct message *message, const char *name)
{
    const uint32_t length = (uint32_t)strlen(name);
    free(message->name);
    message->name = mem_copy_text(name, length);
    message->label = mem_resize(message->label, sizeof length + length, 1);
    message->label_length = (uint32_t)sizeof length + length;
    memcpy(message->label, &length, sizeof length);
    memcpy(message->label + sizeof length, name, length);
}

struct message *message_find(const struct message_registry *registry, const char *name)
{
    return table_find(&registry->names, name);
}

struct message *message_get(struct message_registry *registry, const char *name)
{
    struct message *message = message_find(registry, name);
    if (message != NULL || registry->names.count >= LIMIT_MESSAGES) {
        return message;
    }
    message = mem_new(sizeof *message);
    message->class = CLASS_SUBSCRIBED;
    set_name(message, name);
    list_init(&message->subscriptions);
    list_init(&message->waiting);
    list_init(&message->in_broadcasts);
    list_init(&message->taps);
    pending_subject_init(&message->subject, (uint32_t)registry->names.count);
    (void)table_put(&registry->names, name, message); /* replaces nothing */
    return message;
}

static void give_id(struct message_registry *registry, struct message *message)
{
    if (message->id != 0) {
        return;
    }
    if (registry->n_ids >= registry->room) {
        const int before = registry->room;
        registry->room = before == 0 ? 256 : before * 2;
        registry->by_id =
            mem_resize(registry->by_id, (size_t)registry->room, sizeof *registry->by_id);
        memset(registry->by_id + before, 0,
               (size_t)(registry->room - before) * sizeof *registry->by_id);
    }
    message->id = registry->n_ids++;
    registry->by_id[message->id] = message;
}

/* Drops what is known of the formats and takes over copies of the texts. */
static void set_texts(struct message *message, const char *wire, const char *content)
{
    format_unref(message->wire);
    format_unref(message->content);
    message->wire = NULL;
    message->content = NULL;
    message->parsed = false;
    message->bad_is_logged = false;
    free(message->wire_text);
    free(message->content_text);
    message->wire_text = mem_copy_string(wire);
    message->content_text = mem_copy_string(content);
}

void message_define(struct message_registry *registry, struct message *message, const char *name,
                    const struct message_definition_texts *texts)
{
    give_id(registry, message);
    set_name(message, name);
    set_texts(message, texts->wire, texts->content);
    message->class = texts->class;
    free(message->definer);
    message->definer = mem_copy_string(texts->definer);
}

static struct format *optional_ref(struct format *format)
{
    return format == NULL ? NULL : format_ref(format);
}

void message_define_internal(struct message_registry *registry, struct message *message,
                             enum message_kind kind, int class, struct format *wire,
                             struct format *content)
{
    give_id(registry, message);
    set_texts(message, NULL, NULL);
    message->kind = kind;
    message->class = class;
    message->wire = optional_ref(wire);
    message->content = optional_ref(content);
    message->parsed = true;
}

struct format *message_parse_text(const char *text, const struct format_names *names)
{
    struct format *format = NULL;
    if (text == NULL || text[0] == '\0') {
        return NULL;
    }
    char *portable = format_portable_text(text, names);
    if (strlen(text) > LIMIT_FORMAT_TEXT || format_parse(portable, names, &format, NULL) != 0) {
        format = format_ref(format_bad());
    }
    free(portable);
    return format;
}

int message_parse(struct message *message, const struct format_names *names)
{
    if (message->parsed) {
        return 0;
    }
    format_unref(message->wire);
    format_unref(message->content);
    message->wire = message_parse_text(message->wire_text, names);
    message->content = message_parse_text(message->content_text, names);
    message->parsed = !format_is_bad(message->wire) && !format_is_bad(message->content);
    return message->parsed ? 0 : ERR_FORMAT;
}
