/*
 * Files on POSIX.
 */
#define _XOPEN_SOURCE 700 /* realpath */

#include "platform/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/buffer.h"
#include "base/memory.h"

enum {
    READ_SIZE = 65536,
    MANY_NAMES = 100 /* tries to find a name that is free */
};

/* ----------------------------------------------------------------------- reading */

static enum file_result read_all(int descriptor, struct buffer *buffer)
{
    for (;;) {
        if (buffer_reserve(buffer, READ_SIZE) != 0) {
            errno = ENOMEM;
            return FILE_NOT_READ;
        }
        const ssize_t count = read(descriptor, buffer->bytes + buffer->length, READ_SIZE);
        if (count == 0) {
            return FILE_DONE;
        }
        if (count > 0) {
            buffer->length += (size_t)count;
        } else if (errno != EINTR) {
            return FILE_NOT_READ;
        }
    }
}

enum file_result file_read(const char *path, char **bytes, size_t *length)
{
    const int descriptor = path == NULL ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    struct buffer buffer;
    buffer_init(&buffer);
    const enum file_result result = read_all(descriptor, &buffer);
    const int reason = errno;
    if (path != NULL) {
        (void)close(descriptor); /* nothing was written, so nothing can be lost */
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
        const ssize_t count = write(descriptor, bytes, length);
        if (count < 0 && errno == EINTR) {
            continue;
        }
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
    const int descriptor = open(path, O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    const bool is_written = write_all(descriptor, bytes, length);
    const int reason = errno;
    if (close(descriptor) == 0 && is_written) {
        return FILE_DONE;
    }
    errno = is_written ? errno : reason;
    return FILE_NOT_WRITTEN;
}

/* Opens a new file beside path; its name is left in name, of size bytes. */
static int open_beside(const char *path, char *name, size_t size)
{
    for (int i = 0; i < MANY_NAMES; i++) {
        (void)snprintf(name, size, "%s.%ld-%d.tmp", path, (long)getpid(), i);
        const int descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0 || errno != EEXIST) {
            return descriptor;
        }
    }
    return -1;
}

static enum file_result replace(const char *path, const struct stat *old, const void *bytes,
                                size_t length)
{
    const size_t size = strlen(path) + 48;
    char *name = mem_new(size);
    const int descriptor = open_beside(path, name, size);
    if (descriptor < 0) {
        free(name);
        return FILE_NOT_OPENED;
    }
    bool is_done = write_all(descriptor, bytes, length) &&
                   (old == NULL || fchmod(descriptor, old->st_mode & 07777) == 0);
    is_done = close(descriptor) == 0 && is_done && rename(name, path) == 0;
    const int reason = errno;
    if (!is_done) {
        (void)unlink(name); /* the first error is the one to tell */
    }
    free(name);
    errno = reason;
    return is_done ? FILE_DONE : FILE_NOT_WRITTEN;
}

enum file_result file_write(const char *path, const void *bytes, size_t length)
{
    struct stat old;
    if (path == NULL) {
        return write_all(STDOUT_FILENO, bytes, length) ? FILE_DONE : FILE_NOT_WRITTEN;
    }
    if (stat(path, &old) != 0) {
        return replace(path, NULL, bytes, length);
    }
    if (!S_ISREG(old.st_mode)) {
        return write_in_place(path, bytes, length);
    }
    if (access(path, W_OK) != 0) {
        return FILE_NOT_OPENED;
    }
    char *target = realpath(path, NULL); /* a symbolic link stays one */
    const enum file_result result = replace(target != NULL ? target : path, &old, bytes, length);
    const int reason = errno;
    free(target);
    errno = reason;
    return result;
}
