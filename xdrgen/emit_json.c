/*
 * A description in JSON: for every type its name, where it stands, its format
 * and its parts, for programs that read rather than compile.
 */
#include "emit.h"

struct json {
    const struct source *source;
    struct output *output;
    size_t level;
    bool is_empty; /* nothing stands yet in the object or list that is open */
};

static void write_type(struct json *json, const struct type *type);

/* ------------------------------------------------------------------------- frame */

/* Goes to the next line, behind a comma where one is needed. */
static void next(struct json *json)
{
    output_string(json->output, json->is_empty ? "\n" : ",\n");
    output_indent(json->output, json->level);
    json->is_empty = false;
}

static void open(struct json *json, const char *bracket)
{
    output_string(json->output, bracket);
    json->level++;
    json->is_empty = true;
}

static void close(struct json *json, const char *bracket)
{
    json->level--;
    if (!json->is_empty) {
        output_string(json->output, "\n");
        output_indent(json->output, json->level);
    }
    output_string(json->output, bracket);
    json->is_empty = false;
}

static void write_key(struct json *json, const char *key)
{
    next(json);
    output_print(json->output, "\"%s\": ", key);
}

static void write_string(struct json *json, const char *key, struct text value)
{
    write_key(json, key);
    output_json(json->output, value);
}

/* ------------------------------------------------------------------------- parts */

static const char *kind_of(const struct type *type)
{
    switch (type->kind) {
    case TYPE_RECORD:
        return "struct";
    case TYPE_ENUM:
        return "enum";
    case TYPE_NAMED:
        return "named";
    default:
        return emit_type_word(type->kind);
    }
}

static void write_enumeration(struct json *json, const struct enumeration *enumeration)
{
    write_key(json, "values");
    open(json, "[");
    for (size_t i = 0; i < enumeration->count; i++) {
        next(json);
        output_string(json->output, "{\"name\": ");
        output_json(json->output, enumeration->items[i].name);
        output_print(json->output, ", \"value\": %lld}", (long long)enumeration->items[i].value);
    }
    close(json, "]");
}

static void write_numbers(struct json *json, const struct dimensions *dimensions)
{
    output_string(json->output, "[");
    for (size_t i = 0; i < dimensions->count; i++) {
        output_string(json->output, i == 0 ? "" : ", ");
        if (dimensions->items[i].has_value) {
            output_print(json->output, "%lld", (long long)dimensions->items[i].value);
        } else {
            output_string(json->output, "null");
        }
    }
    output_string(json->output, "]");
}

/* The fields that say how long a variable array is. */
static void write_sizes(struct json *json, const struct record *record, size_t position)
{
    const size_t count = record->fields[position]->dimensions.count;
    write_key(json, "sizes");
    output_string(json->output, "[");
    for (size_t i = position - count; i < position; i++) {
        output_string(json->output, i == position - count ? "" : ", ");
        output_json(json->output, record->fields[i]->name);
    }
    output_string(json->output, "]");
}

static void write_array(struct json *json, const struct declaration *declaration)
{
    if (declaration->array == ARRAY_NONE) {
        return;
    }
    write_key(json, declaration->array == ARRAY_FIXED ? "dimensions" : "limits");
    write_numbers(json, &declaration->dimensions);
}

static void write_record(struct json *json, const struct record *record)
{
    write_key(json, "fields");
    open(json, "[");
    for (size_t i = 0; i < record->n_fields; i++) {
        const struct declaration *field = record->fields[i];
        next(json);
        open(json, "{");
        write_string(json, "name", field->name);
        write_type(json, &field->type);
        write_array(json, field);
        if (field->array == ARRAY_VARIABLE) {
            write_sizes(json, record, i);
        }
        close(json, "}");
    }
    close(json, "]");
}

static void write_type(struct json *json, const struct type *type)
{
    write_string(json, "type", type->kind == TYPE_NAMED ? type->name : text_of(kind_of(type)));
    if (type->kind == TYPE_RECORD) {
        write_record(json, type->record);
    } else if (type->kind == TYPE_ENUM) {
        write_enumeration(json, type->enumeration);
    }
}

/* ------------------------------------------------------------------- definitions */

static void write_format(struct json *json, const char *expansion)
{
    write_key(json, "format");
    if (expansion == NULL) {
        output_string(json->output, "null");
    } else {
        output_json(json->output, text_of(expansion));
    }
}

static void write_definition(struct json *json, const struct definition *definition)
{
    next(json);
    open(json, "{");
    write_string(json, "name", definition->name);
    write_string(json, "file", text_of(source_origin(json->source, &definition->place)->name));
    write_key(json, "line");
    output_print(json->output, "%zu", definition->place.line);
    write_format(json, definition->expansion);
    if (definition->kind == DEFINITION_TYPE) {
        write_type(json, &definition->declaration->type);
        write_array(json, definition->declaration);
    } else {
        write_string(json, "type", text_of("external"));
    }
    close(json, "}");
}

void emit_json(const struct tree *tree, const struct emit_options *options, struct output *output)
{
    struct json json = {options->source, output, 0, true};
    open(&json, "{");
    write_string(&json, "generator", text_of("xdrgen " XDRGEN_VERSION));
    write_string(&json, "source", text_base_name(options->input_name));
    write_key(&json, "types");
    open(&json, "[");
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind != DEFINITION_CODE) {
            write_definition(&json, each);
        }
    }
    close(&json, "]");
    close(&json, "}");
    output_string(output, "\n");
}
