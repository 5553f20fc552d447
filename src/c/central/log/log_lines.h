/*
 * Lines that are the same in both logs for people, of any class.
 *
 * The exact text of every line that is not the caller's is made here and in
 * log_dispatch, because log viewers and scripts read it.
 */
#ifndef IPC_CENTRAL_LOG_LINES_H
#define IPC_CENTRAL_LOG_LINES_H

#include "central/log/log_output.h"

/* To both logs, whatever the switches. */
void log_always(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class. */
void log_status(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class: a message is defined anew.  Logs that ignore leave it out. */
void log_redefined(struct log *log, const struct message *message);

/* Message class, but about no dispatch. */
void log_notice(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Status class: something that a module did is ignored, or ends its connection. */
void log_warning(struct log *log, const struct module *module, const char *format, ...)
    LIKE_PRINTF(3, 4);

/* Terminal only, not when silent: banner, prompt, answers to commands. */
void log_terminal(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* File only. */
void log_file(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* To both logs: a question.  On the terminal its answer stands in the same line. */
void log_question(struct log *log, const char *format, ...) LIKE_PRINTF(2, 3);

/* Handled-time summary of one message. */
struct log_summary {
    uint64_t count;
    double message_share; /* of the working time before, in percent */
    uint64_t bytes;
    uint64_t milliseconds;
    uint64_t average_bytes;
    uint64_t average_milliseconds;
};

void log_summarise(struct log *log, const struct log_summary *summary);

#endif
