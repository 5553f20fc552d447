/*
 * The rules that the grammar cannot express: names, dimensions, sizes of arrays.
 *
 * One pass in the order of the text, since a name is known from its own
 * declaration onwards.  A scope is a table from names to their places.  In C
 * all enumerators of a file share one scope with its types; in C++ those of an
 * anonymous enum belong to the structure around it.
 */
#include "check.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/table.h"

struct check {
    enum language language;
    struct diagnostics *diagnostics;
    bool is_complete; /* no syntax error has taken definitions away */
    struct table types;
    struct table file_scope;
    const struct definition *current;
    bool contains_itself; /* has been reported of the current definition */
};

/* The width and the text of a name, as printf's %.*s wants them. */
#define NAME(text) (int)((text).length > 200 ? 200 : (text).length), (text).bytes

static void *put(struct table *table, struct text name, void *value)
{
    char *key = mem_copy_text(name.bytes, name.length);
    void *previous = table_put(table, key, value);
    free(key);
    return previous;
}

/* ------------------------------------------------------------------------- names */

static void check_keyword(struct check *check, struct text name, const struct place *place)
{
    const enum reservation reservation = language_reserves(check->language, name);
    if (reservation == RESERVED_ALWAYS) {
        diagnostics_error(check->diagnostics, place, name.length,
                          "`%.*s' is a keyword in the output language", NAME(name));
    } else if (reservation == RESERVED_LATER) {
        diagnostics_warning(check->diagnostics, place, name.length,
                            "`%.*s' is a keyword in later versions of the output language",
                            NAME(name));
    }
}

/* Enters a name into a scope, where it must be new. */
static void declare(struct check *check, struct table *scope, struct text name, struct place *place,
                    const char *what)
{
    check_keyword(check, name, place);
    const struct place *previous = table_find_text(scope, name.bytes, name.length);
    if (previous == NULL) {
        (void)put(scope, name, place);
        return;
    }
    diagnostics_error(check->diagnostics, place, name.length, "duplicate %s `%.*s'", what,
                      NAME(name));
    diagnostics_note(check->diagnostics, previous, name.length, "the first `%.*s' is here",
                     NAME(name));
}

static void resolve(struct check *check, struct type *type)
{
    struct definition *target = table_find_text(&check->types, type->name.bytes, type->name.length);
    if (target == NULL) {
        if (check->is_complete) {
            diagnostics_warning(check->diagnostics, &type->place, type->name.length,
                                "undeclared type `%.*s'", NAME(type->name));
        }
        return;
    }
    if (target != check->current) {
        type->target = target;
        return;
    }
    if (check->contains_itself) {
        return;
    }
    check->contains_itself = true;
    const char *what = target->declaration->type.kind == TYPE_RECORD ? "struct" : "type";
    diagnostics_error(check->diagnostics, &target->place, target->name.length,
                      "%s `%.*s' contains itself", what, NAME(target->name));
    diagnostics_note(check->diagnostics, &type->place, type->name.length, "it is used here");
}

/* -------------------------------------------------------------------- dimensions */

static void check_dimension(struct check *check, enum array_kind array,
                            const struct dimension *dimension)
{
    if (array == ARRAY_FIXED && (dimension->value < 1 || dimension->value > INT32_MAX)) {
        diagnostics_error(check->diagnostics, &dimension->place, dimension->width,
                          "array dimension must be between 1 and 2147483647");
    } else if (array != ARRAY_FIXED && dimension->value < 0) {
        diagnostics_warning(check->diagnostics, &dimension->place, dimension->width,
                            "negative limit ignored");
    }
}

static void check_dimensions(struct check *check, const struct declaration *declaration)
{
    for (size_t i = 0; i < declaration->dimensions.count; i++) {
        check_dimension(check, declaration->array, &declaration->dimensions.items[i]);
    }
    check_dimension(check, ARRAY_VARIABLE, &declaration->length_limit);
}

/* Whether a field can be the size of a variable array; warns of doubtful ones. */
static bool check_size_field(struct check *check, const struct declaration *size,
                             const struct declaration *array)
{
    const struct meaning meaning = declaration_meaning(size);
    const char *doubt = NULL;
    if (meaning.shape == SHAPE_ENUM) {
        doubt = "is an enum";
    } else if (meaning.shape == SHAPE_EXTERNAL) {
        doubt = "has a type that is not defined here; it must be an int or unsigned int";
    } else if (meaning.is_integer_array) {
        doubt = "is itself an array; its first element is used";
    } else if (meaning.shape != SHAPE_INTEGER) {
        return false;
    }
    if (doubt != NULL) {
        diagnostics_warning(check->diagnostics, &size->place, size->name.length,
                            "dimension field `%.*s' of variable-length array `%.*s' %s",
                            NAME(size->name), NAME(array->name), doubt);
    }
    return true;
}

/* The fields in front of a variable array say how long it is in each dimension. */
static void check_sizes(struct check *check, const struct record *record, size_t position)
{
    const struct declaration *array = record->fields[position];
    const size_t count = array->dimensions.count;
    bool right = count <= position;
    for (size_t i = position - count; right && i < position; i++) {
        right = check_size_field(check, record->fields[i], array);
    }
    if (right) {
        return;
    }
    diagnostics_error(check->diagnostics, &array->place, array->name.length,
                      "variable-length array `%.*s' isn't preceded by the right number of int or "
                      "unsigned int fields",
                      NAME(array->name));
    diagnostics_same_as_classic(check->diagnostics);
}

/* ------------------------------------------------------------------------- types */

static void check_enumeration(struct check *check, struct enumeration *enumeration,
                              struct table *scope)
{
    for (size_t i = 0; i < enumeration->count; i++) {
        struct enumerator *item = &enumeration->items[i];
        declare(check, scope, item->name, &item->place, "enumerator");
        if (item->value < INT32_MIN || item->value > INT32_MAX) {
            diagnostics_warning(check->diagnostics, &item->place, item->name.length,
                                "the value of `%.*s' does not fit into an int", NAME(item->name));
        }
    }
}

static void check_declaration(struct check *check, struct declaration *declaration,
                              struct table *scope);

static void check_field(struct check *check, struct record *record, size_t position,
                        struct table *fields, struct table *enumerators)
{
    struct declaration *field = record->fields[position];
    declare(check, fields, field->name, &field->place, "field");
    check_declaration(check, field, enumerators);
    if (field->array == ARRAY_VARIABLE && !record->is_damaged) {
        check_sizes(check, record, position);
    }
    const struct meaning meaning = declaration_meaning(field);
    if (meaning.element != NULL && meaning.element->kind == TYPE_RECORD &&
        meaning.element->record->n_fields == 0 && !meaning.element->record->is_damaged) {
        diagnostics_warning(check->diagnostics, &field->type.place, 1,
                            "empty structure cannot be part of a message");
    }
}

static void check_record(struct check *check, struct record *record, struct table *scope)
{
    if (record->depth > TREE_MAX_DEPTH) {
        return; /* has been reported */
    }
    struct table fields;
    table_init(&fields, TABLE_EXACT);
    for (size_t i = 0; i < record->n_fields; i++) {
        check_field(check, record, i, &fields, check->language == LANGUAGE_CXX ? &fields : scope);
    }
    table_fini(&fields);
}

static void check_declaration(struct check *check, struct declaration *declaration,
                              struct table *scope)
{
    check_dimensions(check, declaration);
    switch (declaration->type.kind) {
    case TYPE_RECORD:
        check_record(check, declaration->type.record, scope);
        break;
    case TYPE_ENUM:
        check_enumeration(check, declaration->type.enumeration, scope);
        break;
    case TYPE_NAMED:
        resolve(check, &declaration->type);
        break;
    default:
        break;
    }
}

/* ------------------------------------------------------------------- definitions */

/* The header gives each structure of C++ this function. */
static void check_added_member(struct check *check, const struct definition *definition)
{
    const struct record *record = definition->declaration->type.record;
    if (check->language != LANGUAGE_CXX || !definition_is_record(definition)) {
        return;
    }
    for (size_t i = 0; i < record->n_fields; i++) {
        if (text_equal(record->fields[i]->name, text_of("getIPCFormat"))) {
            diagnostics_error(check->diagnostics, &record->fields[i]->place, 12,
                              "`getIPCFormat' is a member that the header adds");
        }
    }
}

static void check_type(struct check *check, struct definition *definition)
{
    struct declaration *declaration = definition->declaration;
    declare(check, &check->file_scope, definition->name, &definition->place, "type");
    (void)put(&check->types, definition->name, definition);
    check->current = definition;
    check->contains_itself = false;
    if (declaration->array == ARRAY_VARIABLE) {
        diagnostics_error(check->diagnostics, &declaration->place, declaration->name.length,
                          "variable-length array `%.*s' declared outside a struct",
                          NAME(declaration->name));
        diagnostics_same_as_classic(check->diagnostics);
    }
    check_declaration(check, declaration, &check->file_scope);
    check_added_member(check, definition);
    definition->meaning = declaration_meaning(declaration);
    if (definition->meaning.element == &declaration->type) {
        definition->meaning.owner = definition;
    }
    check->current = NULL;
}

void check_tree(struct tree *tree, enum language language, struct diagnostics *diagnostics)
{
    struct check check = {.language = language,
                          .diagnostics = diagnostics,
                          .is_complete = diagnostics->n_errors == 0};
    table_init(&check.types, TABLE_EXACT);
    table_init(&check.file_scope, TABLE_EXACT);
    for (struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind == DEFINITION_FORMAT) {
            (void)put(&check.types, each->name, each);
        } else if (each->kind == DEFINITION_TYPE) {
            check_type(&check, each);
        }
    }
    table_fini(&check.types);
    table_fini(&check.file_scope);
}
