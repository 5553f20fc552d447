/*
 * Sockets as the rest of the project sees them, on Windows.
 *
 * A descriptor is the socket's handle: Windows has those of 32 significant bits,
 * so that an int holds them, and none is negative.  The standard streams are 0, 1
 * and 2, which no socket can be, since handles are multiples of 4.
 */
#ifndef IPC_PLATFORM_WINDOWS_SOCKETS_H
#define IPC_PLATFORM_WINDOWS_SOCKETS_H

#include "platform/windows/system.h"

static inline SOCKET socket_of(int fd)
{
    return fd < 0 ? INVALID_SOCKET : (SOCKET)fd;
}

static inline int socket_descriptor(SOCKET socket)
{
    return socket == INVALID_SOCKET ? -1 : (int)socket;
}

/* Wakes Winsock up, once in a process. */
void sockets_start(void);

/* Makes errno say what Winsock says of its last failure; returns ERR_IO. */
int sockets_failure(void);

#endif
