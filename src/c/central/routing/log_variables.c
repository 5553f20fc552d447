/*
 * The switches of the two logs as variables.
 */
#include "central/routing/log_variables.h"

#include "central/routing/value.h"

/* The format as modules have always seen it registered. */
#define REGISTERED_FORMAT "{*int,int,int,int,int,int,int,int,int,int,int,int}"

/* The value, laid out as the format says. */
struct log_options {
    int *file; /* once the address of the open file, which nobody can use: NULL */
    int messages;
    int status;
    int time;
    int data;
    int summary;
    int references;
    int parents;
    int quiet;
    int flush;
    int ignore;
    int ignore_now;
};

static void set(struct server *server, struct variable *variable, const struct log_switches *on,
                bool quiet)
{
    const struct log_options value = {
        .file = NULL,
        .messages = on->messages,
        .status = on->status,
        .time = on->time,
        .data = on->data,
        .summary = on->summary,
        .references = on->references,
        .parents = on->parents,
        .quiet = quiet,
        .flush = on->flush,
        .ignore = on->ignore,
        .ignore_now = 0,
    };
    value_set_own(server, variable, &value);
}

void log_variables_set_terminal(struct server *server)
{
    set(server, server->terminal_log, &server->options->terminal, server->options->silent);
}

void log_variables_set_file(struct server *server)
{
    set(server, server->file_log, &server->options->file, false);
}

void log_variables_define(struct server *server)
{
    struct format *format = server->catalogue.log_options;
    server->terminal_log =
        variable_define_own(server, VARIABLE_TERMINAL_LOG, REGISTERED_FORMAT, format);
    server->file_log = variable_define_own(server, VARIABLE_FILE_LOG, REGISTERED_FORMAT, format);
    log_variables_set_terminal(server);
    log_variables_set_file(server);
}
