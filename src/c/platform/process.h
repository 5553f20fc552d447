/*
 * What a server program needs from an operating system besides sockets: its
 * standard streams, files it writes, users, signals, the time of day.
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

/* Writes everything, waiting as long as it takes: whether it was written. */
bool stream_write_all(int fd, const void *bytes, size_t count);

/* The descriptor by which a poller sees that a stream can be read or written: the stream itself, or
 * what the system has in its place; -1: none. */
int stream_watched(int fd);

bool stream_is_terminal(int fd);

/* A file whose content was written at once, and which file it is, so that no other is removed. */
struct process_file {
    char *path; /* owned; NULL: none */
    uint64_t device;
    uint64_t inode;
};

/* Writes the text beside the path and renames it there, so that whoever reads it reads all of it:
 * 0 or ERR_IO (nothing is there then). */
int process_file_write(struct process_file *file, const char *path, const char *text);

/* Removes the file if it is still the one that was written.  May be called at any time. */
void process_file_remove(struct process_file *file);

/* This process's number. */
int64_t process_number(void);

/* -------------------------------------------------------------------- users */

/* The user whose rights this process has. */
int64_t process_user(void);

/* The number of a group: 0, or ERR_UNKNOWN. */
int process_find_group(const char *name, int64_t *group);

/* The user at the other end of a Unix socket: 0, or ERR_UNKNOWN where the system does not tell. */
int process_peer_user(int fd, int64_t *user);

/* Whether the process at the other end of a Unix socket was in a group when it connected. */
bool process_peer_is_in_group(int fd, int64_t group);

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
