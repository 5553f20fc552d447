/*
 * The files of the logs: their names, their headers, their successors.
 */
#include "central/log/log_file.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/log/log_lines.h"
#include "central/settings/version.h"

enum { NAME_SUFFIX = 16 };

/* How long the server, and how long its end, waits for a disk that takes its time. */
#define PATIENCE_NS UINT64_C(200000000)
#define LAST_PATIENCE_NS UINT64_C(1000000000)

bool log_wants_file(const struct log *log, enum which_log which)
{
    return switches_want_file(log_switches_of(log, which));
}

static void write_header(struct log *log)
{
    static const char *const weekdays[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    static const char *const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    struct local_time now;
    log->clock(&now);
    buffer_clear(&log->line);
    text_append(&log->line, "Logging " SERVER_BANNER " on %s %s %2d %02d:%02d:%02d %d\n",
                weekdays[now.weekday], months[now.month - 1], now.day, now.hour, now.minute,
                now.second, now.year);
    sink_put(&log->file.sink, log->line.bytes, log->line.length);
}

/* Opens the file of the name that it has; a new one gets a header, if it is for people. */
static int open_file(struct log *log, enum which_log which, bool append)
{
    struct log_file *file = log_file_of(log, which);
    int fd;
    if (stream_open(file->name, append, &fd) != 0) {
        (void)fprintf(stderr, "ERROR: Can not open file %s.\n\n", file->name);
        return ERR_IO;
    }
    sink_init_file(&file->sink, fd, log->waker);
    file->is_open = true;
    if (file->sink.left == 0 && which == LOG_FILE) {
        write_header(log);
    }
    log_switched(log);
    return 0;
}

/* The name that the options want, malloc. */
static char *wanted_name(const struct log *log, enum which_log which)
{
    char generated[64];
    const struct options *options = log->options;
    const char *given = which == LOG_FILE ? options->file_name : options->json_name;
    (void)snprintf(generated, sizeof generated, "x_ipc.log.%" PRId64 "%s", log->start,
                   which == LOG_FILE ? "" : ".json");
    return mem_copy_string(given != NULL ? given : generated);
}

int log_open_file(struct log *log, enum which_log which)
{
    struct log_file *file = log_file_of(log, which);
    char *name = wanted_name(log, which);
    const bool goes_on = file->name != NULL && strcmp(file->name, name) == 0;
    free(file->name);
    file->name = name;
    const int error = open_file(log, which, goes_on);
    if (error == 0) {
        log_terminal(log, "Logging to %s;\n", name);
    }
    return error;
}

static void close_file(struct log *log, enum which_log which, uint64_t patience_ns)
{
    struct log_file *file = log_file_of(log, which);
    if (file->is_open) {
        file->is_open = false;
        sink_close_file(&file->sink, patience_ns);
    }
    log_switched(log);
}

void log_close_file(struct log *log, enum which_log which)
{
    close_file(log, which, PATIENCE_NS);
}

void log_end_files(struct log *log)
{
    for (enum which_log which = LOG_FILE; which <= LOG_JSON; which++) {
        close_file(log, which, LAST_PATIENCE_NS);
    }
}

void log_reopen_files(struct log *log)
{
    for (enum which_log which = LOG_FILE; which <= LOG_JSON; which++) {
        if (log_file_of(log, which)->is_open) {
            log_close_file(log, which);
            (void)open_file(log, which, true); /* a failure has been said */
        }
    }
}

/* ------------------------------------------------------------------- rotation */

/* The name of an older file, malloc: 0 is the one that is written. */
static char *older_name(const struct log_file *file, int age)
{
    const size_t size = strlen(file->name) + NAME_SUFFIX;
    char *name = mem_new(size);
    (void)snprintf(name, size, age == 0 ? "%s" : "%s.%d", file->name, age);
    return name;
}

/* Every file becomes one older; the oldest goes. */
static void age_files(const struct log_file *file, int kept)
{
    for (int age = kept; age > 0; age--) {
        char *newer = older_name(file, age - 1);
        char *older = older_name(file, age);
        (void)rename(newer, older); /* there may be none yet; what stays is written over */
        free(newer);
        free(older);
    }
}

static void start_new_file(struct log *log, enum which_log which)
{
    close_file(log, which, 0); /* its thread finishes it */
    age_files(log_file_of(log, which), log->options->kept_files);
    (void)open_file(log, which, false); /* a failure has been said */
}

/* -------------------------------------------------------------------- writing */

/* Whether lines may stay here for a while, so that the file gets many at a time. */
static bool may_lag(const struct log_file *file, const struct log_switches *on)
{
    return !on->flush && sink_waiting(&file->sink) < BUFSIZ;
}

static void flush_file(struct log *log, enum which_log which)
{
    struct log_file *file = log_file_of(log, which);
    const uint64_t limit = log->options->file_bytes;
    const int result = sink_flush(&file->sink);
    if (result < 0) {
        (void)fprintf(stderr, "ERROR: Can not write file %s.\n", file->name);
        log_close_file(log, which);
    } else if (result == 0 && limit != 0 && file->sink.left >= limit) {
        start_new_file(log, which);
    }
}

void log_flush_files(struct log *log)
{
    for (enum which_log which = LOG_FILE; which <= LOG_JSON; which++) {
        const struct log_file *file = log_file_of(log, which);
        if (file->is_open && !may_lag(file, log_switches_of(log, which))) {
            flush_file(log, which);
        }
    }
}
