/*
 * The output languages: each emitter writes a whole file from a checked tree.
 */
#ifndef XDRGEN_EMIT_H
#define XDRGEN_EMIT_H

#include "language.h"
#include "output.h"
#include "source.h"
#include "tree.h"

enum directives { DIRECTIVES_PORTABLE, DIRECTIVES_GCC, DIRECTIVES_NONE };

struct emit_options {
    const struct source *source;
    enum language language;
    enum directives directives;
    struct text input_name;  /* as given; "<stdin>" for standard input */
    struct text output_name; /* as given; empty for standard output */
    bool registers;          /* headers define a function that defines the formats at central */
};

/* emit_header writes C and C++; the expansions of format.h must be there for JSON and the formats.
 */
void emit_header(const struct tree *tree, const struct emit_options *options,
                 struct output *output);
void emit_python(const struct tree *tree, const struct emit_options *options,
                 struct output *output);
void emit_json(const struct tree *tree, const struct emit_options *options, struct output *output);

/* A specification again, and lines "NAME: "FORMAT"". */
void emit_specification(const struct tree *tree, struct output *output);
void emit_formats(const struct tree *tree, struct output *output);

/* The words and brackets that specifications, C and C++ have in common. */
const char *emit_type_word(enum type_kind kind);
void emit_fixed_dimensions(struct output *output, const struct declaration *declaration);

/* A name of a file made fit for a comment: without directories, and without what ends comments. */
void emit_comment_name(struct output *output, struct text path);

/* A name of a file made an identifier: every other byte is an underscore. */
void emit_identifier(struct output *output, struct text name);

#endif
