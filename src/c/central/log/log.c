/*
 * The life of the log.
 */
#include "central/log/log.h"

#include <stdlib.h>
#include <string.h>

void log_init(struct log *log, struct options *options, int terminal_fd)
{
    struct local_time now;
    memset(log, 0, sizeof *log);
    log->options = options;
    log->clock = clock_local;
    clock_local(&now);
    log->start = now.epoch;
    sink_init(&log->terminal, terminal_fd);
    sink_init(&log->file.sink, -1);
    sink_init(&log->json.sink, -1);
    buffer_init(&log->line);
    buffer_init(&log->value);
    buffer_init(&log->object);
    log_switched(log);
}

void log_close(struct log *log)
{
    (void)sink_flush(&log->terminal); /* what a blocked terminal does not take is lost */
    log_end_files(log);
    log->closed = true;
    log_switched(log);
}

void log_fini(struct log *log)
{
    log_close(log);
    sink_fini(&log->terminal);
    buffer_fini(&log->line);
    buffer_fini(&log->value);
    buffer_fini(&log->object);
    free(log->file.name);
    free(log->json.name);
}

void log_flush(struct log *log)
{
    log_flush_files(log); /* first, so that what the terminal shows is in the file */
    if (sink_flush(&log->terminal) < 0) {
        log_switched(log); /* the reader has gone: nobody minds */
    }
}
