/*
 * TCP by the functions that POSIX and Windows have in common.
 */
#define _XOPEN_SOURCE 700
#include "platform/sockets.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"

/* --------------------------------------------------------------- listening */

static int listen_at(const struct addrinfo *place, int *fd)
{
    const int error = socket_new(place->ai_family, fd);
    if (error != 0) {
        return error;
    }
    (void)socket_may_rebind(*fd); /* it may be possible nevertheless */
    if (bind(socket_of(*fd), place->ai_addr, (socklen_t)place->ai_addrlen) < 0 ||
        listen(socket_of(*fd), SOCKET_BACKLOG) < 0) {
        return socket_close_with(*fd, ERR_IO);
    }
    return 0;
}

int socket_port_of(const struct sockaddr_storage *name)
{
    switch (name->ss_family) {
    case AF_INET:
        return ntohs(((const struct sockaddr_in *)(const void *)name)->sin_port);
    case AF_INET6:
        return ntohs(((const struct sockaddr_in6 *)(const void *)name)->sin6_port);
    default:
        return 0;
    }
}

/* As getaddrinfo. "localhost" is this machine also where nobody knows the name, as in a system that
 * has just been set up and has no /etc/hosts. */
static int look_up(const char *host, const char *service, const struct addrinfo *hints,
                   struct addrinfo **found)
{
    const int error = getaddrinfo(host, service, hints, found);
    return error != 0 && host != NULL && strcmp(host, "localhost") == 0
               ? getaddrinfo("127.0.0.1", service, hints, found)
               : error;
}

static int listen_at_first(const struct addrinfo *places, int *port, int *fd)
{
    struct sockaddr_storage name;
    socklen_t length = sizeof name;
    int error = ERR_UNKNOWN;
    for (const struct addrinfo *place = places; place != NULL && error != 0;
         place = place->ai_next) {
        error = listen_at(place, fd);
    }
    if (error != 0) {
        return error;
    }
    if (getsockname(socket_of(*fd), (struct sockaddr *)&name, &length) < 0) {
        return socket_close_with(*fd, ERR_IO);
    }
    *port = socket_port_of(&name);
    return 0;
}

int net_listen_tcp(const char *address, int *port, int *fd)
{
    struct addrinfo hints;
    struct addrinfo *places;
    char service[16];
    sockets_start();
    memset(&hints, 0, sizeof hints);
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    hints.ai_family = AF_INET; /* modules of CMU IPC have no other, so names mean that first */
    hints.ai_socktype = SOCK_STREAM;
    snprintf(service, sizeof service, "%d", *port);
    if (look_up(address, service, &hints, &places) != 0) {
        hints.ai_family = AF_INET6;
        if (look_up(address, service, &hints, &places) != 0) {
            return ERR_UNKNOWN;
        }
    }
    const int error = listen_at_first(places, port, fd);
    const int saved = errno;
    freeaddrinfo(places);
    errno = saved;
    return error;
}

int net_refuse(int listener, int *spare)
{
    if (*spare < 0) {
        return ERR_LIMIT;
    }
    net_close_copy(*spare);
    int fd;
    const int result = net_accept(listener, &fd);
    if (result == 0) {
        net_close(fd);
    }
    *spare = net_open_spare();
    return result;
}

/* -------------------------------------------------------------- connecting */

static int begin_to_connect(int fd, const struct addrinfo *target)
{
    return connect(socket_of(fd), target->ai_addr, (socklen_t)target->ai_addrlen);
}

static int connect_to(const struct addrinfo *target, uint64_t deadline_ns, int (*give_up)(void),
                      int *fd)
{
    int error = socket_new(target->ai_family, fd);
    if (error != 0) {
        return error;
    }
    socket_tune_tcp(*fd);
    if (begin_to_connect(*fd, target) == 0) {
        return 0;
    }
    error =
        socket_is_connecting() ? socket_await_connection(*fd, deadline_ns, give_up) : ERR_REFUSED;
    return error == 0 ? 0 : socket_close_with(*fd, error);
}

int net_connect_tcp(const char *host, int port, int timeout_ms, int (*give_up)(void), int *fd)
{
    const uint64_t deadline = clock_ns() + (uint64_t)timeout_ms * 1000000u;
    struct addrinfo hints;
    struct addrinfo *targets;
    char service[16];
    if (port <= 0 || port > 65535) {
        return ERR_REFUSED;
    }
    sockets_start();
    memset(&hints, 0, sizeof hints);
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    snprintf(service, sizeof service, "%d", port);
    if (look_up(host, service, &hints, &targets) != 0) {
        return ERR_UNKNOWN;
    }
    int error = ERR_UNKNOWN;
    for (const struct addrinfo *target = targets; target != NULL; target = target->ai_next) {
        error = connect_to(target, deadline, give_up, fd);
        if (error == 0) {
            break;
        }
    }
    freeaddrinfo(targets);
    return error;
}

/* The two ends are one: the port was free, and the kernel gave it to this very socket. */
static bool is_connected_to_itself(int fd)
{
    struct sockaddr_storage own;
    struct sockaddr_storage other;
    socklen_t own_length = sizeof own;
    socklen_t other_length = sizeof other;
    memset(&own, 0, sizeof own);
    memset(&other, 0, sizeof other);
    return getsockname(socket_of(fd), (struct sockaddr *)&own, &own_length) == 0 &&
           getpeername(socket_of(fd), (struct sockaddr *)&other, &other_length) == 0 &&
           own_length == other_length && memcmp(&own, &other, (size_t)own_length) == 0;
}

int net_start_tcp(const char *address, int port, int *fd)
{
    struct addrinfo hints;
    struct addrinfo *target;
    char service[16];
    sockets_start();
    memset(&hints, 0, sizeof hints);
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV; /* then nobody is asked */
    snprintf(service, sizeof service, "%d", port);
    if (getaddrinfo(address, service, &hints, &target) != 0) {
        return ERR_UNKNOWN;
    }
    int error = socket_new(target->ai_family, fd);
    if (error == 0) {
        socket_tune_tcp(*fd);
        if (begin_to_connect(*fd, target) != 0 && !socket_is_connecting()) {
            error = socket_close_with(*fd, ERR_REFUSED);
        }
    }
    freeaddrinfo(target);
    return error;
}

int net_look_at_start(int fd)
{
    const int result = socket_look_at_connection(fd);
    return result == 0 && is_connected_to_itself(fd) ? ERR_REFUSED : result;
}

/* -------------------------------------------------------------------- names */

/* The text of an address, "" for those that are not of the Internet.  An IPv4 address in IPv6's
 * clothing is shown as what it is, and a link's address without its link. */
static void write_address(const struct sockaddr_storage *address, socklen_t length, char *name,
                          size_t size)
{
    static const char mapped[] = "::ffff:";
    name[0] = '\0';
    if (address->ss_family != AF_INET && address->ss_family != AF_INET6) {
        return;
    }
    if (getnameinfo((const struct sockaddr *)address, length, name, (unsigned)size, NULL, 0,
                    NI_NUMERICHOST) != 0) {
        name[0] = '\0';
    }
    name[strcspn(name, "%")] = '\0';
    if (strncmp(name, mapped, sizeof mapped - 1) == 0 && strchr(name, '.') != NULL) {
        memmove(name, name + sizeof mapped - 1, strlen(name) - (sizeof mapped - 1) + 1);
    }
}

void net_peer_address(int fd, char *name, size_t size)
{
    struct sockaddr_storage address;
    socklen_t length = sizeof address;
    name[0] = '\0';
    if (getpeername(socket_of(fd), (struct sockaddr *)&address, &length) == 0) {
        write_address(&address, length, name, size);
    }
}

void net_own_address(int fd, char *name, size_t size)
{
    struct sockaddr_storage address;
    socklen_t length = sizeof address;
    name[0] = '\0';
    if (getsockname(socket_of(fd), (struct sockaddr *)&address, &length) == 0) {
        write_address(&address, length, name, size);
    }
}

static struct addrinfo *resolve(const char *text, int flags)
{
    struct addrinfo hints;
    struct addrinfo *found = NULL;
    memset(&hints, 0, sizeof hints);
    hints.ai_flags = flags;
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    return getaddrinfo(text, NULL, &hints, &found) == 0 ? found : NULL;
}

/* Whether the name leads to the address, and is not just another number. */
static bool leads_back(const char *name, const struct addrinfo *address)
{
    struct addrinfo *number = resolve(name, AI_NUMERICHOST);
    if (number != NULL) {
        freeaddrinfo(number);
        return false;
    }
    struct addrinfo *found = resolve(name, 0);
    bool same = false;
    for (const struct addrinfo *at = found; at != NULL && !same; at = at->ai_next) {
        same = at->ai_addrlen == address->ai_addrlen &&
               memcmp(at->ai_addr, address->ai_addr, at->ai_addrlen) == 0;
    }
    if (found != NULL) {
        freeaddrinfo(found);
    }
    return same;
}

void net_find_name(const char *number, char name[NET_NAME_SIZE])
{
    char found[NET_NAME_SIZE];
    sockets_start();
    struct addrinfo *address = resolve(number, AI_NUMERICHOST);
    name[0] = '\0';
    if (address == NULL) {
        return;
    }
    if (getnameinfo(address->ai_addr, (socklen_t)address->ai_addrlen, found, sizeof found, NULL, 0,
                    NI_NAMEREQD) == 0 &&
        leads_back(found, address)) {
        memcpy(name, found, strlen(found) + 1);
    }
    freeaddrinfo(address);
}
