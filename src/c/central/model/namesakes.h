/*
 * Names that need not be unique: from a name to all things that bear it.
 *
 * Things are linked through a member of their own and found in the order in
 * which they came.  The case of A to Z does not matter.
 */
#ifndef IPC_CENTRAL_NAMESAKES_H
#define IPC_CENTRAL_NAMESAKES_H

#include <stddef.h>

#include "base/list.h"
#include "base/table.h"

struct namesakes {
    struct table groups; /* name -> struct list, the things of that name */
};

void namesakes_init(struct namesakes *namesakes);
void namesakes_fini(struct namesakes *namesakes);

/* Adds a thing, by its link, under a name. */
void namesakes_add(struct namesakes *namesakes, const char *name, struct list *link);

/* Removes a thing that is there under that name. */
void namesakes_remove(struct namesakes *namesakes, const char *name, struct list *link);

/* The list of all things of that name, never empty, or NULL. */
struct list *namesakes_find(const struct namesakes *namesakes, const char *name);

#endif
