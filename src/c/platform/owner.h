/*
 * Which process of this machine holds a socket, and how it is ended.
 */
#ifndef IPC_PLATFORM_OWNER_H
#define IPC_PLATFORM_OWNER_H

#include <stdbool.h>

/* The process at the other end of a Unix socket (the one that listens, for an outgoing one), 0: not known. */
int owner_of_peer(int fd);

/* The TCP port of the other end, 0: none. */
int owner_peer_port(int fd);

/* The process of this machine that has a TCP socket on that port, listening or connected; 0: none, or
 * the system does not say. */
int owner_of_port(int port, bool listening);

/* Asks a process to end in good order: 0, ERR_UNKNOWN (there is none), ERR_REFUSED (not allowed). */
int owner_end(int process);

#endif
