/*
 * What several output languages have in common.
 */
#include "emit.h"

#include <ctype.h>

static const char *const type_words[] = {
    [TYPE_CHAR] = "char",         [TYPE_UCHAR] = "unsigned char", [TYPE_INT] = "int",
    [TYPE_UINT] = "unsigned int", [TYPE_FLOAT] = "float",         [TYPE_DOUBLE] = "double",
    [TYPE_BOOL] = "bool",         [TYPE_STRING] = "string",
};

const char *emit_type_word(enum type_kind kind)
{
    return type_words[kind];
}

void emit_fixed_dimensions(struct output *output, const struct declaration *declaration)
{
    if (declaration->array != ARRAY_FIXED) {
        return;
    }
    for (size_t i = 0; i < declaration->dimensions.count; i++) {
        output_print(output, "[%lld]", (long long)declaration->dimensions.items[i].value);
    }
}

void emit_comment_name(struct output *output, struct text path)
{
    const struct text name = text_base_name(path);
    for (size_t i = 0; i < name.length; i++) {
        const unsigned char c = (unsigned char)name.bytes[i];
        output_print(output, "%c", c < ' ' || c == '*' || c == '"' || c == '\\' ? '?' : c);
    }
}

void emit_identifier(struct output *output, struct text name)
{
    for (size_t i = 0; i < name.length; i++) {
        const unsigned char c = (unsigned char)name.bytes[i];
        output_print(output, "%c", c < 0x80 && isalnum(c) ? c : '_');
    }
}

void emit_formats(const struct tree *tree, struct output *output)
{
    for (const struct definition *each = tree->first; each != NULL; each = each->next) {
        if (each->kind != DEFINITION_TYPE) {
            continue;
        }
        output_text(output, each->name);
        output_string(output, ": \"");
        output_string(output, each->expansion != NULL ? each->expansion : "(too long)");
        output_string(output, "\"\n");
    }
}
