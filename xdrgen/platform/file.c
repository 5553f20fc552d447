/*
 * Files, by what the systems do differently.
 */
#include "platform/file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/buffer.h"
#include "base/memory.h"
#include "platform/system.h"

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
        const ptrdiff_t count = system_read(descriptor, buffer->bytes + buffer->length, READ_SIZE);
        if (count <= 0) {
            return count == 0 ? FILE_DONE : FILE_NOT_READ;
        }
        buffer->length += (size_t)count;
    }
}

enum file_result file_read(const char *path, char **bytes, size_t *length)
{
    const int descriptor = path == NULL ? system_input() : system_open_to_read(path);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    struct buffer buffer;
    buffer_init(&buffer);
    const enum file_result result = read_all(descriptor, &buffer);
    const int reason = errno;
    if (path != NULL) {
        (void)system_close(descriptor); /* nothing was written, so nothing can be lost */
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
        const ptrdiff_t count = system_write(descriptor, bytes, length);
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
    const int descriptor = system_open_to_write(path);
    if (descriptor < 0) {
        return FILE_NOT_OPENED;
    }
    const bool is_written = write_all(descriptor, bytes, length);
    const int reason = errno;
    if (system_close(descriptor) && is_written) {
        return FILE_DONE;
    }
    errno = is_written ? errno : reason;
    return FILE_NOT_WRITTEN;
}

/* Opens a new file beside path; its name is left in name, of size bytes. */
static int open_beside(const char *path, char *name, size_t size)
{
    for (int i = 0; i < MANY_NAMES; i++) {
        (void)snprintf(name, size, "%s.%ld-%d.tmp", path, system_process(), i);
        const int descriptor = system_create(name);
        if (descriptor >= 0 || errno != EEXIST) {
            return descriptor;
        }
    }
    return -1;
}

/* Puts a new file into its place; old: it is there already. */
static enum file_result replace(const char *path, bool old, const void *bytes, size_t length)
{
    const size_t size = strlen(path) + 48;
    char *name = mem_new(size);
    const int descriptor = open_beside(path, name, size);
    if (descriptor < 0) {
        free(name);
        return FILE_NOT_OPENED;
    }
    bool is_done =
        write_all(descriptor, bytes, length) && (!old || system_take_rights(descriptor, path));
    is_done = system_close(descriptor) && is_done && system_move(name, path);
    const int reason = errno;
    if (!is_done) {
        system_remove(name); /* the first error is the one to tell */
    }
    free(name);
    errno = reason;
    return is_done ? FILE_DONE : FILE_NOT_WRITTEN;
}

static enum file_result replace_ordinary(const char *path, const void *bytes, size_t length)
{
    if (!system_may_write(path)) {
        return FILE_NOT_OPENED;
    }
    char *target = system_real_name(path); /* a symbolic link stays one */
    const enum file_result result = replace(target != NULL ? target : path, true, bytes, length);
    const int reason = errno;
    free(target);
    errno = reason;
    return result;
}

enum file_result file_write(const char *path, const void *bytes, size_t length)
{
    if (path == NULL) {
        return write_all(system_output(), bytes, length) ? FILE_DONE : FILE_NOT_WRITTEN;
    }
    switch (system_kind_of(path)) {
    case SYSTEM_ORDINARY:
        return replace_ordinary(path, bytes, length);
    case SYSTEM_DEVICE:
        return write_in_place(path, bytes, length);
    case SYSTEM_NOTHING:
    default:
        return replace(path, false, bytes, length);
    }
}
