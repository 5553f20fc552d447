/*
 * What a server program needs from an operating system besides sockets: its
 * standard streams, files it appends to, signals, the time of day.
 */
#ifndef IPC_PLATFORM_PROCESS_H
#define IPC_PLATFORM_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "platform/platform.h"

/* ------------------------------------------------------------------ streams */

enum { STREAM_INPUT = 0, STREAM_OUTPUT = 1, STREAM_ERRORS = 2 };

/* Makes missing standard streams lead to the null device, so that no socket takes their place. */
void process_complete_streams(void);

/* Opens a file for writing, emptied unless append, without waiting for a reader: 0 or ERR_IO. */
int stream_open(const char *name, bool append, int *fd);
void stream_close(int fd);

/* Bytes in a file; 0 for what is none. */
uint64_t stream_size(int fd);

/* Reads what is there, without waiting: number of bytes, 0 when nothing is there now, ERR_CLOSED at
 * the end, ERR_IO. */
ptrdiff_t stream_read(int fd, void *bytes, size_t room);

/* Writes what the stream takes without waiting: number of bytes, 0 when it takes none now,
 * ERR_CLOSED, ERR_IO. */
ptrdiff_t stream_write(int fd, const void *bytes, size_t count);

bool stream_is_terminal(int fd);

/* ------------------------------------------------------------------ signals */

/* From here on a request to end (interrupt, terminate) or to reopen files (hang up) does nothing
 * but wake, and a broken pipe does nothing at all.  The waker outlives the process's use of it. */
int process_catch_signals(const struct waker *waker);

/* The number of a signal that came since it was last asked for, or 0.  Requests to end come first.
 */
int process_take_signal(void);

/* Whether that signal asks the process to end. */
bool process_signal_ends(int number);

/* -------------------------------------------------------------- time of day */

struct local_time {
    int year;
    int month; /* 1 to 12 */
    int day;
    int weekday; /* 0: Sunday */
    int hour;
    int minute;
    int second;
    int hundredths;
    int64_t epoch; /* seconds since 1970 */
};

void clock_local(struct local_time *time);

/* Universal time to the nanosecond, as in 2026-11-25T03:40:30.123456789Z. */
enum { CLOCK_UTC_SIZE = 40 };
void clock_utc(char text[CLOCK_UTC_SIZE]);

#endif
