/*
 * Named formats.
 *
 * Holds definitions as text and parses them at first use, so that they may be
 * defined in any order.  A definition that was parsed keeps its meaning until
 * it is defined anew, even if a name inside it changes.  Names are exact.
 */
#ifndef IPC_FORMAT_NAMES_H
#define IPC_FORMAT_NAMES_H

#include "format/format.h"

/*
 * Asked for a name that the table does not hold: a format with a reference for
 * the caller, or NULL.  The answer is used once and not kept.
 */
typedef struct format *(*format_ask)(void *asked, const char *name);

struct format_names *format_names_new(void);
void format_names_free(struct format_names *names);

/* Whom to ask for unknown names; ask NULL: nobody. */
void format_names_set_ask(struct format_names *names, format_ask ask, void *asked);

/* Defines or redefines: 0, ERR_FORMAT for the name of a primitive, ERR_NULL for a missing argument.
 */
int format_names_define(struct format_names *names, const char *name, const char *text);

/* Whether the table itself (nobody is asked) holds the name. */
bool format_names_holds(const struct format_names *names, const char *name);

/* Calls visit for every definition in the order in which the names were first defined. */
void format_names_each(const struct format_names *names,
                       void (*visit)(void *context, const char *name, const char *text),
                       void *context);

#endif
