/*
 * Standard streams and files that are written, on Windows.
 *
 * A stream is a descriptor of the C library.  Nothing here can be read or written
 * without waiting, so that two threads wait instead: one reads standard input
 * ahead and wakes who watches it, the other writes standard output.
 */
#include "platform/process.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"
#include "base/memory.h"
#include "platform/windows/system.h"

enum { PIECE = 64 * 1024 };

void process_complete_streams(void)
{
    int fd;
    do {
        fd = _open("NUL", _O_RDWR | _O_NOINHERIT);
    } while (fd >= 0 && fd <= STREAM_ERRORS);
    if (fd > STREAM_ERRORS) {
        (void)_close(fd);
    }
    for (fd = STREAM_INPUT; fd <= STREAM_ERRORS; fd++) {
        (void)_setmode(fd, _O_BINARY); /* lines end alike, whoever writes them */
    }
}

/* -------------------------------------------------------------------- files */

static int reason_of(DWORD failure)
{
    switch (failure) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
        return ENOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
        return EACCES;
    default:
        return EIO;
    }
}

/* Others may read, rename and remove it meanwhile, as they may elsewhere. */
int stream_open(const char *name, bool append, int *fd)
{
    const HANDLE file =
        CreateFileA(name, append ? FILE_APPEND_DATA : GENERIC_WRITE,
                    FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                    append ? OPEN_ALWAYS : CREATE_ALWAYS, FILE_ATTRIBUTE_NORMAL, NULL);
    if (file == INVALID_HANDLE_VALUE) {
        errno = reason_of(GetLastError());
        *fd = -1;
        return ERR_IO;
    }
    *fd = _open_osfhandle((intptr_t)file, _O_BINARY | (append ? _O_APPEND : 0));
    if (*fd < 0) {
        (void)CloseHandle(file);
        return ERR_IO;
    }
    return 0;
}

void stream_close(int fd)
{
    (void)_close(fd);
}

uint64_t stream_size(int fd)
{
    struct _stati64 status;
    return _fstati64(fd, &status) == 0 && (status.st_mode & _S_IFMT) == _S_IFREG
               ? (uint64_t)status.st_size
               : 0;
}

bool stream_write_all(int fd, const void *bytes, size_t count)
{
    const char *at = bytes;
    while (count > 0) {
        const int n = _write(fd, at, (unsigned)(count < PIECE ? count : PIECE));
        if (n <= 0) {
            return false;
        }
        at += n;
        count -= (size_t)n;
    }
    return true;
}

bool stream_is_terminal(int fd)
{
    DWORD mode;
    return GetConsoleMode((HANDLE)_get_osfhandle(fd), &mode) != 0;
}

/* ------------------------------------------------------------ standard input */

/* What the thread has read ahead; like the stream it belongs to the process. */
static struct {
    struct mutex *mutex; /* guards what follows; NULL: there is no thread */
    struct condition *taken;
    struct waker waker; /* set while there is something to take, or the end */
    char bytes[4096];
    size_t start;
    size_t end;
    bool has_ended;
} input;

/* Reads until the end of the input, one piece after the other has been taken. */
static void read_ahead(void *unused)
{
    (void)unused;
    mutex_lock(input.mutex);
    while (!input.has_ended) {
        mutex_unlock(input.mutex);
        const int n = _read(STREAM_INPUT, input.bytes, sizeof input.bytes);
        mutex_lock(input.mutex);
        input.start = 0;
        input.end = n > 0 ? (size_t)n : 0;
        input.has_ended = n <= 0;
        waker_wake(&input.waker);
        while (input.start < input.end) {
            condition_wait(input.taken, input.mutex, UINT64_MAX);
        }
    }
    mutex_unlock(input.mutex);
}

/* Where there is no thread the input has ended. */
static void start_input(void)
{
    input.mutex = mutex_new();
    input.taken = condition_new();
    input.waker.read_fd = input.waker.write_fd = -1;
    input.has_ended = waker_open(&input.waker) != 0;
    if (!input.has_ended && thread_start(read_ahead, NULL) != 0) {
        input.has_ended = true;
        waker_wake(&input.waker);
    }
}

int stream_watched(int fd)
{
    if (fd != STREAM_INPUT) {
        return -1;
    }
    if (input.mutex == NULL) {
        start_input();
    }
    return input.waker.read_fd;
}

ptrdiff_t stream_read(int fd, void *bytes, size_t room)
{
    if (stream_watched(fd) < 0) {
        return ERR_IO;
    }
    mutex_lock(input.mutex);
    const size_t left = input.end - input.start;
    const size_t count = left < room ? left : room;
    const bool is_end = left == 0 && input.has_ended;
    memcpy(bytes, input.bytes + input.start, count);
    input.start += count;
    if (input.start == input.end && !input.has_ended) {
        waker_clear(&input.waker);
        condition_tell_all(input.taken);
    }
    mutex_unlock(input.mutex);
    return is_end ? ERR_CLOSED : (ptrdiff_t)count;
}

/* ------------------------------------------------------------ standard output */

/* Writes standard output; NULL until something is written. */
static struct stream_writer *output;

static void finish_output(void)
{
    enum { PATIENCE_MS = 1000 };
    stream_writer_close(output, clock_ns() + (uint64_t)PATIENCE_MS * 1000000u);
}

static ptrdiff_t write_output(const void *bytes, size_t count)
{
    if (output == NULL) {
        output = stream_writer_open(STREAM_OUTPUT, NULL);
        if (output == NULL) {
            return ERR_IO;
        }
        (void)atexit(finish_output); /* at worst the last words are lost */
    }
    uint8_t *copy = mem_new(count);
    memcpy(copy, bytes, count);
    const int result = stream_writer_give(output, copy, count);
    if (result <= 0) {
        free(copy);
    }
    return result > 0 ? (ptrdiff_t)count : result;
}

ptrdiff_t stream_write(int fd, const void *bytes, size_t count)
{
    if (count == 0) {
        return 0;
    }
    if (fd == STREAM_OUTPUT) {
        return write_output(bytes, count);
    }
    return stream_write_all(fd, bytes, count) ? (ptrdiff_t)count : ERR_IO;
}
