/*
 * Files that are written in threads of their own, on any system.
 */
#include "platform/process.h"

#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"

struct stream_writer {
    int fd;
    const struct waker *told;
    struct mutex *mutex; /* guards what follows */
    struct condition *changed;
    uint8_t *bytes; /* owned; NULL: there is nothing to do */
    size_t count;
    bool awaited; /* somebody has more, and is to be told */
    bool failed;
    bool closing; /* the thread ends, and frees everything, when there is nothing to do */
};

static void close_descriptor(struct stream_writer *writer)
{
    if (writer->fd >= 0) {
        stream_close(writer->fd);
        writer->fd = -1;
    }
}

static void writer_free(struct stream_writer *writer)
{
    close_descriptor(writer);
    condition_free(writer->changed);
    mutex_free(writer->mutex);
    free(writer);
}

/* Writes what was given; called with the lock, which is released meanwhile. */
static void write_given(struct stream_writer *writer)
{
    uint8_t *bytes = writer->bytes;
    const size_t count = writer->count;
    const bool failed = writer->failed;
    mutex_unlock(writer->mutex);
    const bool written = !failed && stream_write_all(writer->fd, bytes, count);
    free(bytes);
    mutex_lock(writer->mutex);
    writer->bytes = NULL;
    writer->failed = !written;
    if (writer->told != NULL && !writer->closing && (writer->awaited || writer->failed)) {
        waker_wake(writer->told);
    }
    writer->awaited = false;
    condition_tell_all(writer->changed);
}

static void run(void *argument)
{
    struct stream_writer *writer = argument;
    mutex_lock(writer->mutex);
    for (;;) {
        if (writer->bytes != NULL) {
            write_given(writer);
        } else if (writer->closing) {
            break;
        } else {
            condition_wait(writer->changed, writer->mutex, UINT64_MAX);
        }
    }
    mutex_unlock(writer->mutex);
    writer_free(writer);
}

struct stream_writer *stream_writer_open(int fd, const struct waker *told)
{
    struct stream_writer *writer = mem_new(sizeof *writer);
    writer->fd = fd;
    writer->told = told;
    writer->mutex = mutex_new();
    writer->changed = condition_new();
    if (thread_start(run, writer) != 0) {
        writer->fd = -1; /* stays the caller's */
        writer_free(writer);
        return NULL;
    }
    return writer;
}

int stream_writer_give(struct stream_writer *writer, uint8_t *bytes, size_t count)
{
    int result = 0;
    mutex_lock(writer->mutex);
    if (writer->failed) {
        result = ERR_IO;
    } else if (writer->bytes != NULL) {
        writer->awaited = count > 0;
    } else if (count > 0) {
        writer->bytes = bytes;
        writer->count = count;
        condition_tell_all(writer->changed);
        result = 1;
    }
    mutex_unlock(writer->mutex);
    return result;
}

void stream_writer_close(struct stream_writer *writer, uint64_t deadline_ns)
{
    mutex_lock(writer->mutex);
    while (writer->bytes != NULL && clock_ns() < deadline_ns) {
        condition_wait(writer->changed, writer->mutex, deadline_ns);
    }
    if (writer->bytes == NULL) {
        close_descriptor(writer); /* at once: there may be no other for the next file */
    }
    writer->closing = true;
    condition_tell_all(writer->changed);
    mutex_unlock(writer->mutex);
}
