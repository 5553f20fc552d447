/*
 * Generated text, gathered in memory so that an error leaves no file behind.
 */
#include "output.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { PRINT_SIZE = 256 };

void output_init(struct output *output)
{
    *output = (struct output){.line = 1};
    buffer_init(&output->text);
}

void output_fini(struct output *output)
{
    buffer_fini(&output->text);
}

void output_text(struct output *output, struct text text)
{
    if (buffer_append(&output->text, text.bytes, text.length) != 0) {
        output->has_failed = true;
    }
    for (size_t i = 0; i < text.length; i++) {
        output->line += text.bytes[i] == '\n';
    }
}

void output_string(struct output *output, const char *string)
{
    output_text(output, text_of(string));
}

void output_print(struct output *output, const char *format, ...)
{
    char text[PRINT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof text) {
        output->has_failed = true; /* names are written by output_text, so this cannot be */
    } else {
        output_text(output, (struct text){text, (size_t)length});
    }
}

void output_indent(struct output *output, size_t level)
{
    for (size_t i = 0; i < level; i++) {
        output_string(output, "  ");
    }
}

void output_quoted(struct output *output, struct text text)
{
    output_string(output, "\"");
    for (size_t i = 0; i < text.length; i++) {
        const unsigned char c = (unsigned char)text.bytes[i];
        if (c == '"' || c == '\\') {
            output_print(output, "\\%c", c);
        } else if (c < ' ') {
            output_print(output, "\\%03o", c);
        } else {
            output_text(output, (struct text){text.bytes + i, 1});
        }
    }
    output_string(output, "\"");
}

void output_json(struct output *output, struct text text)
{
    output_string(output, "\"");
    for (size_t i = 0; i < text.length; i++) {
        const unsigned char c = (unsigned char)text.bytes[i];
        if (c == '"' || c == '\\') {
            output_print(output, "\\%c", c);
        } else if (c < ' ' || c >= 0x7f) {
            output_print(output, "\\u%04x", c);
        } else {
            output_text(output, (struct text){text.bytes + i, 1});
        }
    }
    output_string(output, "\"");
}
