/*
 * The command line.
 *
 * Options and operands may be mixed; of repeated options the last one counts.
 */
#include "options.h"

#include <string.h>

static const char usage[] = "usage: xdrgen OPTIONS <xdrFile> [outputHeaderFile]\n"
                            " -h or --help        Print this help\n"
                            " --version           Print the version\n"
                            " --lang=[c,c++,python,json]\n"
                            "                     Change language for header output\n"
                            "                     (default: c++)\n"
                            " --register          Add a function to the header that defines\n"
                            "                     the formats of all types at central\n"
                            " --directives=[gcc,portable,none]\n"
                            "                     Control syntax of #line directives\n"
                            "                     that help to trace location of errors\n"
                            "                     (default: portable)\n"
                            " -D<name>=<value>, -I<directory>\n"
                            "                     Accepted and without effect: no C\n"
                            "                     pre-processor is run\n"
                            "### DEBUGGING OPTIONS\n"
                            " -v or --verbose     Talk about parse steps\n"
                            " -n or --no-header   Don't output the header\n"
                            " --spec              Print out parse tree as XDR spec\n"
                            " --formats           Print out IPC formats for all types\n";

static enum options_result complain(const char *before, const char *argument, const char *after)
{
    (void)fprintf(stderr, "xdrgen: %s%s%s\n%s", before, argument, after, usage);
    return OPTIONS_WRONG;
}

struct choice {
    const char *word;
    int value;
};

static const struct choice languages[] = {{"c", LANGUAGE_C},
                                          {"c++", LANGUAGE_CXX},
                                          {"python", LANGUAGE_PYTHON},
                                          {"json", LANGUAGE_JSON},
                                          {NULL, 0}};
static const struct choice directive_styles[] = {{"portable", DIRECTIVES_PORTABLE},
                                                 {"gcc", DIRECTIVES_GCC},
                                                 {"none", DIRECTIVES_NONE},
                                                 {NULL, 0}};

static bool choose(const struct choice *choices, const char *word, int *value)
{
    for (; choices->word != NULL; choices++) {
        if (strcmp(choices->word, word) == 0) {
            *value = choices->value;
            return true;
        }
    }
    return false;
}

/* An option that is either there or not. */
static bool read_switch(struct options *options, const char *argument)
{
    if (strcmp(argument, "-v") == 0 || strcmp(argument, "--verbose") == 0) {
        options->is_verbose = true;
    } else if (strcmp(argument, "-n") == 0 || strcmp(argument, "--no-header") == 0) {
        options->writes_header = false;
    } else if (strcmp(argument, "--spec") == 0) {
        options->prints_specification = true;
    } else if (strcmp(argument, "--formats") == 0) {
        options->prints_formats = true;
    } else if (strcmp(argument, "--register") == 0) {
        options->registers = true;
    } else {
        return strncmp(argument, "-D", 2) == 0 || strncmp(argument, "-I", 2) == 0;
    }
    return true;
}

static enum options_result read_option(struct options *options, const char *argument)
{
    int value;
    if (strcmp(argument, "-h") == 0 || strcmp(argument, "--help") == 0) {
        (void)fputs(usage, stdout);
        return OPTIONS_DONE;
    }
    if (strcmp(argument, "--version") == 0) {
        (void)puts("xdrgen " XDRGEN_VERSION);
        return OPTIONS_DONE;
    }
    if (strncmp(argument, "--lang=", 7) == 0) {
        if (!choose(languages, argument + 7, &value)) {
            return complain("unknown language ", argument + 7, " specified");
        }
        options->language = (enum language)value;
        return OPTIONS_RUN;
    }
    if (strncmp(argument, "--directives=", 13) == 0) {
        if (!choose(directive_styles, argument + 13, &value)) {
            return complain("unknown --directives syntax ", argument + 13, "");
        }
        options->directives = (enum directives)value;
        return OPTIONS_RUN;
    }
    return read_switch(options, argument) ? OPTIONS_RUN : complain("unknown option ", argument, "");
}

enum options_result options_read(struct options *options, int n_arguments, char **arguments)
{
    const char *operands[2] = {NULL, NULL};
    int n_operands = 0;
    bool are_operands = false;
    *options = (struct options){.language = LANGUAGE_CXX, .writes_header = true};
    for (int i = 1; i < n_arguments; i++) {
        const char *argument = arguments[i];
        if (!are_operands && strcmp(argument, "--") == 0) {
            are_operands = true;
        } else if (are_operands || argument[0] != '-' || argument[1] == '\0') {
            if (n_operands == 2) {
                return complain("too many arguments", "", "");
            }
            operands[n_operands++] = argument;
        } else {
            const enum options_result result = read_option(options, argument);
            if (result != OPTIONS_RUN) {
                return result;
            }
        }
    }
    if (n_operands == 0) {
        return complain("not enough arguments", "", "");
    }
    options->input = strcmp(operands[0], "-") == 0 ? NULL : operands[0];
    options->output = operands[1] == NULL || strcmp(operands[1], "-") == 0 ? NULL : operands[1];
    return OPTIONS_RUN;
}
