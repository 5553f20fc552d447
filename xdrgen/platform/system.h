/*
 * What systems do differently with files.  Descriptors are small numbers, as POSIX has them; -1 and
 * false are failures, for which errno has the reason.
 */
#ifndef XDRGEN_PLATFORM_SYSTEM_H
#define XDRGEN_PLATFORM_SYSTEM_H

#include <stdbool.h>
#include <stddef.h>

/* The standard streams, with bytes as they are. */
int system_input(void);
int system_output(void);

int system_open_to_read(const char *path);
int system_open_to_write(const char *path); /* one that exists */
int system_create(const char *path);        /* one that does not */
bool system_close(int descriptor);

/* How many bytes were read or written, 0 at the end. */
ptrdiff_t system_read(int descriptor, void *bytes, size_t room);
ptrdiff_t system_write(int descriptor, const void *bytes, size_t length);

enum system_kind { SYSTEM_NOTHING, SYSTEM_ORDINARY, SYSTEM_DEVICE };

/* What is there under a name. */
enum system_kind system_kind_of(const char *path);
bool system_may_write(const char *path);

/* The file that a name leads to, through links, malloc. */
char *system_real_name(const char *path);

/* Gives a new file the rights that another one has. */
bool system_take_rights(int descriptor, const char *path);

/* Puts a file in the place of another one, or where none is. */
bool system_move(const char *name, const char *path);
void system_remove(const char *path);

long system_process(void);

#endif
