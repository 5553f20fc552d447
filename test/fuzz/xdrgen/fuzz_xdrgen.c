/*
 * Fuzz target: the whole of xdrgen behind its command line.
 *
 * The input is a specification.  Whatever it is, it is parsed, checked and its
 * diagnostics are printed.  If it is right, every language is written, and the
 * specification that is printed of it must be right again and give the same
 * header.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "diagnostics.h"
#include "emit.h"
#include "format.h"
#include "parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A specification from its text to its tree. */
struct specification {
    struct source source;
    struct tree tree;
    struct diagnostics diagnostics;
};

static void require(int condition)
{
    if (!condition) {
        abort();
    }
}

static void specification_init(struct specification *specification, const void *bytes, size_t size)
{
    char *copy = calloc(size + 2, 1);
    require(copy != NULL);
    memcpy(copy, bytes, size);
    source_init(&specification->source, "in.xdr", copy, size);
    tree_init(&specification->tree);
    diagnostics_init(&specification->diagnostics);
    parse_source(&specification->source, &specification->tree, &specification->diagnostics);
    check_tree(&specification->tree, LANGUAGE_CXX, &specification->diagnostics);
}

static void specification_fini(struct specification *specification)
{
    diagnostics_fini(&specification->diagnostics);
    tree_fini(&specification->tree);
    source_fini(&specification->source);
}

/* Without line directives, which differ between a specification and its print. */
static struct emit_options options_for(const struct specification *specification,
                                       enum language language)
{
    return (struct emit_options){.source = &specification->source,
                                 .language = language,
                                 .directives = DIRECTIVES_NONE,
                                 .input_name = text_of("in.xdr"),
                                 .output_name = text_of("out.h"),
                                 .registers = true};
}

static void write_languages(struct specification *specification)
{
    struct output output;
    const struct tree *tree = &specification->tree;
    struct emit_options options = options_for(specification, LANGUAGE_C);
    output_init(&output);
    format_expand_all(&specification->tree);
    emit_header(tree, &options, &output);
    options.language = LANGUAGE_PYTHON;
    options.directives = DIRECTIVES_GCC;
    emit_python(tree, &options, &output);
    options.language = LANGUAGE_JSON;
    emit_json(tree, &options, &output);
    emit_formats(tree, &output);
    require(!output.has_failed);
    output_fini(&output);
}

static void write_header(const struct specification *specification, struct output *header)
{
    const struct emit_options options = options_for(specification, LANGUAGE_CXX);
    output_init(header);
    emit_header(&specification->tree, &options, header);
}

/* What is printed of a specification means the same. */
static void read_again(const struct specification *specification)
{
    struct output printed;
    struct output headers[2];
    struct specification again;
    output_init(&printed);
    emit_specification(&specification->tree, &printed);
    specification_init(&again, printed.text.bytes, printed.text.length);
    require(again.diagnostics.n_errors == 0);
    write_header(specification, &headers[0]);
    write_header(&again, &headers[1]);
    require(headers[0].text.length == headers[1].text.length &&
            memcmp(headers[0].text.bytes, headers[1].text.bytes, headers[0].text.length) == 0);
    output_fini(&headers[0]);
    output_fini(&headers[1]);
    output_fini(&printed);
    specification_fini(&again);
}

/* Printing is a part of what is tested; nobody reads it. */
static FILE *nowhere(void)
{
    static FILE *stream = NULL;
    if (stream == NULL) {
        stream = fopen("/dev/null", "w");
    }
    require(stream != NULL);
    return stream;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct specification specification;
    specification_init(&specification, data, size);
    diagnostics_print(&specification.diagnostics, &specification.source, nowhere());
    if (specification.diagnostics.n_errors == 0) {
        write_languages(&specification);
        read_again(&specification);
    }
    specification_fini(&specification);
    return 0;
}
