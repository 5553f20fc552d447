/*
 * What is said about a string that is not, or not quite, a format.
 */
#ifndef IPC_FORMAT_DIAGNOSIS_H
#define IPC_FORMAT_DIAGNOSIS_H

#include "format/format.h"

/* Each replaces what was said before; diagnosis may be NULL. */

/* "Format Parsing Error: Expected <what>." with the string and a caret under position. */
void diagnose_expected(struct format_diagnosis *diagnosis, const char *what, const char *string,
                       size_t position);

/* "Warning: Extra text after the format is ignored." in the same way. */
void diagnose_extra_text(struct format_diagnosis *diagnosis, const char *string, size_t position);

/* "Warning: Named Format <name> <fault>" and the string, without a caret as ever. */
void diagnose_name(struct format_diagnosis *diagnosis, const char *name, const char *fault,
                   const char *string, size_t position);

/* An error about which nothing is printed here. */
void diagnose_silently(struct format_diagnosis *diagnosis, size_t position);

#endif
