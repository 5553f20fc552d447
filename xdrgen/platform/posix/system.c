/*
 * Files on POSIX.
 */
#define _XOPEN_SOURCE 700 /* realpath */

#include "platform/system.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

int system_input(void)
{
    return STDIN_FILENO;
}

int system_output(void)
{
    return STDOUT_FILENO;
}

int system_open_to_read(const char *path)
{
    return open(path, O_RDONLY | O_CLOEXEC);
}

int system_open_to_write(const char *path)
{
    return open(path, O_WRONLY | O_CLOEXEC);
}

int system_create(const char *path)
{
    return open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

bool system_close(int descriptor)
{
    return close(descriptor) == 0;
}

ptrdiff_t system_read(int descriptor, void *bytes, size_t room)
{
    ssize_t count;
    do {
        count = read(descriptor, bytes, room);
    } while (count < 0 && errno == EINTR);
    return count;
}

ptrdiff_t system_write(int descriptor, const void *bytes, size_t length)
{
    ssize_t count;
    do {
        count = write(descriptor, bytes, length);
    } while (count < 0 && errno == EINTR);
    return count;
}

enum system_kind system_kind_of(const char *path)
{
    struct stat found;
    return stat(path, &found) != 0  ? SYSTEM_NOTHING
           : S_ISREG(found.st_mode) ? SYSTEM_ORDINARY
                                    : SYSTEM_DEVICE;
}

bool system_may_write(const char *path)
{
    return access(path, W_OK) == 0;
}

char *system_real_name(const char *path)
{
    return realpath(path, NULL);
}

bool system_take_rights(int descriptor, const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && fchmod(descriptor, found.st_mode & 07777) == 0;
}

bool system_move(const char *name, const char *path)
{
    return rename(name, path) == 0;
}

void system_remove(const char *path)
{
    (void)unlink(path);
}

long system_process(void)
{
    return (long)getpid();
}
