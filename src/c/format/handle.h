/*
 * A format as the other files of this folder see it.
 */
#ifndef IPC_FORMAT_HANDLE_H
#define IPC_FORMAT_HANDLE_H

#include "format/format.h"
#include "format/holes.h"
#include "format/program.h"
#include "format/type.h"

struct format {
    size_t references; /* unused by the bad format, which is never freed */
    struct type *type; /* NULL: the bad format */
    struct program programs[N_PROGRAMS];
    struct holes holes; /* of the value itself */
};

/* A format with one reference around a complete type, which becomes its own. */
struct format *format_new(struct type *type);

/* The program for bytes in the given order. */
static inline const struct program *format_program(const struct format *format,
                                                   enum byte_order order)
{
    return &format->programs[order == byte_order_of_host() ? PROGRAM_NATIVE : PROGRAM_FOREIGN];
}

/*
 * What must hold before a value is touched: 0 to go on, 1 when there is nothing to do (no
 * format, or one of size 0), ERR_FORMAT for the bad format, ERR_NULL for a missing value.
 */
static inline int format_check(const struct format *format, const void *value)
{
    if (format == NULL) {
        return 1;
    }
    if (format->type == NULL) {
        return ERR_FORMAT;
    }
    if (format->type->size == 0) {
        return 1;
    }
    return value == NULL ? ERR_NULL : 0;
}

/* Empty strings decode as "" rather than NULL; see format_set_empty_strings. */
bool format_keeps_empty_strings(void);

#endif
