/*
 * The log: every line that the server writes about its work, and its life as a whole.
 */
#ifndef IPC_CENTRAL_LOG_H
#define IPC_CENTRAL_LOG_H

#include "central/log/log_dispatch.h"
#include "central/log/log_file.h"
#include "central/log/log_lines.h"
#include "central/log/log_output.h"

/* terminal_fd -1: the terminal's text only gathers. */
void log_init(struct log *log, struct options *options, int terminal_fd);
void log_fini(struct log *log);

/* Writes what waits; from here on nothing is written any more. */
void log_close(struct log *log);

/* Lets leave what the streams take; says on standard error when a log file has failed. */
void log_flush(struct log *log);

#endif
