/*
 * A small reader of JSON, for test vectors.
 */
#include "json.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/buffer.h"
#include "base/memory.h"

static void give_up(const char *why, const char *at)
{
    (void)fprintf(stderr, "json: %s at: %.60s\n", why, at);
    abort();
}

static struct json *parse_any(const char **at);

static void skip_space(const char **at)
{
    while (isspace((unsigned char)**at)) {
        (*at)++;
    }
}

static bool skip_mark(const char **at, char mark)
{
    skip_space(at);
    if (**at != mark) {
        return false;
    }
    (*at)++;
    return true;
}

static void add_part(struct json *json, char *key, struct json *part)
{
    json->keys = mem_resize(json->keys, json->length + 1, sizeof *json->keys);
    json->parts = mem_resize(json->parts, json->length + 1, sizeof *json->parts);
    json->keys[json->length] = key;
    json->parts[json->length++] = part;
}

static unsigned hex_value(const char *digits, int count, const char *at)
{
    unsigned value = 0;
    for (int i = 0; i < count; i++) {
        const char *known = "0123456789abcdef";
        const char *found =
            digits[i] == '\0' ? NULL : strchr(known, tolower((unsigned char)digits[i]));
        if (found == NULL) {
            give_up("bad hexadecimal digit", at);
        }
        value = value * 16 + (unsigned)(found - known);
    }
    return value;
}

/* The character of an escape sequence, *at being behind the backslash. */
static unsigned parse_escape(const char **at)
{
    const char c = *(*at)++;
    const char *known = "bfnrt";
    const char *found = c == '\0' ? NULL : strchr(known, c);
    if (found != NULL) {
        return (unsigned char)"\b\f\n\r\t"[found - known];
    }
    if (c != 'u') {
        return (unsigned char)c;
    }
    unsigned value = hex_value(*at, 4, *at);
    *at += 4;
    return value;
}

/* A character in UTF-8 of two bytes; vectors hold no others. */
static unsigned parse_wide(const char **at)
{
    unsigned first = (unsigned char)*(*at)++;
    if (first < 0x80) {
        return first;
    }
    if ((first & 0xe0) != 0xc0) {
        return '?';
    }
    return (first & 0x1f) << 6 | ((unsigned char)*(*at)++ & 0x3f);
}

static struct json *parse_string(const char **at)
{
    struct json *json = mem_new(sizeof *json);
    struct buffer bytes;
    buffer_init(&bytes);
    json->kind = JSON_STRING;
    (*at)++;
    while (**at != '"') {
        if (**at == '\0') {
            give_up("string without end", *at);
        }
        unsigned character;
        if (**at == '\\') {
            (*at)++;
            character = parse_escape(at);
        } else {
            character = parse_wide(at);
        }
        uint8_t byte = (uint8_t)(character > 255 ? '?' : character);
        (void)buffer_append(&bytes, &byte, 1);
    }
    (*at)++;
    (void)buffer_append(&bytes, "", 1);
    json->length = bytes.length - 1;
    size_t length;
    json->text = (char *)buffer_take(&bytes, &length);
    return json;
}

static struct json *parse_number(const char **at)
{
    struct json *json = mem_new(sizeof *json);
    char *end;
    json->kind = JSON_NUMBER;
    json->real = strtod(*at, &end);
    if (end == *at) {
        give_up("no value", *at);
    }
    json->integer = strtoll(*at, NULL, 10);
    json->text = mem_copy_text(*at, (size_t)(end - *at));
    *at = end;
    return json;
}

static struct json *parse_list(const char **at)
{
    struct json *json = mem_new(sizeof *json);
    json->kind = JSON_LIST;
    (*at)++;
    if (skip_mark(at, ']')) {
        return json;
    }
    do {
        add_part(json, NULL, parse_any(at));
    } while (skip_mark(at, ','));
    if (!skip_mark(at, ']')) {
        give_up("list without end", *at);
    }
    return json;
}

static struct json *parse_object(const char **at)
{
    struct json *json = mem_new(sizeof *json);
    json->kind = JSON_OBJECT;
    (*at)++;
    if (skip_mark(at, '}')) {
        return json;
    }
    do {
        skip_space(at);
        if (**at != '"') {
            give_up("object without key", *at);
        }
        struct json *key = parse_string(at);
        if (!skip_mark(at, ':')) {
            give_up("key without value", *at);
        }
        add_part(json, key->text, parse_any(at));
        key->text = NULL;
        json_free(key);
    } while (skip_mark(at, ','));
    if (!skip_mark(at, '}')) {
        give_up("object without end", *at);
    }
    return json;
}

static struct json *parse_word(const char **at)
{
    struct json *json = mem_new(sizeof *json);
    if (strncmp(*at, "null", 4) == 0) {
        *at += 4;
        return json;
    }
    json->kind = JSON_BOOLEAN;
    json->truth = strncmp(*at, "true", 4) == 0;
    if (!json->truth && strncmp(*at, "false", 5) != 0) {
        give_up("unknown word", *at);
    }
    *at += json->truth ? 4 : 5;
    return json;
}

static struct json *parse_any(const char **at)
{
    skip_space(at);
    switch (**at) {
    case '{':
        return parse_object(at);
    case '[':
        return parse_list(at);
    case '"':
        return parse_string(at);
    case 'n':
    case 't':
    case 'f':
        return parse_word(at);
    default:
        return parse_number(at);
    }
}

struct json *json_parse(const char *text)
{
    return parse_any(&text);
}

struct json *json_read_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        give_up("cannot open", path);
    }
    struct buffer bytes;
    buffer_init(&bytes);
    size_t count;
    char chunk[4096];
    while ((count = fread(chunk, 1, sizeof chunk, file)) > 0) {
        (void)buffer_append(&bytes, chunk, count);
    }
    (void)fclose(file);
    (void)buffer_append(&bytes, "", 1);
    struct json *json = json_parse((const char *)bytes.bytes);
    buffer_fini(&bytes);
    return json;
}

struct json *json_read_vectors(const char *name)
{
    char path[1000];
    (void)snprintf(path, sizeof path, "%s/%s", IPC_TEST_VECTORS, name);
    return json_read_file(path);
}

void json_free(struct json *json)
{
    if (json == NULL) {
        return;
    }
    if (json->kind == JSON_LIST || json->kind == JSON_OBJECT) {
        for (size_t i = 0; i < json->length; i++) {
            free(json->keys[i]);
            json_free(json->parts[i]);
        }
    }
    free(json->keys);
    free(json->parts);
    free(json->text);
    free(json);
}

const struct json *json_find(const struct json *object, const char *key)
{
    if (object->kind != JSON_OBJECT) {
        return NULL;
    }
    for (size_t i = 0; i < object->length; i++) {
        if (strcmp(object->keys[i], key) == 0) {
            return object->parts[i];
        }
    }
    return NULL;
}

const struct json *json_get(const struct json *object, const char *key)
{
    const struct json *part = json_find(object, key);
    if (part == NULL) {
        give_up("missing key", key);
    }
    return part;
}

const char *json_text(const struct json *json)
{
    return json == NULL || json->kind == JSON_NULL ? NULL : json->text;
}

uint8_t *json_bytes(const struct json *json, size_t *length)
{
    *length = json->length / 2;
    uint8_t *bytes = mem_new(*length);
    for (size_t i = 0; i < *length; i++) {
        bytes[i] = (uint8_t)hex_value(json->text + 2 * i, 2, json->text);
    }
    return bytes;
}
