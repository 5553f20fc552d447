/*
 * Files that other programs wait for, on POSIX systems.
 */
#define _XOPEN_SOURCE 700
#include "platform/process.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

int64_t process_number(void)
{
    return getpid();
}

/* A name beside the path; the caller frees it. */
static char *name_beside(const char *path)
{
    enum { ROOM = 32 };
    const size_t size = strlen(path) + ROOM;
    char *name = mem_new(size);
    (void)snprintf(name, size, "%s.%ld.new", path, (long)getpid());
    return name;
}

static int write_new(const char *name, const char *text, struct stat *status)
{
    const size_t length = strlen(text);
    (void)unlink(name); /* left by a process that had this number before */
    const int fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (fd < 0) {
        return ERR_IO;
    }
    const bool written = write(fd, text, length) == (ssize_t)length && fstat(fd, status) == 0;
    const int saved = errno;
    close(fd);
    errno = saved;
    return written ? 0 : ERR_IO;
}

int process_file_write(struct process_file *file, const char *path, const char *text)
{
    struct stat status;
    char *name = name_beside(path);
    int error = write_new(name, text, &status);
    if (error == 0 && rename(name, path) != 0) {
        error = ERR_IO;
    }
    if (error == 0) {
        file->path = mem_copy_string(path);
        file->device = (uint64_t)status.st_dev;
        file->inode = (uint64_t)status.st_ino;
    } else {
        const int saved = errno;
        (void)unlink(name); /* it may not even be there */
        errno = saved;
    }
    free(name);
    return error;
}

void process_file_remove(struct process_file *file)
{
    struct stat status;
    if (file->path != NULL && lstat(file->path, &status) == 0 &&
        (uint64_t)status.st_dev == file->device && (uint64_t)status.st_ino == file->inode) {
        (void)unlink(file->path); /* the next server replaces what stays */
    }
    free(file->path);
    file->path = NULL;
}
