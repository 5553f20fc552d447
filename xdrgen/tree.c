/*
 * The tree of a specification: its parts come into being and go.
 */
#include "tree.h"

#include <stdlib.h>

#include "base/memory.h"

/* Makes room for one more element of an array that is full at 0, 1, 2, 4, 8 ... elements. */
static void *make_room(void *items, size_t count, size_t size)
{
    if ((count & (count - 1)) != 0) {
        return items;
    }
    return mem_resize(items, count == 0 ? 1 : 2 * count, size);
}

/* ------------------------------------------------------------------------ types */

struct type type_simple(enum type_kind kind, const struct place *place)
{
    return (struct type){.kind = kind, .place = *place};
}

struct type type_named(struct text name, const struct place *place)
{
    return (struct type){.kind = TYPE_NAMED, .place = *place, .name = name};
}

struct type type_record(struct record *record, const struct place *place)
{
    return (struct type){.kind = TYPE_RECORD, .place = *place, .record = record};
}

struct type type_enum(struct enumeration *enumeration, const struct place *place)
{
    return (struct type){.kind = TYPE_ENUM, .place = *place, .enumeration = enumeration};
}

void type_fini(struct type *type)
{
    record_free(type->record);
    enumeration_free(type->enumeration);
}

/* ----------------------------------------------------------------- declarations */

struct dimensions *dimensions_new(void)
{
    return mem_new(sizeof(struct dimensions));
}

void dimensions_append(struct dimensions *dimensions, struct dimension dimension)
{
    dimensions->items = make_room(dimensions->items, dimensions->count, sizeof dimension);
    dimensions->items[dimensions->count++] = dimension;
}

void dimensions_free(struct dimensions *dimensions)
{
    if (dimensions == NULL) {
        return;
    }
    free(dimensions->items);
    free(dimensions);
}

struct declaration *declaration_new(struct type type, struct text name, const struct place *place,
                                    enum array_kind array, struct dimensions *dimensions)
{
    struct declaration *declaration = mem_new(sizeof *declaration);
    *declaration =
        (struct declaration){.type = type, .name = name, .place = *place, .array = array};
    if (dimensions != NULL) {
        declaration->dimensions = *dimensions;
    }
    free(dimensions);
    return declaration;
}

struct declaration *declaration_new_string(const struct place *type_place, struct text name,
                                           const struct place *place, enum array_kind array,
                                           struct dimensions *dimensions)
{
    const struct dimension own = dimensions->items[--dimensions->count];
    const enum array_kind left = dimensions->count == 0 ? ARRAY_NONE : array;
    struct declaration *declaration =
        declaration_new(type_simple(TYPE_STRING, type_place), name, place, left, dimensions);
    declaration->length_limit = own;
    return declaration;
}

void declaration_free(struct declaration *declaration)
{
    if (declaration == NULL) {
        return;
    }
    type_fini(&declaration->type);
    free(declaration->dimensions.items);
    free(declaration);
}

/* ----------------------------------------------------------------------- bodies */

struct record *record_new(void)
{
    struct record *record = mem_new(sizeof *record);
    record->depth = 1;
    return record;
}

void record_append(struct record *record, struct declaration *field)
{
    if (field == NULL) {
        record->is_damaged = true;
        return;
    }
    record->fields = make_room(record->fields, record->n_fields, sizeof(struct declaration *));
    record->fields[record->n_fields++] = field;
    if (field->type.kind == TYPE_RECORD && record->depth <= field->type.record->depth) {
        record->depth = field->type.record->depth + 1;
    }
}

void record_free(struct record *record)
{
    if (record == NULL) {
        return;
    }
    for (size_t i = 0; i < record->n_fields; i++) {
        declaration_free(record->fields[i]);
    }
    free((void *)record->fields);
    free(record);
}

struct enumeration *enumeration_new(void)
{
    return mem_new(sizeof(struct enumeration));
}

void enumeration_append(struct enumeration *enumeration, struct enumerator enumerator)
{
    if (enumerator.has_value) {
        enumeration->has_values = true;
    } else if (enumeration->count == 0) {
        enumerator.value = 0;
    } else if (enumeration->items[enumeration->count - 1].value < INT64_MAX) {
        enumerator.value = enumeration->items[enumeration->count - 1].value + 1;
    } else {
        enumerator.value = INT64_MAX;
    }
    enumeration->items = make_room(enumeration->items, enumeration->count, sizeof enumerator);
    enumeration->items[enumeration->count++] = enumerator;
}

void enumeration_free(struct enumeration *enumeration)
{
    if (enumeration == NULL) {
        return;
    }
    free(enumeration->items);
    free(enumeration);
}

/* ------------------------------------------------------------------ definitions */

void tree_init(struct tree *tree)
{
    *tree = (struct tree){NULL, NULL};
}

void tree_fini(struct tree *tree)
{
    while (tree->first != NULL) {
        struct definition *definition = tree->first;
        tree->first = definition->next;
        declaration_free(definition->declaration);
        free(definition->format);
        free(definition->expansion);
        free(definition);
    }
    tree->last = NULL;
}

static struct definition *add(struct tree *tree, enum definition_kind kind, struct text name,
                              const struct place *place)
{
    struct definition *definition = mem_new(sizeof *definition);
    *definition = (struct definition){.kind = kind, .name = name, .place = *place};
    if (tree->last == NULL) {
        tree->first = definition;
    } else {
        tree->last->next = definition;
    }
    tree->last = definition;
    return definition;
}

void tree_add_type(struct tree *tree, struct declaration *declaration)
{
    add(tree, DEFINITION_TYPE, declaration->name, &declaration->place)->declaration = declaration;
}

void tree_add_format(struct tree *tree, struct text name, const struct place *place, char *format)
{
    add(tree, DEFINITION_FORMAT, name, place)->format = format;
}

void tree_add_code(struct tree *tree, struct text text, const struct place *place)
{
    add(tree, DEFINITION_CODE, (struct text){"", 0}, place)->code = (struct code){text, *place};
}

bool definition_is_record(const struct definition *definition)
{
    return definition->kind == DEFINITION_TYPE && definition->declaration->array == ARRAY_NONE &&
           definition->declaration->type.kind == TYPE_RECORD;
}

bool definition_is_enum(const struct definition *definition)
{
    return definition->kind == DEFINITION_TYPE && definition->declaration->array == ARRAY_NONE &&
           definition->declaration->type.kind == TYPE_ENUM;
}

static struct meaning type_meaning(const struct type *type)
{
    struct meaning meaning = {SHAPE_SCALAR, false, type, NULL};
    switch (type->kind) {
    case TYPE_INT:
    case TYPE_UINT:
        meaning.shape = SHAPE_INTEGER;
        break;
    case TYPE_RECORD:
        meaning.shape = SHAPE_RECORD;
        break;
    case TYPE_ENUM:
        meaning.shape = SHAPE_ENUM;
        break;
    case TYPE_NAMED:
        if (type->target != NULL && type->target->kind == DEFINITION_TYPE) {
            return type->target->meaning;
        }
        meaning.shape = SHAPE_EXTERNAL;
        meaning.element = NULL;
        break;
    default:
        break;
    }
    return meaning;
}

struct meaning declaration_meaning(const struct declaration *declaration)
{
    struct meaning meaning = type_meaning(&declaration->type);
    if (declaration->array == ARRAY_NONE) {
        return meaning;
    }
    meaning.is_integer_array = declaration->array == ARRAY_FIXED &&
                               (meaning.shape == SHAPE_INTEGER || meaning.is_integer_array);
    meaning.shape = SHAPE_ARRAY;
    return meaning;
}
