/*
 * Values of any format, for tests: built from JSON, compared in depth.
 *
 * The notation is that of the vector files: structures and arrays are lists,
 * variable arrays flat lists, pointers {"ptr": target} or null, raw bytes a
 * string of hexadecimal digits, numbers possibly {"bits": hexadecimal}.
 */
#ifndef TEST_SUPPORT_VALUE_H
#define TEST_SUPPORT_VALUE_H

#include <stdbool.h>

#include "format/format.h"
#include "json.h"

/*
 * A new block with the value, everything in malloc blocks of its own, padding
 * filled with EE.  The caller frees it with value_free.
 */
void *value_build(const struct format *format, const struct json *json);

/* The large values that the vectors describe by a generator; NULL for unknown generators. */
void *value_generate(const struct format *format, const char *generator);

void value_free(const struct format *format, void *value);

/* Whether two values are the same bit by bit, padding apart; NULL and empty strings differ. */
bool value_same(const struct format *format, const void *a, const void *b);

#endif
