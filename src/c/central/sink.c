/*
 * Bounded, never waiting output of text.
 */
#include "central/sink.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "platform/process.h"

enum { LIMIT_WAITING = 16 * 1024 * 1024, KEPT = 64 * 1024 };

void sink_init(struct sink *sink, int fd)
{
    memset(sink, 0, sizeof *sink);
    sink->fd = fd;
    sink->limit = LIMIT_WAITING;
    buffer_init(&sink->waiting);
}

void sink_fini(struct sink *sink)
{
    buffer_fini(&sink->waiting);
}

/* Appends if there is room for it. */
static bool append(struct sink *sink, const void *text, size_t length)
{
    return sink_waiting(sink) + length <= sink->limit &&
           buffer_append(&sink->waiting, text, length) == 0;
}

void sink_put(struct sink *sink, const void *text, size_t length)
{
    if (sink->failed || length == 0) {
        return;
    }
    if (sink->lost > 0) {
        char note[64];
        const int n = snprintf(note, sizeof note, "*** %" PRIu64 " log lines lost ***\n", sink->lost);
        if (!append(sink, note, (size_t)n)) {
            sink->lost++;
            return;
        }
        sink->lost = 0;
    }
    if (!append(sink, text, length)) {
        sink->lost++;
    }
}

/* Moves the rest to the front once the written part outweighs it. */
static void compact(struct sink *sink)
{
    const size_t left = sink_waiting(sink);
    if (left == 0 && sink->waiting.capacity > KEPT) {
        buffer_fini(&sink->waiting);
        sink->start = 0;
    } else if (left <= sink->start) {
        if (left > 0) {
            memmove(sink->waiting.bytes, sink->waiting.bytes + sink->start, left);
        }
        sink->waiting.length = left;
        sink->start = 0;
    }
}

int sink_flush(struct sink *sink)
{
    if (sink_waiting(sink) == 0 || sink->fd < 0) {
        return sink_waiting(sink) > 0;
    }
    const ptrdiff_t n =
        stream_write(sink->fd, sink->waiting.bytes + sink->start, sink_waiting(sink));
    if (n < 0) {
        sink->failed = true;
        buffer_fini(&sink->waiting);
        sink->start = 0;
        return ERR_IO;
    }
    sink->start += (size_t)n;
    compact(sink);
    return sink_waiting(sink) > 0;
}
