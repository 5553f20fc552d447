/*
 * What a program of a user may look like: both ways to include the header, and
 * names of its own that the library uses inside too.
 */
#include <stdio.h>

#include "ipc.h"
#include <ipc/ipc.h>

/* Names of functions within the library.  A program may have its own of these names. */
int format_parse(void);
int buffer_append(void);

int format_parse(void)
{
    return 0;
}

int buffer_append(void)
{
    return 0;
}

int main(void)
{
    struct {
        int number;
        const char *text;
    } value = {1, "two"};
    FORMATTER_PTR formatter;

    IPC_initialize();
    formatter = IPC_parseFormat("{int, string}");
    if (formatter == NULL || IPC_isConnected() || format_parse() != 0 || buffer_append() != 0) {
        return 1;
    }
    return IPC_printData(formatter, stdout, &value) == IPC_OK ? 0 : 1;
}
