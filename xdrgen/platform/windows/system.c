/*
 * Files on Windows.  Lines end as they end in the file: the scanner takes both kinds.
 */
#include "platform/system.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <stdio.h>
#include <sys/stat.h>
#include <windows.h>

#include "base/memory.h"

enum { MAX_BYTES = 65536, MAY_WRITE = 2, INPUT_STREAM = 0, OUTPUT_STREAM = 1 };

static int binary(int stream)
{
    (void)_setmode(stream, _O_BINARY);
    return stream;
}

int system_input(void)
{
    return binary(INPUT_STREAM);
}

int system_output(void)
{
    return binary(OUTPUT_STREAM);
}

int system_open_to_read(const char *path)
{
    return _open(path, _O_RDONLY | _O_BINARY | _O_NOINHERIT);
}

int system_open_to_write(const char *path)
{
    return _open(path, _O_WRONLY | _O_BINARY | _O_NOINHERIT);
}

int system_create(const char *path)
{
    return _open(path, _O_WRONLY | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT,
                 _S_IREAD | _S_IWRITE);
}

bool system_close(int descriptor)
{
    return _close(descriptor) == 0;
}

ptrdiff_t system_read(int descriptor, void *bytes, size_t room)
{
    return _read(descriptor, bytes, (unsigned)(room < MAX_BYTES ? room : MAX_BYTES));
}

ptrdiff_t system_write(int descriptor, const void *bytes, size_t length)
{
    return _write(descriptor, bytes, (unsigned)(length < MAX_BYTES ? length : MAX_BYTES));
}

enum system_kind system_kind_of(const char *path)
{
    struct _stati64 found;
    return _stati64(path, &found) != 0             ? SYSTEM_NOTHING
           : (found.st_mode & _S_IFMT) == _S_IFREG ? SYSTEM_ORDINARY
                                                   : SYSTEM_DEVICE;
}

bool system_may_write(const char *path)
{
    return _access(path, MAY_WRITE) == 0;
}

char *system_real_name(const char *path)
{
    return mem_copy_string(path); /* links are rare, and replaced */
}

bool system_take_rights(int descriptor, const char *path)
{
    (void)descriptor;
    (void)path;
    return true; /* those of the folder hold */
}

bool system_move(const char *name, const char *path)
{
    if (MoveFileExA(name, path, MOVEFILE_REPLACE_EXISTING) != 0) {
        return true;
    }
    errno = GetLastError() == ERROR_ACCESS_DENIED ? EACCES : EIO;
    return false;
}

void system_remove(const char *path)
{
    (void)_unlink(path);
}

long system_process(void)
{
    return _getpid();
}
