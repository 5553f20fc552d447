/*
 * Headers for C and C++.
 *
 * For every type T its declaration, and the macro T_IPC_FORMAT.  The order of
 * tokens, the names of tags and macros, and where the literals of a format are
 * cut are those of CMU IPC's xdrgen, so that old programs see no difference.
 */
#include "emit.h"

#include "format.h"

struct header {
    const struct emit_options *options;
    struct output *output;
};

/* bool in C: one byte, as in C++, and whatever the language has to offer if it has bool itself. */
static const char bool_block[] =
    "#if !defined(__cplusplus) && !defined(__xdr_bool)\n"
    "#define __xdr_bool 1\n"
    "#if !defined(__bool_true_false_are_defined) \\\n"
    "    && (!defined(__STDC_VERSION__) || __STDC_VERSION__ < 202311L)\n"
    "typedef char bool;\n"
    "#define false (0)\n"
    "#define true  (1)\n"
    "#endif\n"
    "#endif /* __xdr_bool */\n\n";

/* ----------------------------------------------------------------- code sections */

static void write_back_reference(const struct header *header)
{
    struct output *output = header->output;
    if (header->options->directives == DIRECTIVES_NONE) {
        output_string(output, "\n");
        return;
    }
    const struct text name = header->options->output_name;
    output_print(output, "#line %zu ", output->line + 1);
    output_quoted(output, name.length > 0 ? name : text_of("<stdout>"));
    output_string(output, "\n");
}

static void write_code(const struct header *header, const struct code *code)
{
    struct output *output = header->output;
    if (code->text.bytes == NULL) {
        return;
    }
    if (header->options->directives != DIRECTIVES_NONE) {
        output_print(output, "#line %zu ", code->place.line);
        output_quoted(output, text_of(source_origin(header->options->source, &code->place)->name));
    }
    output_string(output, "\n");
    output_text(output, code->text);
    if (code->text.length > 0 && code->text.bytes[code->text.length - 1] != '\n') {
        output_string(output, "\n");
    }
    write_back_reference(header);
}

/* ------------------------------------------------------------------------ macros */

/* Another type within a literal: its macro between two literals, or the text given for it. */
static void write_format_name(struct output *output, const struct type *type)
{
    const struct definition *target = type->target;
    if (target != NULL && target->kind == DEFINITION_FORMAT && target->format != NULL) {
        output_string(output, target->format);
        return;
    }
    output_string(output, "\" ");
    output_text(output, type->name);
    output_string(output, "_IPC_FORMAT \"");
}

static void write_format_macro(const struct header *header, const struct declaration *declaration)
{
    struct output *output = header->output;
    output_string(output, "#define ");
    output_text(output, declaration->name);
    output_string(output, "_IPC_FORMAT \"");
    format_write(output, declaration, write_format_name);
    output_string(output, "\"\n");
}

/* ------------------------------------------------------------------------- types */

static void write_field(const struct header *header, const struct declaration *field, size_t level);

static void write_fields(const struct header *header, const struct record *record, size_t level)
{
    for (size_t i = 0; i < record->n_fields; i++) {
        write_field(header, record->fields[i], level);
    }
}

static void write_enumerators(struct output *output, const struct enumeration *enumeration,
                              size_t level)
{
    for (size_t i = 0; i < enumeration->count; i++) {
        const struct enumerator *item = &enumeration->items[i];
        output_indent(output, level);
        output_text(output, item->name);
        if (item->has_value) {
            output_print(output, " = %lld", (long long)item->value);
        }
        output_string(output, i + 1 < enumeration->count ? ",\n" : "\n");
    }
}

/* The type in front of a name; the body of an anonymous one ends with its brace. */
static void write_type(const struct header *header, const struct type *type, size_t level)
{
    struct output *output = header->output;
    switch (type->kind) {
    case TYPE_RECORD:
        output_string(output, "struct {\n");
        write_fields(header, type->record, level + 1);
        write_code(header, &type->record->code);
        output_indent(output, level);
        output_string(output, "}");
        break;
    case TYPE_ENUM:
        output_string(output, "enum {\n");
        write_enumerators(output, type->enumeration, level + 1);
        output_indent(output, level);
        output_string(output, "}");
        break;
    case TYPE_NAMED:
        output_text(output, type->name);
        break;
    default:
        output_string(output, type->kind == TYPE_STRING ? "char" : emit_type_word(type->kind));
    }
}

/* A variable array is one pointer, whatever its dimensions; so is a string. */
static void write_declarator(struct output *output, const struct declaration *declaration)
{
    output_string(output, " ");
    if (declaration->type.kind == TYPE_STRING) {
        output_string(output, "*");
    }
    if (declaration->array == ARRAY_VARIABLE) {
        output_string(output, "*");
    }
    output_text(output, declaration->name);
    emit_fixed_dimensions(output, declaration);
    output_string(output, ";\n");
}

static void write_field(const struct header *header, const struct declaration *field, size_t level)
{
    output_indent(header->output, level);
    write_type(header, &field->type, level);
    write_declarator(header->output, field);
}

/* ------------------------------------------------------------------- definitions */

/* What C has in front of the braces of a body, and C++ for arrays. */
static void write_tagged_typedef(struct output *output, const char *word, struct text name)
{
    output_print(output, "\ntypedef %s _", word);
    output_text(output, name);
    output_string(output, " {\n");
}

static void write_c_body(const struct header *header, const struct declaration *declaration)
{
    struct output *output = header->output;
    const struct type *type = &declaration->type;
    write_tagged_typedef(output, type->kind == TYPE_RECORD ? "struct" : "enum", declaration->name);
    if (type->kind == TYPE_RECORD) {
        write_fields(header, type->record, 1);
        write_code(header, &type->record->code);
    } else {
        write_enumerators(output, type->enumeration, 1);
    }
    output_string(output, "}");
    write_declarator(output, declaration);
    write_format_macro(header, declaration);
}

static void write_cxx_struct(const struct header *header, const struct declaration *declaration)
{
    struct output *output = header->output;
    output_string(output, "\nstruct ");
    output_text(output, declaration->name);
    output_string(output, " {\n");
    write_fields(header, declaration->type.record, 1);
    write_format_macro(header, declaration);
    output_string(output, "  static const char *getIPCFormat(void) {\n    return ");
    output_text(output, declaration->name);
    output_string(output, "_IPC_FORMAT;\n  }\n");
    write_code(header, &declaration->type.record->code);
    output_string(output, "};\n");
}

static void write_cxx_enum(const struct header *header, const struct declaration *declaration)
{
    struct output *output = header->output;
    output_string(output, "\nenum ");
    output_text(output, declaration->name);
    output_string(output, " {\n");
    write_enumerators(output, declaration->type.enumeration, 1);
    output_string(output, "};\n");
    write_format_macro(header, declaration);
}

static void write_plain_typedef(const struct header *header, const struct declaration *declaration)
{
    output_string(header->output, "typedef ");
    write_type(header, &declaration->type, 0);
    write_declarator(header->output, declaration);
    write_format_macro(header, declaration);
}

static void write_definition(const struct header *header, const struct definition *definition)
{
    const bool is_cxx = header->options->language == LANGUAGE_CXX;
    const struct declaration *declaration = definition->declaration;
    if (definition->kind == DEFINITION_CODE) {
        write_code(header, &definition->code);
    } else if (definition->kind == DEFINITION_FORMAT) {
        return;
    } else if (is_cxx && definition_is_record(definition)) {
        write_cxx_struct(header, declaration);
    } else if (is_cxx && definition_is_enum(definition)) {
        write_cxx_enum(header, declaration);
    } else if (declaration->type.kind == TYPE_RECORD || declaration->type.kind == TYPE_ENUM) {
        write_c_body(header, declaration);
    } else {
        write_plain_typedef(header, declaration);
    }
}

/* ------------------------------------------------------------------ registration */

/* The name of the input up to its first dot, which names the function that registers. */
static struct text stem(struct text path)
{
    struct text name = text_base_name(path);
    for (size_t i = 0; i < name.length; i++) {
        if (name.bytes[i] == '.') {
            name.length = i;
        }
    }
    return name;
}

static void write_registration(const struct header *header, const struct tree *tree)
{
    struct output *output = header->output;
    const bool is_cxx = header->options->language == LANGUAGE_CXX;
    output_string(output, "\n#include <ipc.h>\n\n"
                          "/* Defines the formats of this file at central, under the names of their"
                          " types. */\n");
    output_string(output, is_cxx ? "inline" : "static inline");
    output_string(output, " IPC_RETURN_TYPE xdr_register_");
    emit_identifier(output, stem(header->options->input_name));
    output_string(output, "(void)\n{\n");
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind != DEFINITION_TYPE) {
            continue;
        }
        output_string(output, "  if (IPC_defineFormat(\"");
        output_text(output, each->name);
        output_string(output, "\", ");
        output_text(output, each->name);
        output_string(output, "_IPC_FORMAT) != IPC_OK)\n    return IPC_Error;\n");
    }
    output_string(output, "  return IPC_OK;\n}\n");
}

/* ------------------------------------------------------------------------- frame */

static void write_guard(const struct header *header)
{
    const struct text name = text_base_name(header->options->output_name);
    output_string(header->output, "INC");
    emit_identifier(header->output, name.length > 0 ? name : text_of("stdout"));
}

static void write_beginning(const struct header *header)
{
    struct output *output = header->output;
    output_string(output, "/* Generated by xdrgen " XDRGEN_VERSION " from ");
    emit_comment_name(output, header->options->input_name);
    output_string(output, "; do not edit. */\n\n#ifndef ");
    write_guard(header);
    output_string(output, "\n#define ");
    write_guard(header);
    output_string(output, "\n\n");
    if (header->options->language == LANGUAGE_C) {
        output_string(output, bool_block);
    }
}

/* A line by which gcc notes that a file begins (1) or that it returns to one (2). */
static void write_gcc_marker(const struct header *header, int number)
{
    if (header->options->directives != DIRECTIVES_GCC) {
        return;
    }
    output_print(header->output, "# %d ", number);
    output_quoted(header->output, header->options->output_name);
    output_print(header->output, " %d\n", number);
}

void emit_header(const struct tree *tree, const struct emit_options *options, struct output *output)
{
    const struct header header = {options, output};
    write_gcc_marker(&header, 1);
    write_beginning(&header);
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        write_definition(&header, each);
    }
    if (options->registers) {
        write_registration(&header, tree);
    }
    output_string(output, "\n#endif /* ");
    write_guard(&header);
    output_string(output, " */\n");
    write_gcc_marker(&header, 2);
}
