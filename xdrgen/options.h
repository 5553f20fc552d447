/*
 * The command line.
 */
#ifndef XDRGEN_OPTIONS_H
#define XDRGEN_OPTIONS_H

#include <stdbool.h>
#include <stdio.h>

#include "emit.h"

enum options_result {
    OPTIONS_RUN,
    OPTIONS_DONE, /* help or version have been printed */
    OPTIONS_WRONG /* has been reported */
};

struct options {
    const char *input;  /* NULL: standard input */
    const char *output; /* NULL: standard output */
    enum language language;
    enum directives directives;
    bool is_verbose;
    bool writes_header;
    bool prints_specification;
    bool prints_formats;
    bool registers;
};

enum options_result options_read(struct options *options, int n_arguments, char **arguments);

#endif
