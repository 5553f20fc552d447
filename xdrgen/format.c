/*
 * The IPC format of a declaration.
 */
#include "format.h"

#include <string.h>

#include "base/limits.h"
#include "base/memory.h"

static const char *const simple_formats[] = {
    [TYPE_CHAR] = "char", [TYPE_UCHAR] = "ubyte",   [TYPE_INT] = "int",
    [TYPE_UINT] = "uint", [TYPE_FLOAT] = "float",   [TYPE_DOUBLE] = "double",
    [TYPE_BOOL] = "char", [TYPE_STRING] = "string",
};

/* position: the 1-based place among the fields of the structure around it; 0: none. */
static void write_declaration(struct output *output, const struct declaration *declaration,
                              size_t position, format_name_writer *write_name);

static void write_enumeration(struct output *output, const struct enumeration *enumeration)
{
    if (enumeration->has_values) {
        output_string(output, "int");
        return;
    }
    for (size_t i = 0; i < enumeration->count; i++) {
        output_string(output, i == 0 ? "{enum " : ",");
        output_text(output, enumeration->items[i].name);
    }
    output_string(output, "}");
}

static void write_record(struct output *output, const struct record *record,
                         format_name_writer *write_name)
{
    output_string(output, "{");
    for (size_t i = 0; i < record->n_fields; i++) {
        if (i > 0) {
            output_string(output, ",");
        }
        write_declaration(output, record->fields[i], i + 1, write_name);
    }
    output_string(output, "}");
}

static void write_type(struct output *output, const struct type *type,
                       format_name_writer *write_name)
{
    switch (type->kind) {
    case TYPE_RECORD:
        write_record(output, type->record, write_name);
        break;
    case TYPE_ENUM:
        write_enumeration(output, type->enumeration);
        break;
    case TYPE_NAMED:
        write_name(output, type);
        break;
    default:
        output_string(output, simple_formats[type->kind]);
    }
}

static void write_fixed_array(struct output *output, const struct declaration *declaration,
                              format_name_writer *write_name)
{
    output_string(output, "[");
    write_type(output, &declaration->type, write_name);
    for (size_t i = 0; i < declaration->dimensions.count; i++) {
        output_print(output, "%c%lld", i == 0 ? ':' : ',',
                     (long long)declaration->dimensions.items[i].value);
    }
    output_string(output, "]");
}

/* The sizes of a variable array are the fields directly in front of it. */
static void write_variable_array(struct output *output, const struct declaration *declaration,
                                 size_t position, format_name_writer *write_name)
{
    const size_t count = declaration->dimensions.count;
    output_string(output, "<");
    write_type(output, &declaration->type, write_name);
    for (size_t i = 0; i < count; i++) {
        output_print(output, "%c%zu", i == 0 ? ':' : ',', position - count + i);
    }
    output_string(output, ">");
}

static void write_declaration(struct output *output, const struct declaration *declaration,
                              size_t position, format_name_writer *write_name)
{
    switch (declaration->array) {
    case ARRAY_NONE:
        write_type(output, &declaration->type, write_name);
        break;
    case ARRAY_FIXED:
        write_fixed_array(output, declaration, write_name);
        break;
    case ARRAY_VARIABLE:
        write_variable_array(output, declaration, position, write_name);
        break;
    }
}

void format_write(struct output *output, const struct declaration *declaration,
                  format_name_writer *write_name)
{
    write_declaration(output, declaration, 0, write_name);
}

/* -------------------------------------------------------------------- expansions */

static void write_expansion(struct output *output, const struct type *type)
{
    const struct definition *target = type->target;
    if (output->has_failed) {
        return;
    }
    if (target != NULL && target->kind == DEFINITION_TYPE && target->expansion == NULL) {
        output->has_failed = true;
    } else if (target == NULL || target->expansion == NULL) {
        output_text(output, type->name);
    } else {
        output_string(output, target->expansion);
    }
    if (output->text.length > LIMIT_FORMAT_TEXT) {
        output->has_failed = true;
    }
}

/* A format given by ipc_type, unless it holds quotes, which splice macros into the header. */
static char *expand_external(const struct definition *definition)
{
    if (definition->format == NULL || strchr(definition->format, '"') != NULL) {
        return NULL;
    }
    return mem_copy_string(definition->format);
}

static char *expand_type(const struct definition *definition)
{
    struct output output;
    char *expansion = NULL;
    output_init(&output);
    format_write(&output, definition->declaration, write_expansion);
    if (!output.has_failed && output.text.length <= LIMIT_FORMAT_TEXT) {
        expansion = mem_copy_text((const char *)output.text.bytes, output.text.length);
    }
    output_fini(&output);
    return expansion;
}

void format_expand_all(struct tree *tree)
{
    for (struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind == DEFINITION_FORMAT) {
            each->expansion = expand_external(each);
        } else if (each->kind == DEFINITION_TYPE) {
            each->expansion = expand_type(each);
        }
    }
}
