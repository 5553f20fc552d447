/*
 * Allocation of bookkeeping memory: never fails, because the process ends first.
 */
#include "base/memory.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *checked(void *block)
{
    if (block == NULL) {
        fputs("ipc: out of memory\n", stderr);
        abort();
    }
    return block;
}

void *mem_new(size_t size)
{
    return checked(calloc(1, size > 0 ? size : 1));
}

void *mem_resize(void *block, size_t count, size_t size)
{
    if (size > 0 && count > SIZE_MAX / size) {
        return checked(NULL);
    }
    size_t total = count * size;
    return checked(realloc(block, total > 0 ? total : 1));
}

char *mem_copy_string(const char *text)
{
    return text == NULL ? NULL : mem_copy_text(text, strlen(text));
}

char *mem_copy_text(const char *text, size_t length)
{
    char *copy = mem_resize(NULL, length + 1, 1);
    if (length > 0) {
        memcpy(copy, text, length);
    }
    copy[length] = '\0';
    return copy;
}
