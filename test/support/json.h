/*
 * A small reader of JSON, for test vectors.
 *
 * Whatever is malformed ends the test program with a message: vectors are part
 * of the project.
 */
#ifndef TEST_SUPPORT_JSON_H
#define TEST_SUPPORT_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum json_kind { JSON_NULL, JSON_BOOLEAN, JSON_NUMBER, JSON_STRING, JSON_LIST, JSON_OBJECT };

struct json {
    enum json_kind kind;
    bool truth;
    double real;
    int64_t integer; /* of numbers without fraction and exponent */
    char *text;    /* of strings: one byte per character, NUL-terminated; of numbers: as written */
    size_t length; /* of the string, or number of parts */
    char **keys;   /* of an object's parts */
    struct json **parts;
};

/* Reads a file; the caller frees the result with json_free. */
struct json *json_read_file(const char *path);

/* Reads a file of the test vectors. */
struct json *json_read_vectors(const char *name);

struct json *json_parse(const char *text);
void json_free(struct json *json);

/* The part of an object, NULL if it has none of that name. */
const struct json *json_find(const struct json *object, const char *key);

/* The part of an object, which must be there. */
const struct json *json_get(const struct json *object, const char *key);

/* The text of a string; NULL for null and for NULL. */
const char *json_text(const struct json *json);

/* The bytes of a string of hexadecimal digits; the caller frees them. */
uint8_t *json_bytes(const struct json *json, size_t *length);

#endif
