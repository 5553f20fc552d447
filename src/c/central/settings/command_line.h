/*
 * Options on the command line, or typed as commands.
 *
 * One table describes every option: its letter and its word, what it does, and
 * its lines in the listings.  -p1500, --port=1500 and --port 1500 are the same; a
 * letter has its value in the same argument, and letters are not combined.
 */
#ifndef IPC_CENTRAL_COMMAND_LINE_H
#define IPC_CENTRAL_COMMAND_LINE_H

#include <stdbool.h>

#include "base/buffer.h"
#include "central/settings/actions.h"

enum options_result {
    OPTIONS_GO,    /* carry on */
    OPTIONS_SHOWN, /* only something was shown: end well */
    OPTIONS_WRONG  /* the command line is wrong */
};

/* Executes a command line. */
enum options_result options_parse(struct options *options, int count, char *const *arguments,
                                  const struct options_output *output);

/* Executes one option typed while the server runs: 0, or an error that was said on errors. */
int options_type(struct options *options, const char *argument,
                 const struct options_output *output);

/* Appends the version texts of -v, and the lines of -h below its first one, which are as old as the
 * program (typed: without those that make no sense any more). */
void options_show_version(struct buffer *out);
void options_show_help(struct buffer *out, bool typed);

#endif
