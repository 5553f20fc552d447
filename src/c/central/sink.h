/*
 * Where lines of text go: a stream that never makes the server wait.
 *
 * Lines gather in a bounded buffer and leave as far as the stream takes them.
 * When the bound is reached, lines are counted instead of kept, and the next
 * one that finds room is preceded by a note of how many were lost.
 */
#ifndef IPC_CENTRAL_SINK_H
#define IPC_CENTRAL_SINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"

struct sink {
    int fd; /* -1: none, text only gathers (tests) */
    struct buffer waiting;
    size_t start;  /* of what has not left yet */
    size_t limit;  /* bytes that may wait */
    uint64_t left; /* bytes that have left, those that the stream held before included */
    uint64_t lost; /* lines since the last note */
    bool failed;   /* the stream refuses for good: everything is dropped */
};

void sink_init(struct sink *sink, int fd);

/* Frees what waits; the descriptor stays the caller's. */
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
