/*
 * Files that other programs wait for, on Windows.
 */
#include "platform/process.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "platform/windows/system.h"

enum { SHARED_BY_ALL = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE };

/* A name beside the path; the caller frees it. */
static char *name_beside(const char *path)
{
    enum { ROOM = 32 };
    const size_t size = strlen(path) + ROOM;
    char *name = mem_new(size);
    (void)snprintf(name, size, "%s.%ld.new", path, (long)process_number());
    return name;
}

/* Which file it is, by the numbers of volume and file. */
static bool identify(HANDLE handle, uint64_t *device, uint64_t *inode)
{
    BY_HANDLE_FILE_INFORMATION about;
    if (GetFileInformationByHandle(handle, &about) == 0) {
        return false;
    }
    *device = about.dwVolumeSerialNumber;
    *inode = (uint64_t)about.nFileIndexHigh << 32 | about.nFileIndexLow;
    return true;
}

static int write_new(const char *name, const char *text, struct process_file *file)
{
    DWORD written = 0;
    const DWORD length = (DWORD)strlen(text);
    const HANDLE handle = CreateFileA(name, GENERIC_WRITE, SHARED_BY_ALL, NULL, CREATE_ALWAYS,
                                      FILE_ATTRIBUTE_NORMAL, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        return ERR_IO;
    }
    const bool is_written = WriteFile(handle, text, length, &written, NULL) != 0 &&
                            written == length && identify(handle, &file->device, &file->inode);
    (void)CloseHandle(handle);
    return is_written ? 0 : ERR_IO;
}

int process_file_write(struct process_file *file, const char *path, const char *text)
{
    char *name = name_beside(path);
    int error = write_new(name, text, file);
    if (error == 0 && MoveFileExA(name, path, MOVEFILE_REPLACE_EXISTING) == 0) {
        error = ERR_IO;
    }
    if (error == 0) {
        file->path = mem_copy_string(path);
    } else {
        errno = GetLastError() == ERROR_ACCESS_DENIED ? EACCES : ENOENT;
        (void)DeleteFileA(name); /* it may not even be there */
    }
    free(name);
    return error;
}

static bool is_still_there(const struct process_file *file)
{
    uint64_t device = 0;
    uint64_t inode = 0;
    const HANDLE handle = CreateFileA(file->path, 0, SHARED_BY_ALL, NULL, OPEN_EXISTING, 0, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        return false;
    }
    const bool known = identify(handle, &device, &inode);
    (void)CloseHandle(handle);
    return known && device == file->device && inode == file->inode;
}

void process_file_remove(struct process_file *file)
{
    if (file->path != NULL && is_still_there(file)) {
        (void)DeleteFileA(file->path); /* the next server replaces what stays */
    }
    free(file->path);
    file->path = NULL;
}
