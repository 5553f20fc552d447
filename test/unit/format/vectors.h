/*
 * What the tests over vector files share.
 */
#ifndef TEST_UNIT_FORMAT_VECTORS_H
#define TEST_UNIT_FORMAT_VECTORS_H

#include "unit.h"

#include "format/format.h"
#include "format/names.h"
#include "json.h"

/* Whether C values have the sizes here that they had where the vectors were recorded. */
bool vectors_fit_host(void);

/* Whether the bytes of an entry are the same here: they are unless it has a long of another size. */
bool vectors_bytes_fit_host(const struct json *entry);

/* The named formats of an entry, NULL if it has none; the caller frees them. */
struct format_names *vectors_names(const struct json *entry);

/* The format of an entry, which must be legal; the caller gives the reference back. */
struct format *vectors_format(const struct json *entry);

/* A format that must be legal; the caller gives the reference back. */
struct format *must_parse(const char *text);

#endif
