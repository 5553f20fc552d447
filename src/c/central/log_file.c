/*
 * The file of the log: its name, its header, its successors.
 */
#include "central/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/version.h"

enum { NAME_SUFFIX = 16 };

bool log_wants_file(const struct log *log)
{
    const struct log_switches *on = &log->options->file;
    return on->messages || on->status || on->data || on->time || on->summary;
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
    sink_put(&log->file, log->line.bytes, log->line.length);
}

/* Opens the file of log->file_name; a new one gets a header. */
static int open_file(struct log *log, bool append)
{
    int fd;
    if (stream_open(log->file_name, append, &fd) != 0) {
        return ERR_IO;
    }
    sink_init(&log->file, fd);
    log->file.left = stream_size(fd);
    log->file_is_open = true;
    if (log->file.left == 0) {
        write_header(log);
    }
    log_switched(log);
    return 0;
}

/* The name that the options want, malloc. */
static char *wanted_name(const struct log *log)
{
    char generated[64];
    (void)snprintf(generated, sizeof generated, "x_ipc.log.%" PRId64, log->start);
    return mem_copy_string(log->options->file_name != NULL ? log->options->file_name : generated);
}

int log_open_file(struct log *log)
{
    char *name = wanted_name(log);
    const bool goes_on = log->file_name != NULL && strcmp(log->file_name, name) == 0;
    free(log->file_name);
    log->file_name = name;
    const int error = open_file(log, goes_on);
    if (error == 0) {
        log_terminal(log, "Logging to %s;\n", log->file_name);
    }
    return error;
}

int log_reopen_file(struct log *log)
{
    if (!log->file_is_open) {
        return 0;
    }
    log_close_file(log);
    return open_file(log, true);
}

void log_close_file(struct log *log)
{
    if (log->file_is_open) {
        (void)sink_flush(&log->file); /* what a failing file does not take is lost */
        stream_close(log->file.fd);
        log->file_is_open = false;
    }
    sink_fini(&log->file);
    sink_init(&log->file, -1);
    log_switched(log);
}

/* ------------------------------------------------------------------- rotation */

/* The name of an older file, malloc: 0 is the one that is written. */
static char *older_name(const struct log *log, int age)
{
    const size_t size = strlen(log->file_name) + NAME_SUFFIX;
    char *name = mem_new(size);
    (void)snprintf(name, size, age == 0 ? "%s" : "%s.%d", log->file_name, age);
    return name;
}

/* Every file becomes one older; the oldest goes. */
static void age_files(const struct log *log)
{
    for (int age = log->options->kept_files; age > 0; age--) {
        char *newer = older_name(log, age - 1);
        char *older = older_name(log, age);
        (void)rename(newer, older); /* there may be none yet; what stays is written over */
        free(newer);
        free(older);
    }
}

static void start_new_file(struct log *log)
{
    log_close_file(log);
    age_files(log);
    if (open_file(log, false) != 0) {
        (void)fprintf(stderr, "ERROR: Can not open file %s.\n", log->file_name);
    }
}

/* -------------------------------------------------------------------- writing */

bool log_file_is_behind(const struct log *log)
{
    const bool lazy = !log->options->file.flush && sink_waiting(&log->file) < BUFSIZ;
    return log->file_is_open && !lazy && sink_waiting(&log->file) > 0;
}

void log_flush_file(struct log *log)
{
    if (!log_file_is_behind(log)) {
        return;
    }
    const uint64_t limit = log->options->file_bytes;
    if (sink_flush(&log->file) < 0) {
        (void)fprintf(stderr, "ERROR: Can not write file %s.\n", log->file_name);
        log_close_file(log);
    } else if (limit != 0 && log->file.left >= limit) {
        start_new_file(log);
    }
}
