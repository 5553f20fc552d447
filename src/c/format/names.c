/*
 * Named formats: a table from names to texts and what they were parsed to.
 *
 * The parsed meaning of a name is a cache: looking a name up changes nothing
 * that can be seen, so look-ups take the table as const.
 */
#include "format/names.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/table.h"
#include "format/names_impl.h"
#include "format/type.h"

struct format_names {
    struct table definitions; /* name -> struct definition */
    format_ask ask;
    void *asked;
};

struct format_names *format_names_new(void)
{
    struct format_names *names = mem_new(sizeof *names);
    table_init(&names->definitions, TABLE_EXACT);
    return names;
}

static void free_definition(struct definition *definition)
{
    format_unref(definition->parsed);
    free(definition->text);
    free(definition);
}

void format_names_free(struct format_names *names)
{
    if (names == NULL) {
        return;
    }
    for (struct table_entry *entry = table_first(&names->definitions); entry != NULL;
         entry = table_next(&names->definitions, entry)) {
        free_definition(entry->value);
    }
    table_fini(&names->definitions);
    free(names);
}

void format_names_set_ask(struct format_names *names, format_ask ask, void *asked)
{
    names->ask = ask;
    names->asked = asked;
}

int format_names_define(struct format_names *names, const char *name, const char *text)
{
    if (name == NULL || *name == '\0' || text == NULL) {
        return ERR_NULL;
    }
    if (primitive_find(name, strlen(name)) != N_PRIMITIVES) {
        return ERR_FORMAT;
    }
    struct definition *definition = table_find(&names->definitions, name);
    if (definition == NULL) {
        definition = mem_new(sizeof *definition);
        (void)table_put(&names->definitions, name, definition);
    }
    char *copy = mem_copy_string(text);
    free(definition->text);
    definition->text = copy;
    format_unref(definition->parsed);
    definition->parsed = NULL;
    return 0;
}

bool format_names_holds(const struct format_names *names, const char *name)
{
    return table_find(&names->definitions, name) != NULL;
}

void format_names_each(const struct format_names *names,
                       void (*visit)(void *context, const char *name, const char *text),
                       void *context)
{
    for (struct table_entry *entry = table_first(&names->definitions); entry != NULL;
         entry = table_next(&names->definitions, entry)) {
        visit(context, entry->name, ((const struct definition *)entry->value)->text);
    }
}

struct definition *names_find(const struct format_names *names, const char *name)
{
    return names == NULL ? NULL : table_find(&names->definitions, name);
}

struct format *names_ask(const struct format_names *names, const char *name)
{
    return names == NULL || names->ask == NULL ? NULL : names->ask(names->asked, name);
}
