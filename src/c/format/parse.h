/*
 * From format strings to type trees.
 */
#ifndef IPC_FORMAT_PARSE_H
#define IPC_FORMAT_PARSE_H

#include "format/format.h"
#include "format/type.h"

/*
 * Parses text, which stands levels deep in what is being parsed, into a type
 * that the caller frees: 0, or ERR_FORMAT or ERR_UNKNOWN with a diagnosis
 * (which may be NULL).
 */
int parse_type(const char *text, const struct format_names *names, uint32_t levels,
               struct type **type, struct format_diagnosis *diagnosis);

#endif
