/*
 * The two logs, as the files that write lines see them.
 */
#ifndef IPC_CENTRAL_LOG_OUTPUT_H
#define IPC_CENTRAL_LOG_OUTPUT_H

#include "central/log.h"

/* Both logs, so that what is done to one is done to the other. */
enum which_log { LOG_TERMINAL, LOG_FILE, N_LOGS };

const struct log_switches *log_switches_of(const struct log *log, enum which_log which);

/* Whether lines of any kind go there. */
bool log_is_open(const struct log *log, enum which_log which);

/* Puts log->line into one log.  Bells and empty lines in front are for people only: a file gets
 * none. */
void log_put_line(struct log *log, enum which_log which);

#endif
