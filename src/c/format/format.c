/*
 * Formats as shared things: life cycle and properties.
 */
#include "format/format.h"

#include <stdlib.h>

#include "base/memory.h"
#include "format/handle.h"

static struct format bad_format;

static bool keep_empty_strings;

struct format *format_new(struct type *type)
{
    struct format *format = mem_new(sizeof *format);
    format->references = 1;
    format->type = type;
    for (int i = 0; i < N_PROGRAMS; i++) {
        program_compile(&format->programs[i], type, (enum program_purpose)i);
    }
    holes_find(&format->holes, type);
    return format;
}

struct format *format_bad(void)
{
    return &bad_format;
}

bool format_is_bad(const struct format *format)
{
    return format == &bad_format;
}

struct format *format_ref(struct format *format)
{
    if (!format_is_bad(format)) {
        format->references++;
    }
    return format;
}

void format_unref(struct format *format)
{
    if (format == NULL || format_is_bad(format) || --format->references > 0) {
        return;
    }
    for (int i = 0; i < N_PROGRAMS; i++) {
        program_fini(&format->programs[i]);
    }
    type_free(format->type);
    free(format);
}

/* The type of a format, NULL for none and for the bad one. */
static const struct type *type_of(const struct format *format)
{
    return format == NULL ? NULL : format->type;
}

size_t format_size(const struct format *format)
{
    const struct type *type = type_of(format);
    return type == NULL ? 0 : type->size;
}

size_t format_alignment(const struct format *format)
{
    const struct type *type = type_of(format);
    return type == NULL ? 1 : type->alignment;
}

bool format_is_flat(const struct format *format)
{
    const struct type *type = type_of(format);
    return type == NULL || type->flat;
}

bool format_is_simple(const struct format *format)
{
    const struct type *type = type_of(format);
    return type == NULL || type->simple;
}

bool format_equal(const struct format *a, const struct format *b)
{
    if (a == b) {
        return true;
    }
    if (type_of(a) == NULL || type_of(b) == NULL) {
        return false;
    }
    return type_equal(a->type, b->type);
}

void format_set_empty_strings(bool keep)
{
    keep_empty_strings = keep;
}

bool format_keeps_empty_strings(void)
{
    return keep_empty_strings;
}
