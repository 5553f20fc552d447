/*
 * A module for Python, to be used with ipc_cffi.
 *
 * Structures become dataclasses that can be made without arguments, enums
 * IntEnums, other types aliases; NAME_IPC_FORMAT is the format, composed as in
 * the C header.  Structures and enums without a name get one of their own, from
 * the names around them.  A name that Python reserves gets an underscore.
 * Code sections are C and left out.
 */
#include "emit.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/table.h"
#include "format.h"

struct python {
    struct output *output;
    struct table names; /* of the module: those of types, and those made up */
};

/* What a field or a definition is in Python. */
struct view {
    const struct declaration *declaration;
    struct meaning meaning;
    char *class_name; /* of the structure or enum, if any; freed with the view */
};

/* Where a name stands, and so which words it cannot be. */
enum scope { SCOPE_MODULE, SCOPE_CLASS, SCOPE_ENUM };

static const char *const keywords[] = {
    "False", "None",     "True",  "and",    "as",   "assert", "async",  "await",    "break",
    "class", "continue", "def",   "del",    "elif", "else",   "except", "finally",  "for",
    "from",  "global",   "if",    "import", "in",   "is",     "lambda", "nonlocal", "not",
    "or",    "pass",     "raise", "return", "try",  "while",  "with",   "yield",    NULL};

/* What the module uses itself, or its classes have already. */
static const char *const used[][10] = {
    [SCOPE_MODULE] = {"str", "range", "enum", "dataclass", "field", "Any", "ClassVar", "List",
                      NULL},
    [SCOPE_CLASS] = {"field", "IPC_FORMAT", "_fields", NULL},
    [SCOPE_ENUM] = {"mro", "name", "value", NULL},
};

/* ------------------------------------------------------------------------- names */

static bool is_among(const char *const *words, struct text name)
{
    for (; *words != NULL; words++) {
        if (text_equal(name, text_of(*words))) {
            return true;
        }
    }
    return false;
}

/* Underscores at both ends mean something to enums, two in front of it something to classes. */
static bool is_special(struct text name)
{
    return name.length > 1 && name.bytes[0] == '_' &&
           (name.bytes[1] == '_' || name.bytes[name.length - 1] == '_');
}

static void write_name(struct output *output, struct text name, enum scope scope)
{
    if (name.length > 1 && name.bytes[0] == '_' && name.bytes[1] == '_') {
        output_string(output, "x");
    }
    output_text(output, name);
    if (is_among(keywords, name) || is_among(used[scope], name) || is_special(name)) {
        output_string(output, "_");
    }
}

/* The name of a definition as a string; the caller frees it. */
static char *name_of(struct text name)
{
    struct output output;
    output_init(&output);
    write_name(&output, name, SCOPE_MODULE);
    char *result = mem_copy_text((const char *)output.text.bytes, output.text.length);
    output_fini(&output);
    return result;
}

/* A name for what stands without one in something called parent; the caller frees it. */
static char *make_up_name(struct python *python, const char *parent, struct text field)
{
    const size_t length = strlen(parent);
    char *name = mem_new(length + field.length + 32);
    memcpy(name, parent, length);
    name[length] = '_';
    memcpy(name + length + 1, field.bytes, field.length);
    size_t end = length + 1 + field.length;
    while (table_find(&python->names, name) != NULL) {
        name[end++] = '_';
    }
    (void)table_put(&python->names, name, python);
    return name;
}

/* ----------------------------------------------------------------------- formats */

static void write_format_name(struct output *output, const struct type *type)
{
    const struct definition *target = type->target;
    const bool is_own = target != NULL && target->kind == DEFINITION_TYPE;
    if (is_own) {
        output_string(output, "\" + ");
        write_name(output, type->name, SCOPE_MODULE);
        output_string(output, "_IPC_FORMAT + \"");
        return;
    }
    const bool has_text =
        target != NULL && target->format != NULL && strchr(target->format, '"') == NULL;
    output_text(output, has_text ? text_of(target->format) : type->name);
}

static void write_format(struct python *python, const struct declaration *declaration)
{
    write_name(python->output, declaration->name, SCOPE_MODULE);
    output_string(python->output, "_IPC_FORMAT = \"");
    format_write(python->output, declaration, write_format_name);
    output_string(python->output, "\"\n");
}

/* --------------------------------------------------------------- types of values */

static const char *scalar_class(enum type_kind kind)
{
    switch (kind) {
    case TYPE_INT:
    case TYPE_UINT:
    case TYPE_UCHAR:
        return "int";
    case TYPE_FLOAT:
    case TYPE_DOUBLE:
        return "float";
    default:
        return "str"; /* a char is a string of one; so is a bool, whose format is char */
    }
}

static void write_element_class(struct output *output, const struct view *view)
{
    const struct type *type = &view->declaration->type;
    if (type->kind == TYPE_NAMED && type->target != NULL && type->target->kind == DEFINITION_TYPE) {
        write_name(output, type->name, SCOPE_MODULE);
    } else if (type->kind == TYPE_NAMED) {
        output_string(output, "Any");
    } else if (view->class_name != NULL) {
        output_string(output, view->class_name);
    } else {
        output_string(output, scalar_class(type->kind));
    }
}

static void write_class(struct output *output, const struct view *view)
{
    const struct declaration *declaration = view->declaration;
    const size_t levels = declaration->array == ARRAY_NONE ? 0 : declaration->dimensions.count;
    for (size_t i = 0; i < levels; i++) {
        output_string(output, "List[");
    }
    write_element_class(output, view);
    for (size_t i = 0; i < levels; i++) {
        output_string(output, "]");
    }
}

/* The first value of a type that is neither structure nor enum. */
static const char *scalar_value(enum type_kind kind)
{
    switch (kind) {
    case TYPE_INT:
    case TYPE_UINT:
    case TYPE_UCHAR:
        return "0";
    case TYPE_FLOAT:
    case TYPE_DOUBLE:
        return "0.0";
    case TYPE_STRING:
        return "\"\"";
    default:
        return "\"\\0\"";
    }
}

/* Whether the type of an element is the name of an array. */
static bool is_named_array(const struct view *view)
{
    const struct type *type = &view->declaration->type;
    return type->kind == TYPE_NAMED && type->target != NULL &&
           type->target->kind == DEFINITION_TYPE && type->target->meaning.shape == SHAPE_ARRAY;
}

/* An expression for the first value of one element. */
static void write_element_value(struct output *output, const struct view *view)
{
    const struct type *element = view->meaning.element;
    if (is_named_array(view)) {
        output_string(output, "_new_");
        write_element_class(output, view);
        output_string(output, "()");
    } else if (element == NULL) {
        output_string(output, "None");
    } else if (element->kind == TYPE_RECORD) {
        write_element_class(output, view);
        output_string(output, "()");
    } else if (element->kind == TYPE_ENUM) {
        write_element_class(output, view);
        output_print(output, "(%lld)", (long long)element->enumeration->items[0].value);
    } else {
        output_string(output, scalar_value(element->kind));
    }
}

/* An expression for the first value of the whole: fixed arrays are full, variable ones empty. */
static void write_value(struct output *output, const struct view *view)
{
    const struct declaration *declaration = view->declaration;
    const struct dimensions *dimensions = &declaration->dimensions;
    if (declaration->array == ARRAY_VARIABLE) {
        output_string(output, "[]");
        return;
    }
    for (size_t i = 0; i < dimensions->count; i++) {
        output_string(output, "[");
    }
    write_element_value(output, view);
    for (size_t i = dimensions->count; i > 0; i--) {
        output_print(output, " for _ in range(%lld)]", (long long)dimensions->items[i - 1].value);
    }
}

/* ----------------------------------------------------------------------- classes */

static void write_record(struct python *python, const char *name, const struct record *record,
                         struct text format_name);

static void write_enumeration(struct python *python, const char *name,
                              const struct enumeration *enumeration)
{
    struct output *output = python->output;
    output_string(output, "\n\nclass ");
    output_string(output, name);
    output_string(output, "(enum.IntEnum):\n");
    for (size_t i = 0; i < enumeration->count; i++) {
        output_string(output, "    ");
        write_name(output, enumeration->items[i].name, SCOPE_ENUM);
        output_print(output, " = %lld\n", (long long)enumeration->items[i].value);
    }
}

/* Writes the class of an anonymous body, which is called parent_field. */
static struct view view_field(struct python *python, const struct declaration *field,
                              const char *parent)
{
    struct view view = {field, declaration_meaning(field), NULL};
    if (field->type.kind == TYPE_RECORD || field->type.kind == TYPE_ENUM) {
        view.class_name = make_up_name(python, parent, field->name);
    }
    if (field->type.kind == TYPE_RECORD) {
        write_record(python, view.class_name, field->type.record, (struct text){NULL, 0});
    } else if (field->type.kind == TYPE_ENUM) {
        write_enumeration(python, view.class_name, field->type.enumeration);
    }
    return view;
}

/* The class of the structure that a field is, or has elements of. */
static void write_element_record(struct output *output, const struct view *view)
{
    const struct definition *owner = view->meaning.owner;
    if (owner == NULL) {
        output_string(output, view->class_name);
        return;
    }
    output_string(output, definition_is_record(owner) ? "" : "_item_of_");
    write_name(output, owner->name, SCOPE_MODULE);
}

/* Entries of _fields: the name, and the class where there is a structure inside. */
static void write_field_names(struct output *output, const struct view *views, size_t count)
{
    output_string(output, "    _fields: ClassVar[tuple] = (");
    for (size_t i = 0; i < count; i++) {
        const struct type *element = views[i].meaning.element;
        const bool has_class = element != NULL && element->kind == TYPE_RECORD;
        output_string(output, i == 0 ? "" : " ");
        output_string(output, has_class ? "(\"" : "\"");
        write_name(output, views[i].declaration->name, SCOPE_CLASS);
        output_string(output, "\"");
        if (has_class) {
            output_string(output, ", ");
            write_element_record(output, &views[i]);
            output_string(output, ")");
        }
        output_string(output, ",");
    }
    output_string(output, ")\n");
}

/* A value that cannot be changed is given as it is, any other made anew for each object. */
static void write_field(struct output *output, const struct view *view)
{
    const bool is_new = view->meaning.shape == SHAPE_ARRAY || view->meaning.shape == SHAPE_RECORD;
    output_string(output, "    ");
    write_name(output, view->declaration->name, SCOPE_CLASS);
    output_string(output, ": ");
    write_class(output, view);
    output_string(output, is_new ? " = field(default_factory=lambda: " : " = ");
    write_value(output, view);
    output_string(output, is_new ? ")\n" : "\n");
}

static void write_record(struct python *python, const char *name, const struct record *record,
                         struct text format_name)
{
    struct output *output = python->output;
    struct view *views = mem_new((record->n_fields + 1) * sizeof *views);
    for (size_t i = 0; i < record->n_fields; i++) {
        views[i] = view_field(python, record->fields[i], name);
    }
    output_string(output, "\n\n@dataclass\nclass ");
    output_string(output, name);
    output_string(output, ":\n");
    if (format_name.bytes != NULL) {
        output_string(output, "    IPC_FORMAT: ClassVar[str] = ");
        write_name(output, format_name, SCOPE_MODULE);
        output_string(output, "_IPC_FORMAT\n");
    }
    write_field_names(output, views, record->n_fields);
    for (size_t i = 0; i < record->n_fields; i++) {
        write_field(output, &views[i]);
        free(views[i].class_name);
    }
    free(views);
}

/* ------------------------------------------------------------------- definitions */

/* An alias; for an array also a function that makes one, and the class of its structures. */
static void write_alias(struct python *python, const char *name, const struct declaration *alias)
{
    struct output *output = python->output;
    struct declaration item = {.type = alias->type, .name = text_of("item")};
    struct view view = view_field(python, &item, name);
    view.declaration = alias;
    view.meaning = declaration_meaning(alias);
    if (view.class_name != NULL) {
        output_string(output, "\n\n");
    }
    output_string(output, name);
    output_string(output, " = ");
    write_class(output, &view);
    output_string(output, "\n");
    if (view.class_name != NULL && alias->type.kind == TYPE_RECORD) {
        output_string(output, "_item_of_");
        output_string(output, name);
        output_string(output, " = ");
        output_string(output, view.class_name);
        output_string(output, "\n");
    }
    if (view.meaning.shape == SHAPE_ARRAY) {
        output_string(output, "\n\ndef _new_");
        output_string(output, name);
        output_string(output, "():\n    return ");
        write_value(output, &view);
        output_string(output, "\n\n");
    }
    free(view.class_name);
}

static void write_definition(struct python *python, const struct definition *definition)
{
    const struct declaration *declaration = definition->declaration;
    char *name = name_of(definition->name);
    write_format(python, declaration);
    if (definition_is_record(definition)) {
        write_record(python, name, declaration->type.record, declaration->name);
    } else if (definition_is_enum(definition)) {
        write_enumeration(python, name, declaration->type.enumeration);
    } else {
        write_alias(python, name, declaration);
    }
    output_string(python->output, definition_is_record(definition) || definition_is_enum(definition)
                                      ? "\n\n"
                                      : "\n");
    free(name);
}

void emit_python(const struct tree *tree, const struct emit_options *options, struct output *output)
{
    struct python python = {.output = output};
    table_init(&python.names, TABLE_EXACT);
    output_string(output, "\"\"\"Generated by xdrgen " XDRGEN_VERSION " from ");
    emit_comment_name(output, options->input_name);
    output_string(output, "; do not edit.\"\"\"\nfrom __future__ import annotations\n\nimport "
                          "enum\nfrom dataclasses import dataclass, "
                          "field\nfrom typing import Any, ClassVar, List\n\n");
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind != DEFINITION_TYPE) {
            continue;
        }
        char *name = name_of(each->name);
        (void)table_put(&python.names, name, &python);
        free(name);
    }
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind == DEFINITION_TYPE) {
            write_definition(&python, each);
        }
    }
    table_fini(&python.names);
}
