/*
 * What the tests over vector files share.
 */
#ifndef TEST_UNIT_FORMAT_VECTORS_H
#define TEST_UNIT_FORMAT_VECTORS_H

#include "unit.h"

#include "format/format.h"
#include "format/names.h"
#include "json.h"

/* Whether this host is of the kind that the vectors were recorded on. */
bool vectors_fit_host(void);

/* The named formats of an entry, NULL if it has none; the caller frees them. */
struct format_names *vectors_names(const struct json *entry);

/* The format of an entry, which must be legal; the caller gives the reference back. */
struct format *vectors_format(const struct json *entry);

/* A format that must be legal; the caller gives the reference back. */
struct format *must_parse(const char *text);

#endif
