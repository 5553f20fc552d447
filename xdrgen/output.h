/*
 * Generated text, gathered in memory so that an error leaves no file behind.
 */
#ifndef XDRGEN_OUTPUT_H
#define XDRGEN_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/buffer.h"
#include "text.h"

struct output {
    struct buffer text;
    size_t line;     /* the number of the line at the end; the first is 1 */
    bool has_failed; /* memory was out */
};

void output_init(struct output *output);
void output_fini(struct output *output);

void output_text(struct output *output, struct text text);
void output_string(struct output *output, const char *string);
void output_print(struct output *output, const char *format, ...);

/* Two blanks for each level. */
void output_indent(struct output *output, size_t level);

/* Text as it stands between quotes in C, Python and JSON (which knows fewer escapes). */
void output_quoted(struct output *output, struct text text);
void output_json(struct output *output, struct text text);

#endif
