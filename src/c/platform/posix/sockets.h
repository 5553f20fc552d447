/*
 * The system's headers for sockets, on POSIX systems.
 */
#ifndef IPC_PLATFORM_POSIX_SOCKETS_H
#define IPC_PLATFORM_POSIX_SOCKETS_H

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

static inline int socket_of(int fd)
{
    return fd;
}

static inline void sockets_start(void)
{
}

#endif
