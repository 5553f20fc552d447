/*
 * The log for programs: the same content as the others, a JSON object a line.
 */
#ifndef IPC_CENTRAL_LOG_JSON_H
#define IPC_CENTRAL_LOG_JSON_H

#include "central/log/log_output.h"

/* A step in the life of a dispatch; what is NULL is left out. */
struct log_step {
    const char *step;
    const struct dispatch *dispatch;
    const char *from;
    const char *to;
    const char *resource;
    const char *reason; /* of so many bytes */
    int reason_length;
    const uint32_t *bytes;     /* of the data that go with it */
    const struct buffer *data; /* as printed; NULL or empty: nothing is shown */
};

/* Adds a line about a step, if the log is open and shows the dispatch's message. */
void log_json_step(struct log *log, const struct log_step *step);

/* Adds a line of text of some kind. */
void log_json_text(struct log *log, const char *kind, const void *text, size_t length);

#endif
