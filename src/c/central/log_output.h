/*
 * The logs, as the files that write lines see them.
 */
#ifndef IPC_CENTRAL_LOG_OUTPUT_H
#define IPC_CENTRAL_LOG_OUTPUT_H

#include "central/log.h"

const struct log_switches *log_switches_of(const struct log *log, enum which_log which);

/* Whether lines of any kind go there. */
bool log_is_open(const struct log *log, enum which_log which);

/* Puts a text, or log->line, into one log.  Bells and empty lines in front are for people only: a
 * file gets none. */
void log_put_text(struct log *log, enum which_log which, const struct buffer *text);
void log_put_line(struct log *log, enum which_log which);

/* Class of a message as the logs name it. */
const char *log_class_name(uint16_t class);

/* The file of LOG_FILE or LOG_JSON. */
struct log_file *log_file_of(struct log *log, enum which_log which);

#endif
