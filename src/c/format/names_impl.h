/*
 * Named formats as the parser asks for them.
 */
#ifndef IPC_FORMAT_NAMES_IMPL_H
#define IPC_FORMAT_NAMES_IMPL_H

#include "format/names.h"

/* Where a name was met. */
struct names_question {
    uint32_t levels;    /* around the name */
    const char *string; /* that it stands in */
    size_t position;
    struct format *lent; /* set by the answer */
};

/*
 * The format of a name, which names_resolved gives back: 0, or ERR_UNKNOWN or
 * ERR_FORMAT with a diagnosis.  names may be NULL and then knows nothing.
 */
int names_resolve(const struct format_names *names, const char *name,
                  struct names_question *question, const struct format **format,
                  struct format_diagnosis *diagnosis);
void names_resolved(struct names_question *question);

#endif
