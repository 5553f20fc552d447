/*
 * What the tests over vector files share.
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

bool vectors_fit_host(void)
{
    return sizeof(long) == 8 && sizeof(void *) == 8;
}

bool vectors_bytes_fit_host(const struct json *entry)
{
    const struct json *names = json_find(entry, "named_formats");
    if (sizeof(long) == 8) {
        return true;
    }
    for (size_t i = 0; names != NULL && i < names->length; i++) {
        if (strstr(names->parts[i]->parts[1]->text, "long") != NULL) {
            return false;
        }
    }
    return strstr(json_get(entry, "format")->text, "long") == NULL;
}

struct format_names *vectors_names(const struct json *entry)
{
    const struct json *list = json_find(entry, "named_formats");
    if (list == NULL) {
        return NULL;
    }
    struct format_names *names = format_names_new();
    for (size_t i = 0; i < list->length; i++) {
        const struct json *pair = list->parts[i];
        int error = format_names_define(names, pair->parts[0]->text, pair->parts[1]->text);
        assert_int_equal(error, 0);
    }
    return names;
}

static struct format *parse(const char *text, const struct format_names *names)
{
    struct format_diagnosis diagnosis;
    struct format *format;
    int error = format_parse(text, names, &format, &diagnosis);
    if (error != 0) {
        fail_msg("%s: %s", text, diagnosis.text);
    }
    free(diagnosis.text);
    return format;
}

struct format *vectors_format(const struct json *entry)
{
    struct format_names *names = vectors_names(entry);
    struct format *format = parse(json_get(entry, "format")->text, names);
    format_names_free(names);
    return format;
}

struct format *must_parse(const char *text)
{
    return parse(text, NULL);
}
