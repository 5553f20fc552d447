/*
 * Files on Windows.
 */
#include "platform/file.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <windows.h>

#include "base/buffer.h"
#include "base/memory.h"

enum {
    PIECE = 65536,    /* read or written at a time */
    MANY_NAMES = 100, /* tries to find a name that is free */
    INPUT_STREAM = 0,
    OUTPUT_STREAM = 1
};

/* ----------------------------------------------------------------------- reading */

static enum file_result read_all(int descriptor, struct buffer *buffer)
{
    for (;;) {
        if (buffer_reserve(buffer, PIECE) != 0) {
            errno = ENOMEM;
            return FILE_NOT_READ;
        }
        const int count = _read(descriptor, buffer->bytes + buffer->length, PIECE);
        if (count <= 0) {
            return count == 0 ? FILE_DONE : FILE_NOT_READ;
        }
        buffer->length += (size_t)count;
    }
}

/* Lines end as they end in the file: the scanner takes both kinds. */
static int open_to_read(const char *path)
{
    if (path != NULL) {
        return _open(path, _O_RDONLY | _O_BINARY | _O_NOINHERIT);
    }
    (void)_setmode(INPUT_STREAM, _O_BINARY);
    return INPUT_STREAM;
}

enum file_result file_read(const char *path, char **bytes, size_t *length)
{
    const int descriptor = open_to_read(path);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    struct buffer buffer;
    buffer_init(&buffer);
    const enum file_result result = read_all(descriptor, &buffer);
    const int reason = errno;
    if (path != NULL) {
        (void)_close(descriptor); /* nothing was written, so nothing can be lost */
    }
    *length = buffer.length;
    if (result != FILE_DONE) {
        buffer_fini(&buffer);
        errno = reason;
        return result;
    }
    memset(buffer.bytes + buffer.length, 0, 2); /* read_all has left room behind the end */
    *bytes = (char *)buffer_take(&buffer, NULL);
    return FILE_DONE;
}

/* ----------------------------------------------------------------------- writing */

static bool write_all(int descriptor, const char *bytes, size_t length)
{
    while (length > 0) {
        const int count = _write(descriptor, bytes, (unsigned)(length < PIECE ? length : PIECE));
        if (count < 0) {
            return false;
        }
        bytes += count;
        length -= (size_t)count;
    }
    return true;
}

/* Devices, pipes and the like cannot be replaced. */
static enum file_result write_in_place(const char *path, const void *bytes, size_t length)
{
    const int descriptor = _open(path, _O_WRONLY | _O_BINARY | _O_NOINHERIT);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    const bool is_written = write_all(descriptor, bytes, length);
    const int reason = errno;
    if (_close(descriptor) == 0 && is_written) {
        return FILE_DONE;
    }
    errno = is_written ? errno : reason;
    return FILE_NOT_WRITTEN;
}

/* Opens a new file beside path; its name is left in name, of size bytes. */
static int open_beside(const char *path, char *name, size_t size)
{
    for (int i = 0; i < MANY_NAMES; i++) {
        (void)snprintf(name, size, "%s.%d-%d.tmp", path, _getpid(), i);
        const int descriptor = _open(
            name, _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
        if (descriptor >= 0 || errno != EEXIST) {
            return descriptor;
        }
    }
    return -1;
}

static bool move_over(const char *name, const char *path)
{
    if (MoveFileExA(name, path, MOVEFILE_REPLACE_EXISTING) != 0) {
        return true;
    }
    errno = GetLastError() == ERROR_ACCESS_DENIED ? EACCES : EIO;
    return false;
}

static enum file_result replace(const char *path, const void *bytes, size_t length)
{
    const size_t size = strlen(path) + 48;
    char *name = mem_new(size);
    const int descriptor = open_beside(path, name, size);
    if (descriptor < 0) {
        free(name);
        return FILE_NOT_OPENED;
    }
    bool is_done = write_all(descriptor, bytes, length);
    is_done = _close(descriptor) == 0 && is_done && move_over(name, path);
    const int reason = errno;
    if (!is_done) {
        (void)_unlink(name); /* the first error is the one to tell */
    }
    free(name);
    errno = reason;
    return is_done ? FILE_DONE : FILE_NOT_WRITTEN;
}

enum file_result file_write(const char *path, const void *bytes, size_t length)
{
    enum { MAY_WRITE = 2 };
    struct _stati64 old;
    if (path == NULL) {
        (void)_setmode(OUTPUT_STREAM, _O_BINARY);
        return write_all(OUTPUT_STREAM, bytes, length) ? FILE_DONE : FILE_NOT_WRITTEN;
    }
    if (_stati64(path, &old) != 0) {
        return replace(path, bytes, length);
    }
    if ((old.st_mode & _S_IFMT) != _S_IFREG) {
        return write_in_place(path, bytes, length);
    }
    return _access(path, MAY_WRITE) == 0 ? replace(path, bytes, length) : FILE_NOT_OPENED;
}
