/*
 * Supervisors on POSIX systems.
 */
#define _XOPEN_SOURCE 700
#include "platform/supervisor.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

enum { FIRST_SOCKET = 3, MAX_SOCKETS = 16 };

/* The number in a variable, at most highest; 0 where there is none. */
static uint64_t number_of(const char *variable, uint64_t highest)
{
    const char *text = getenv(variable);
    char *end;
    if (text == NULL || text[0] < '0' || text[0] > '9') {
        return 0;
    }
    errno = 0;
    const unsigned long long number = strtoull(text, &end, 10);
    return *end != '\0' || errno != 0 || number > highest ? 0 : number;
}

/* Whether a variable names this process: the environment may be inherited from another one. */
static bool is_for_us(const char *variable)
{
    return number_of(variable, INT_MAX) == (uint64_t)getpid();
}

size_t supervisor_sockets(int *first)
{
    *first = FIRST_SOCKET;
    return is_for_us("LISTEN_PID") ? (size_t)number_of("LISTEN_FDS", MAX_SOCKETS) : 0;
}

void supervisor_socket_name(size_t i, char *name, size_t size)
{
    const char *at = getenv("LISTEN_FDNAMES");
    for (; at != NULL && i > 0; i--) {
        at = strchr(at, ':');
        at = at == NULL ? NULL : at + 1;
    }
    snprintf(name, size, "%.*s", at == NULL ? 0 : (int)strcspn(at, ":"), at == NULL ? "" : at);
}

/* The address that a path stands for ('@': a name that is in no directory): its length, 0: none. */
static socklen_t fill_address(const char *path, struct sockaddr_un *address)
{
    const size_t length = strlen(path);
    memset(address, 0, sizeof *address);
    address->sun_family = AF_UNIX;
    if ((path[0] != '/' && path[0] != '@') || length >= sizeof address->sun_path) {
        return 0;
    }
    memcpy(address->sun_path, path, length);
    if (path[0] == '@') {
        address->sun_path[0] = '\0';
    }
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
}

void supervisor_tell(const char *text)
{
    struct sockaddr_un address;
    const char *path = getenv("NOTIFY_SOCKET");
    const socklen_t length = path == NULL ? 0 : fill_address(path, &address);
    if (length == 0) {
        return;
    }
    const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
    if (fd < 0) {
        return;
    }
    /* A supervisor that does not read misses something; nobody waits for it. */
    if (fcntl(fd, F_SETFL, O_NONBLOCK) == 0) {
        (void)sendto(fd, text, strlen(text), 0, (const struct sockaddr *)&address, length);
    }
    close(fd);
}

uint64_t supervisor_watchdog_ns(void)
{
    const bool is_ours = getenv("WATCHDOG_PID") == NULL || is_for_us("WATCHDOG_PID");
    return is_ours ? number_of("WATCHDOG_USEC", UINT64_MAX / 1000) * 1000 : 0;
}
