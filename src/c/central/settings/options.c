/*
 * The server's options: how they begin and end.
 */
#include "central/settings/options.h"

#include <stdlib.h>
#include <string.h>

#define DEFAULT_PORT 1381
#define DEFAULT_KEPT 5

bool switches_want_file(const struct log_switches *on)
{
    return on->messages || on->status || on->data || on->time || on->summary;
}

void options_init(struct options *options)
{
    memset(options, 0, sizeof *options);
    options->port = DEFAULT_PORT;
    options->expected = 1;
    options->read_commands = true;
    options->terminal.messages = options->terminal.status = options->terminal.ignore = true;
    options->terminal.flush = true;
    options->kept_files = DEFAULT_KEPT;
    options->file.ignore = options->file.flush = true;
    options->json.ignore = options->json.flush = true;
    limits_init(&options->limits);
    full_policies_init(&options->when_full);
    list_init(&options->ignored);
}

void options_fini(struct options *options)
{
    struct list *at, *following;
    LIST_EACH (at, following, &options->ignored) {
        free(LIST_OWNER(at, struct ignored_name, in_options));
    }
    full_policies_fini(&options->when_full);
    free(options->file_name);
    free(options->address);
    free(options->allow_file);
    free(options->deny_file);
    free(options->pid_file);
    free(options->port_file);
    free(options->metrics);
    free(options->json_name);
}
