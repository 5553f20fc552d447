/*
 * Files, as the system gives them: reading one as a whole, replacing one as a whole.
 */
#ifndef XDRGEN_PLATFORM_FILE_H
#define XDRGEN_PLATFORM_FILE_H

#include <stddef.h>

enum file_result {
    FILE_DONE,
    FILE_NOT_OPENED, /* errno says why */
    FILE_NOT_READ,   /* likewise */
    FILE_NOT_WRITTEN /* likewise */
};

/* Reads a file, or standard input if path is NULL.  The caller frees *bytes, which two NULs follow.
 */
enum file_result file_read(const char *path, char **bytes, size_t *length);

/* Writes a file, or standard output if path is NULL.  An ordinary file is written beside its
 * place and renamed, so that nobody ever sees a part of it and an error leaves the old one. */
enum file_result file_write(const char *path, const void *bytes, size_t length);

#endif
