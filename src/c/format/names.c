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
#include "format/diagnosis.h"
#include "format/handle.h"
#include "format/names_impl.h"
#include "format/parse.h"

struct definition {
    char *text;
    struct format *parsed; /* a reference; NULL until first use */
    bool parsing;          /* met again meanwhile, it is defined in terms of itself */
};

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
    if (names == NULL)
        return;
    for (struct table_entry *entry = table_first(&names->definitions); entry != NULL;
         entry = table_next(&names->definitions, entry))
        free_definition(entry->value);
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
    if (name == NULL || *name == '\0' || text == NULL)
        return ERR_NULL;
    if (primitive_find(name, strlen(name)) != N_PRIMITIVES)
        return ERR_FORMAT;
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
         entry = table_next(&names->definitions, entry))
        visit(context, entry->name, ((const struct definition *)entry->value)->text);
}

/* Parses a definition at its first use. */
static int parse_definition(const struct format_names *names, const char *name,
                            struct definition *definition, const struct names_question *question,
                            struct format_diagnosis *diagnosis)
{
    if (definition->parsing) {
        diagnose_name(diagnosis, name, "is defined in terms of itself", question->string,
                      question->position);
        return ERR_FORMAT;
    }
    struct type *type = NULL;
    definition->parsing = true;
    int error = parse_type(definition->text, names, question->levels, &type, diagnosis);
    definition->parsing = false;
    if (error == 0)
        definition->parsed = format_new(type);
    return error;
}

/* Asks whoever was named to be asked; the answer is used once. */
static int ask(const struct format_names *names, const char *name, struct names_question *question,
               struct format_diagnosis *diagnosis)
{
    struct format *answer = NULL;
    if (names != NULL && names->ask != NULL)
        answer = names->ask(names->asked, name);
    if (answer != NULL && !format_is_bad(answer)) {
        question->lent = answer;
        return 0;
    }
    if (answer == NULL)
        diagnose_name(diagnosis, name, "is not registered", question->string, question->position);
    else
        diagnose_silently(diagnosis, question->position); /* whoever answered has said it */
    return ERR_UNKNOWN;
}

int names_resolve(const struct format_names *names, const char *name,
                  struct names_question *question, const struct format **format,
                  struct format_diagnosis *diagnosis)
{
    struct definition *definition = names == NULL ? NULL : table_find(&names->definitions, name);
    int error = 0;
    question->lent = NULL;
    if (definition == NULL)
        error = ask(names, name, question, diagnosis);
    else if (definition->parsed == NULL)
        error = parse_definition(names, name, definition, question, diagnosis);
    if (error == 0 && definition != NULL)
        question->lent = format_ref(definition->parsed);
    *format = question->lent;
    return error;
}

void names_resolved(struct names_question *question)
{
    format_unref(question->lent);
    question->lent = NULL;
}
