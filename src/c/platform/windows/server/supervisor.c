/*
 * Supervisors, of which Windows has none of this kind.
 */
#include "platform/supervisor.h"

size_t supervisor_sockets(int *first)
{
    *first = 0;
    return 0;
}

void supervisor_socket_name(size_t i, char *name, size_t size)
{
    (void)i;
    if (size > 0) {
        name[0] = '\0';
    }
}

void supervisor_tell(const char *text)
{
    (void)text;
}

uint64_t supervisor_watchdog_ns(void)
{
    return 0;
}
