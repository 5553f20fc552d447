/*
 * Names that need not be unique: a table of lists.
 */
#include "central/model/namesakes.h"

#include <stdlib.h>

#include "base/memory.h"

void namesakes_init(struct namesakes *namesakes)
{
    table_init(&namesakes->groups, TABLE_FOLDING);
}

void namesakes_fini(struct namesakes *namesakes)
{
    for (struct table_entry *entry = table_first(&namesakes->groups); entry != NULL;
         entry = table_next(&namesakes->groups, entry)) {
        free(entry->value);
    }
    table_fini(&namesakes->groups);
}

void namesakes_add(struct namesakes *namesakes, const char *name, struct list *link)
{
    struct list *group = table_find(&namesakes->groups, name);
    if (group == NULL) {
        group = mem_new(sizeof *group);
        list_init(group);
        (void)table_put(&namesakes->groups, name, group); /* replaces nothing */
    }
    list_append(group, link);
}

void namesakes_remove(struct namesakes *namesakes, const char *name, struct list *link)
{
    struct list *group = table_find(&namesakes->groups, name);
    list_remove(link);
    if (group != NULL && list_is_empty(group)) {
        (void)table_remove(&namesakes->groups, name); /* it is group itself */
        free(group);
    }
}

struct list *namesakes_find(const struct namesakes *namesakes, const char *name)
{
    return table_find(&namesakes->groups, name);
}
