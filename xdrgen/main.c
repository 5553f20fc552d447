/*
 * xdrgen: from XDR declarations to types and IPC format strings.
 *
 *   main       reads the file, lets the others work, writes the result
 *     options    the command line
 *     platform/  files of the system
 *     source     the input in memory
 *     parse      scanner.l (with scan) and grammar.y build the tree
 *     check      what the grammar cannot express; resolves names
 *     format     the IPC format of a type
 *     emit_...   an output language each
 *     diagnostics  gathers what is to be said about the input
 *
 * Nothing is written before everything is known to be right.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "diagnostics.h"
#include "emit.h"
#include "format.h"
#include "options.h"
#include "parse.h"
#include "platform/file.h"

static bool read_input(const struct options *options, struct source *source)
{
    const char *name = options->input == NULL ? "<stdin>" : options->input;
    char *bytes;
    size_t length;
    switch (file_read(options->input, &bytes, &length)) {
    case FILE_DONE:
        source_init(source, name, bytes, length);
        return true;
    case FILE_NOT_OPENED:
        (void)fprintf(stderr, "xdrgen: couldn't open `%s' for reading: %s\n", name,
                      strerror(errno));
        return false;
    default:
        (void)fprintf(stderr, "xdrgen: couldn't read `%s': %s\n", name, strerror(errno));
        return false;
    }
}

static bool write_output(const char *path, const struct output *output)
{
    const char *name = path == NULL ? "<stdout>" : path;
    enum file_result result = FILE_NOT_WRITTEN;
    errno = ENOMEM;
    if (!output->has_failed) {
        result = file_write(path, output->text.bytes, output->text.length);
    }
    if (result == FILE_NOT_OPENED) {
        (void)fprintf(stderr, "xdrgen: couldn't open `%s' for writing: %s\n", name,
                      strerror(errno));
    } else if (result == FILE_NOT_WRITTEN) {
        (void)fprintf(stderr, "xdrgen: couldn't write `%s': %s\n", name, strerror(errno));
    }
    return result == FILE_DONE;
}

static void announce(const struct options *options, const char *step, struct output *output)
{
    if (options->is_verbose) {
        output_print(output, "\n--- %s\n", step);
    }
}

static void write_language(const struct tree *tree, const struct source *source,
                           const struct options *options, struct output *output)
{
    const struct emit_options emit_options = {
        .source = source,
        .language = options->language,
        .directives = options->directives,
        .input_name = text_of(options->input == NULL ? "<stdin>" : options->input),
        .output_name = text_of(options->output == NULL ? "" : options->output),
        .registers = options->registers,
    };
    switch (options->language) {
    case LANGUAGE_C:
    case LANGUAGE_CXX:
        emit_header(tree, &emit_options, output);
        break;
    case LANGUAGE_PYTHON:
        emit_python(tree, &emit_options, output);
        break;
    case LANGUAGE_JSON:
        emit_json(tree, &emit_options, output);
        break;
    }
}

/* What goes to standard output, as far as it is not the header. */
static void write_reports(const struct tree *tree, const struct options *options,
                          struct output *output)
{
    announce(options, "parsing", output);
    if (options->prints_specification) {
        announce(options, "printing parse tree as XDR spec", output);
        emit_specification(tree, output);
    }
    announce(options, "mapping identifier names", output);
    if (options->prints_formats) {
        announce(options, "outputting IPC formats", output);
        emit_formats(tree, output);
    }
    if (options->writes_header) {
        announce(options, "outputting C header", output);
    }
}

static bool write_results(struct tree *tree, const struct source *source,
                          const struct options *options)
{
    struct output reports;
    struct output header;
    output_init(&reports);
    output_init(&header);
    if (options->prints_formats || options->language == LANGUAGE_JSON) {
        format_expand_all(tree);
    }
    write_reports(tree, options, &reports);
    if (options->writes_header) {
        write_language(tree, source, options, &header);
    }
    bool is_written = reports.text.length == 0 || write_output(NULL, &reports);
    if (is_written && options->writes_header) {
        is_written = write_output(options->output, &header);
    }
    output_fini(&header);
    output_fini(&reports);
    return is_written;
}

static bool process(struct source *source, const struct options *options)
{
    struct tree tree;
    struct diagnostics diagnostics;
    tree_init(&tree);
    diagnostics_init(&diagnostics);
    parse_source(source, &tree, &diagnostics);
    check_tree(&tree, options->language, &diagnostics);
    diagnostics_print(&diagnostics, source, stderr);
    const bool is_right = diagnostics.n_errors == 0 && write_results(&tree, source, options);
    diagnostics_fini(&diagnostics);
    tree_fini(&tree);
    return is_right;
}

int main(int n_arguments, char **arguments)
{
    struct options options;
    struct source source;
    switch (options_read(&options, n_arguments, arguments)) {
    case OPTIONS_DONE:
        return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    case OPTIONS_WRONG:
        return EXIT_FAILURE;
    case OPTIONS_RUN:
        break;
    }
    if (!read_input(&options, &source)) {
        return EXIT_FAILURE;
    }
    const bool is_right = process(&source, &options);
    source_fini(&source);
    return is_right ? EXIT_SUCCESS : EXIT_FAILURE;
}
