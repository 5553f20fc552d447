/*
 * Bounded, never waiting output of text.
 */
#include "central/log/sink.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "platform/platform.h"

enum { LIMIT_WAITING = 16 * 1024 * 1024, KEPT = 64 * 1024, PAUSE_MS = 1 };

void sink_init(struct sink *sink, int fd)
{
    memset(sink, 0, sizeof *sink);
    sink->fd = fd;
    sink->limit = LIMIT_WAITING;
    buffer_init(&sink->waiting);
}

void sink_init_file(struct sink *sink, int fd, const struct waker *told)
{
    sink_init(sink, fd);
    sink->writer = stream_writer_open(fd, told);
    sink->left = stream_size(fd);
}

void sink_close_file(struct sink *sink, uint64_t patience_ns)
{
    const uint64_t deadline = clock_ns() + patience_ns;
    while (sink_flush(sink) > 0 && clock_ns() < deadline) {
        (void)ready_wait(NULL, 0, PAUSE_MS);
    }
    if (sink->writer != NULL) {
        stream_writer_close(sink->writer, deadline);
    } else if (sink->fd >= 0) {
        stream_close(sink->fd);
    }
    sink_fini(sink); /* what a failing file does not take is lost */
    sink_init(sink, -1);
}

void sink_fini(struct sink *sink)
{
    buffer_fini(&sink->waiting);
}

/* The note of how many lines were lost, which precedes the next one that finds room; "" if none. */
static size_t write_note(const struct sink *sink, char *note, size_t size)
{
    note[0] = '\0';
    return sink->lost == 0
               ? 0
               : (size_t)snprintf(note, size, "*** %" PRIu64 " log lines lost ***\n", sink->lost);
}

void sink_put(struct sink *sink, const void *text, size_t length)
{
    char note[64];
    if (sink->failed || length == 0) {
        return;
    }
    const size_t note_length = write_note(sink, note, sizeof note);
    if (sink_waiting(sink) + note_length + length > sink->limit ||
        buffer_reserve(&sink->waiting, note_length + length) != 0) {
        sink->lost++;
        return;
    }
    sink->lost = 0;
    (void)buffer_append(&sink->waiting, note, note_length); /* both have room now */
    (void)buffer_append(&sink->waiting, text, length);
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

static int fail(struct sink *sink)
{
    sink->failed = true;
    buffer_fini(&sink->waiting);
    sink->start = 0;
    return ERR_IO;
}

/* Hands all that waits to the file's thread, unless it is busy. */
static int hand_over(struct sink *sink)
{
    const size_t count = sink->waiting.length;
    const int result = stream_writer_give(sink->writer, sink->waiting.bytes, count);
    if (result < 0) {
        return fail(sink);
    }
    if (result > 0) {
        sink->left += count;
        buffer_init(&sink->waiting); /* the bytes are the thread's now */
    }
    return sink->waiting.length > 0;
}

int sink_flush(struct sink *sink)
{
    if (sink->writer != NULL) {
        return sink->failed ? 0 : hand_over(sink);
    }
    if (sink_waiting(sink) == 0 || sink->fd < 0) {
        return sink_waiting(sink) > 0;
    }
    const ptrdiff_t n =
        stream_write(sink->fd, sink->waiting.bytes + sink->start, sink_waiting(sink));
    if (n < 0) {
        return fail(sink);
    }
    sink->start += (size_t)n;
    sink->left += (uint64_t)n;
    compact(sink);
    return sink_waiting(sink) > 0;
}
