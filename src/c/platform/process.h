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

/* ------------------------------------------------------------------- writers */

/* Writes to a file in a thread of its own, so that nobody waits for a slow disk. */
struct stream_writer;

/* The descriptor is its own then.  told (NULL: nobody) is woken when it has failed, or can take what
 * it could not.  NULL when there is no thread to be had: the descriptor then stays the caller's. */
struct stream_writer *stream_writer_open(int fd, const struct waker *told);

/* Hands bytes over, which become its own (malloc): 1, or 0 while it is busy with others or where
 * there are none, or ERR_IO when it has failed. */
int stream_writer_give(struct stream_writer *writer, uint8_t *bytes, size_t count);

/* Closes the file when what was given is written; waits for that until clock_ns() reaches
 * deadline_ns. */
void stream_writer_close(struct stream_writer *writer, uint64_t deadline_ns);

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
