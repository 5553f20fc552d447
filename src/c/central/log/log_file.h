/*
 * The files of the logs.
 */
#ifndef IPC_CENTRAL_LOG_FILE_H
#define IPC_CENTRAL_LOG_FILE_H

#include "central/log/log_output.h"

/* Whether the switches of LOG_FILE or LOG_JSON ask for one. */
bool log_wants_file(const struct log *log, enum which_log which);

/* Opens the file of the options' name, or of a generated one: 0 or ERR_IO, which is said on standard
 * error.  What is in it goes, unless this log has written it. */
int log_open_file(struct log *log, enum which_log which);

/* Writes what waits and closes the file. */
void log_close_file(struct log *log, enum which_log which);

/* Closes all files, with more patience: nothing follows. */
void log_end_files(struct log *log);

/* Starts new files of the same names where the old ones were moved away. */
void log_reopen_files(struct log *log);

/* Lets leave what the files take, and starts a new one where an old one has its size. */
void log_flush_files(struct log *log);

#endif
