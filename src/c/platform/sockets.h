/*
 * What the two kinds of systems do differently with the sockets that both have; only the platform
 * includes this.
 */
#ifndef IPC_PLATFORM_SOCKETS_H
#define IPC_PLATFORM_SOCKETS_H

#include "platform/platform.h"

/* The folder's own header includes the system's, and has socket_of(), by which the system calls what
 * is a descriptor here, and sockets_start(), which comes before the first of the system's functions
 * but for those that follow. */
#if defined(_WIN32)
#include "platform/windows/sockets.h"
#else
#include "platform/posix/sockets.h"
#endif

enum { SOCKET_BACKLOG = 4096 };

/* A socket for streams that is set up as all are: 0, ERR_IO. */
int socket_new(int family, int *fd);

/* Sets the options of a TCP connection. */
void socket_tune_tcp(int fd);

/* Lets a server listen on a port that its predecessor has just left, but not on one that is in use. */
bool socket_may_rebind(int fd);

/* Closes after a failure, of which errno then tells, and returns the error. */
int socket_close_with(int fd, int error);

/* The port in an address of the Internet, 0 for others. */
int socket_port_of(const struct sockaddr_storage *name);

/* Whether connect, which has just failed, goes on by itself. */
bool socket_is_connecting(void);

/* Waits for that: 0, ERR_TIMEOUT, ERR_REFUSED, ERR_IO.  For give_up see net_connect_tcp. */
int socket_await_connection(int fd, uint64_t deadline_ns, int (*give_up)(void));

/* How far that has come: 0, 1 (not yet), ERR_REFUSED, ERR_IO. */
int socket_look_at_connection(int fd);

#endif
