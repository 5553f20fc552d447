/*
 * What scripts and supervisors see of the server while it runs.
 */
#include "central/model/presence.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "platform/supervisor.h"

static int write_number(struct process_file *file, const char *path, int64_t number)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%" PRId64 "\n", number);
    return process_file_write(file, path, text);
}

int presence_begin(struct presence *presence, const struct options *options, const char **path)
{
    memset(presence, 0, sizeof *presence);
    *path = options->pid_file;
    if (*path != NULL && write_number(&presence->pid_file, *path, process_number()) != 0) {
        return ERR_IO;
    }
    *path = options->port_file;
    if (*path != NULL && write_number(&presence->port_file, *path, options->port) != 0) {
        return ERR_IO;
    }
    return 0;
}

void presence_tell_ready(struct presence *presence, int port, uint64_t now_ns)
{
    char text[64];
    (void)snprintf(text, sizeof text, "READY=1\nSTATUS=Serving on port %d", port);
    supervisor_tell(text);
    /* Twice as often as has to be, so that a busy moment does not matter. */
    presence->sign_interval_ns = supervisor_watchdog_ns() / 2;
    presence->next_sign_ns = now_ns;
}

uint64_t presence_turn(struct presence *presence, uint64_t now_ns)
{
    if (presence->sign_interval_ns == 0) {
        return UINT64_MAX;
    }
    if (now_ns >= presence->next_sign_ns) {
        supervisor_tell("WATCHDOG=1");
        presence->next_sign_ns = now_ns + presence->sign_interval_ns;
    }
    return presence->next_sign_ns;
}

void presence_tell_end(void)
{
    supervisor_tell("STOPPING=1\nSTATUS=Ending");
}

void presence_fini(struct presence *presence)
{
    process_file_remove(&presence->pid_file);
    process_file_remove(&presence->port_file);
}
