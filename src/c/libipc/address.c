/*
 * Where central is.
 */
#include "libipc/address.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"

enum { OWN_NAME_SIZE = 33 }; /* as much of this host's name as the protocol uses */

const char *address_choose(const char *server, char own_host[NET_NAME_SIZE])
{
    if (server == NULL || *server == '\0') {
        server = getenv("CENTRALHOST");
    }
    if (server == NULL || *server == '\0') {
        net_host_name(own_host, NET_NAME_SIZE);
        server = own_host;
    }
    return server;
}

/* The part before the port, without the brackets of an IPv6 address: its length, and the port's text. */
static size_t split(const char *text, const char **host, const char **port)
{
    const char *closing = text[0] == '[' ? strchr(text, ']') : NULL;
    if (closing != NULL) {
        *host = text + 1;
        *port = closing[1] == ':' ? closing + 2 : NULL;
        return (size_t)(closing - text) - 1;
    }
    const char *colon = strchr(text, ':');
    *host = text;
    *port = colon != NULL ? colon + 1 : NULL;
    return colon != NULL ? (size_t)(colon - text) : strlen(text);
}

static bool is_own_name(const char *host)
{
    char own[OWN_NAME_SIZE];
    const size_t length = strlen(host);
    net_host_name(own, sizeof own);
    return strncmp(own, host, length) == 0 && (own[length] == '\0' || own[length] == '.');
}

int address_parse(const char *text, struct address *address)
{
    const char *host;
    const char *port;
    const size_t length = split(text, &host, &port);
    if (length == 0 || length >= sizeof address->host || isspace((unsigned char)host[0])) {
        return ERR_UNKNOWN;
    }
    memcpy(address->host, host, length);
    address->host[length] = '\0';
    address->port = port != NULL ? atoi(port) : DEFAULT_PORT;
    address->local = is_own_name(address->host);
    return 0;
}

bool address_is_loopback(const struct address *address)
{
    return strcmp(address->host, "localhost") == 0 || strncmp(address->host, "127.", 4) == 0 ||
           strcmp(address->host, "::1") == 0;
}

int address_connect(const struct address *address, int timeout_ms, int (*give_up)(void), int *fd,
                    bool *local)
{
    bool ignored;
    bool *const by_local = local != NULL ? local : &ignored;
    *by_local = false;
    if (address->local) {
        char path[NET_PATH_SIZE];
        snprintf(path, sizeof path, "%s/%d", NET_SOCKET_DIRECTORY, address->port);
        if (net_connect_local(path, fd) == 0) {
            *by_local = true;
            return 0;
        }
    }
    return net_connect_tcp(address->host, address->port, timeout_ms, give_up, fd);
}
