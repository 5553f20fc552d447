/*
 * Named formats as the parser sees them.
 */
#ifndef IPC_FORMAT_NAMES_IMPL_H
#define IPC_FORMAT_NAMES_IMPL_H

#include "format/names.h"

struct definition {
    char *text;
    struct format *parsed; /* a reference; NULL until the parser has met the name */
    bool parsing;          /* met again meanwhile, it is defined in terms of itself */
};

/* The definition of a name, NULL if the table does not hold it; names may be NULL. */
struct definition *names_find(const struct format_names *names, const char *name);

/* What whoever is asked for unknown names answers: a reference for the caller, or NULL. */
struct format *names_ask(const struct format_names *names, const char *name);

#endif
