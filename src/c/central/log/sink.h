/*
 * Where lines of text go: a stream that never makes the server wait.
 *
 * Lines gather in a bounded buffer and leave as far as the stream takes them; a
 * file takes them in a thread of its own, as nobody can tell whether a disk would
 * make one wait.
 * When the bound is reached, lines are counted instead of kept, and the next
 * one that finds room is preceded by a note of how many were lost.
 */
#ifndef IPC_CENTRAL_SINK_H
#define IPC_CENTRAL_SINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"
#include "platform/process.h"

struct sink {
    int fd;                       /* -1: none, text only gathers (tests) */
    struct stream_writer *writer; /* of a file, NULL: written directly */
    struct buffer waiting;
    size_t start;  /* of what has not left yet */
    size_t limit;  /* bytes that may wait */
    uint64_t left; /* bytes that have left, those that the stream held before included */
    uint64_t lost; /* lines since the last note */
    bool failed;   /* the stream refuses for good: everything is dropped */
};

void sink_init(struct sink *sink, int fd);

/* The same for a file, whose descriptor is the sink's own then; told is woken when it may take more. */
void sink_init_file(struct sink *sink, int fd, const struct waker *told);

/* Closes a file, whose last lines get so much time to leave while somebody waits for them. */
void sink_close_file(struct sink *sink, uint64_t patience_ns);

/* Frees what waits; the descriptor of what is no file stays the caller's. */
void sink_fini(struct sink *sink);

/* Adds one line, or part of one, with its end. */
void sink_put(struct sink *sink, const void *text, size_t length);

/* Lets leave what the stream takes: 0 when nothing waits any more, 1 when something does, or ERR_IO
 * once, when the stream has begun to refuse. */
int sink_flush(struct sink *sink);

static inline size_t sink_waiting(const struct sink *sink)
{
    return sink->waiting.length - sink->start;
}

#endif
