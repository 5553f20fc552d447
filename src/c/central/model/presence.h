/*
 * What scripts and supervisors see of the server while it runs.
 *
 * A file with the number of the process and one with that of the port, on
 * request; and to a supervisor, if there is one, the word that modules may
 * connect, signs of life, and the word that the end has begun.
 */
#ifndef IPC_CENTRAL_PRESENCE_H
#define IPC_CENTRAL_PRESENCE_H

#include "central/settings/options.h"
#include "platform/process.h"

struct presence {
    struct process_file pid_file;
    struct process_file port_file;
    uint64_t sign_interval_ns; /* 0: nobody wants signs of life */
    uint64_t next_sign_ns;
};

/* Writes the files: 0, or ERR_IO with the path of the one that could not be written. */
int presence_begin(struct presence *presence, const struct options *options, const char **path);

/* Modules may connect. */
void presence_tell_ready(struct presence *presence, int port, uint64_t now_ns);

/* Does what is due in this turn of the loop; returns when the next thing is. */
uint64_t presence_turn(struct presence *presence, uint64_t now_ns);

/* The end begins. */
void presence_tell_end(void);

/* Removes the files.  May be called at any time after memory was zeroed. */
void presence_fini(struct presence *presence);

#endif
