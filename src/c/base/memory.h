/*
 * Allocation of bookkeeping memory.
 *
 * Blocks whose size comes from a peer or from the user are allocated with plain
 * malloc and checked where they are needed: their failure is an ordinary error.
 * Small fixed-size records (a subscription, a timer, a table's slots) come from
 * here: when even those cannot be had, the process says so in one line on
 * standard error and aborts, because no caller could go on sensibly.
 */
#ifndef IPC_BASE_MEMORY_H
#define IPC_BASE_MEMORY_H

#include <stddef.h>

/* size zeroed bytes, never NULL; the caller releases them with free. */
void *mem_new(size_t size);

/* Resizes block (NULL allowed) to count elements of size bytes; never NULL.  New bytes are not zeroed. */
void *mem_resize(void *block, size_t count, size_t size);

/* A copy of text with a NUL behind it (NULL stays NULL); the caller releases it with free. */
char *mem_copy_string(const char *text);

/* A copy of the first length bytes of text with a NUL behind them; the caller releases it with free. */
char *mem_copy_text(const char *text, size_t length);

#endif
