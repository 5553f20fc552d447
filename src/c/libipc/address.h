/*
 * Where central is: from CENTRALHOST or an argument to a connected socket.
 */
#ifndef IPC_LIBIPC_ADDRESS_H
#define IPC_LIBIPC_ADDRESS_H

#include <stdbool.h>

#include "platform/platform.h"

enum { DEFAULT_PORT = 1381 };

struct address {
    char host[NET_NAME_SIZE];
    int port;
    bool local; /* the Unix socket of that port comes first */
};

/* The server that is meant: that one; if NULL or empty, the one of CENTRALHOST, or else this host, whose
 * name is put into own_host. */
const char *address_choose(const char *server, char own_host[NET_NAME_SIZE]);

/* Splits host[:port] or [IPv6]:port: 0, or ERR_UNKNOWN when it cannot name a host. */
int address_parse(const char *text, struct address *address);

/* Whether the host is this machine's loopback. */
bool address_is_loopback(const struct address *address);

/* Opens a connection: 0 or as net_connect_tcp.  *local (may be NULL) tells whether it is by Unix socket. */
int address_connect(const struct address *address, int timeout_ms, int (*give_up)(void), int *fd,
                    bool *local);

#endif
