/*
 * Sockets on Windows.  There are no Unix sockets here: modules and central use TCP.
 */
#include "platform/sockets.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"

enum { MAX_SLICES = 64, MAX_BYTES = 1 << 30 };

/* ------------------------------------------------------------------ failures */

/* The numbers of Winsock for which there are others in errno.h. */
static const struct {
    int winsock;
    int number;
    const char *text; /* the C library has not all of them */
} reasons[] = {
    {WSAEACCES, EACCES, "Permission denied"},
    {WSAEADDRINUSE, EADDRINUSE, "Address already in use"},
    {WSAEADDRNOTAVAIL, EADDRNOTAVAIL, "Cannot assign requested address"},
    {WSAEAFNOSUPPORT, EAFNOSUPPORT, "Address family not supported"},
    {WSAECONNREFUSED, ECONNREFUSED, "Connection refused"},
    {WSAECONNRESET, ECONNRESET, "Connection reset by peer"},
    {WSAEMFILE, EMFILE, "Too many open sockets"},
    {WSAENETUNREACH, ENETUNREACH, "Network is unreachable"},
    {WSAENOBUFS, ENOBUFS, "No buffer space available"},
    {WSAENOTSOCK, ENOTSOCK, "Not a socket"},
    {WSAETIMEDOUT, ETIMEDOUT, "Connection timed out"},
    {WSAEWOULDBLOCK, EWOULDBLOCK, "Operation would block"},
};

enum { N_REASONS = sizeof reasons / sizeof *reasons };

static int number_of(int winsock)
{
    for (size_t i = 0; i < N_REASONS; i++) {
        if (reasons[i].winsock == winsock) {
            return reasons[i].number;
        }
    }
    return EIO;
}

int sockets_failure(void)
{
    errno = number_of(WSAGetLastError());
    return ERR_IO;
}

const char *system_reason(void)
{
    for (size_t i = 0; i < N_REASONS; i++) {
        if (reasons[i].number == errno) {
            return reasons[i].text;
        }
    }
    return strerror(errno);
}

/* ------------------------------------------------------------------- sockets */

static BOOL CALLBACK start_winsock(INIT_ONCE *once, void *argument, void **context)
{
    WSADATA data;
    (void)once;
    (void)argument;
    (void)context;
    (void)WSAStartup(MAKEWORD(2, 2), &data); /* without it every other function fails and says so */
    return TRUE;
}

void sockets_start(void)
{
    static INIT_ONCE once = INIT_ONCE_STATIC_INIT;
    (void)InitOnceExecuteOnce(&once, start_winsock, NULL, NULL);
}

static int ready_socket(SOCKET socket)
{
    u_long on = 1;
    (void)SetHandleInformation((HANDLE)socket, HANDLE_FLAG_INHERIT,
                               0); /* at worst a child has it */
    return ioctlsocket(socket, (long)FIONBIO, &on) == 0 ? 0 : ERR_IO;
}

int socket_new(int family, int *fd)
{
    sockets_start();
    const SOCKET made = socket(family, SOCK_STREAM, 0);
    *fd = socket_descriptor(made);
    if (made == INVALID_SOCKET) {
        return sockets_failure();
    }
    return ready_socket(made) == 0 ? 0 : socket_close_with(*fd, ERR_IO);
}

static void set_option(int fd, int level, int option)
{
    const BOOL on = TRUE;
    (void)setsockopt(socket_of(fd), level, option, (const char *)&on, sizeof on);
}

/* Each is a wish, so a refusal is of no matter. */
void socket_tune_tcp(int fd)
{
    set_option(fd, IPPROTO_TCP, TCP_NODELAY);
    set_option(fd, SOL_SOCKET, SO_KEEPALIVE);
}

/* A port that was left can be had at once here; SO_REUSEADDR would share one that is in use. */
bool socket_may_rebind(int fd)
{
    const BOOL on = TRUE;
    return setsockopt(socket_of(fd), SOL_SOCKET, SO_EXCLUSIVEADDRUSE, (const char *)&on,
                      sizeof on) == 0;
}

int socket_close_with(int fd, int error)
{
    const int reason = number_of(WSAGetLastError());
    (void)closesocket(socket_of(fd));
    errno = reason;
    return error;
}

int net_accept(int listener, int *fd)
{
    SOCKET taken;
    do {
        taken = accept(socket_of(listener), NULL, NULL);
    } while (taken == INVALID_SOCKET && WSAGetLastError() == WSAECONNRESET);
    *fd = socket_descriptor(taken);
    if (taken == INVALID_SOCKET) {
        const int reason = WSAGetLastError();
        if (reason == WSAEWOULDBLOCK) {
            return 1;
        }
        (void)sockets_failure();
        return reason == WSAEMFILE || reason == WSAENOBUFS ? ERR_LIMIT : ERR_IO;
    }
    if (ready_socket(taken) != 0) {
        return socket_close_with(*fd, ERR_IO);
    }
    socket_tune_tcp(*fd);
    return 0;
}

int net_open_spare(void)
{
    sockets_start();
    return socket_descriptor(socket(AF_INET, SOCK_DGRAM, 0));
}

/* ---------------------------------------------------------------- connecting */

bool socket_is_connecting(void)
{
    return WSAGetLastError() == WSAEWOULDBLOCK;
}

/* Waits for what comes of connecting: as socket_look_at_connection, which the wait makes.  WSAPoll
 * would not tell of failures before Windows 10. */
static int look_for(int fd, int timeout_ms)
{
    struct timeval limit = {timeout_ms / 1000, timeout_ms % 1000 * 1000};
    fd_set connected;
    fd_set failed;
    FD_ZERO(&connected);
    FD_ZERO(&failed);
    ready_set_add(&connected, fd);
    ready_set_add(&failed, fd);
    const int n = select(0, NULL, &connected, &failed, &limit);
    if (n <= 0) {
        return n == 0 ? 1 : sockets_failure();
    }
    if (connected.fd_count > 0) {
        return 0;
    }
    int reason = 0;
    int length = sizeof reason;
    (void)getsockopt(socket_of(fd), SOL_SOCKET, SO_ERROR, (char *)&reason, &length);
    errno = number_of(reason);
    return ERR_REFUSED;
}

int socket_look_at_connection(int fd)
{
    return look_for(fd, 0);
}

/* No signal ends a wait here, so that give_up is asked now and then. */
int socket_await_connection(int fd, uint64_t deadline_ns, int (*give_up)(void))
{
    enum { ASK_MS = 100 };
    int result;
    do {
        const uint64_t now = clock_ns();
        const uint64_t left_ms = now < deadline_ns ? (deadline_ns - now) / 1000000u + 1 : 0;
        result = look_for(fd, left_ms < ASK_MS ? (int)left_ms : ASK_MS);
        if (result == 1 && (clock_ns() >= deadline_ns || (give_up != NULL && give_up() != 0))) {
            result = ERR_TIMEOUT;
        }
    } while (result == 1);
    return result;
}

/* ---------------------------------------------------------- reading, writing */

static int failure_of_connection(void)
{
    switch (WSAGetLastError()) {
    case WSAEWOULDBLOCK:
        return 0;
    case WSAECONNRESET:
    case WSAECONNABORTED:
    case WSAESHUTDOWN:
        return ERR_CLOSED;
    default:
        return sockets_failure();
    }
}

bool net_acknowledge(int fd)
{
    (void)fd;
    return false; /* Windows has no such request */
}

ptrdiff_t net_read(int fd, void *bytes, size_t room)
{
    const int n = recv(socket_of(fd), bytes, (int)(room < MAX_BYTES ? room : MAX_BYTES), 0);
    if (n == 0) {
        return ERR_CLOSED;
    }
    return n > 0 ? n : failure_of_connection();
}

ptrdiff_t net_write(int fd, const struct net_slice *slices, size_t n_slices)
{
    WSABUF parts[MAX_SLICES];
    DWORD n = 0;
    DWORD written = 0;
    bool whole = true;
    for (; n < n_slices && n < MAX_SLICES && whole; n++) {
        const size_t length = slices[n].length;
        whole = length <= MAX_BYTES; /* what follows a part of a slice has to wait for the rest */
        /* WSASend does not write through the pointer, whatever WSABUF's type says. */
        parts[n].buf = (char *)(uintptr_t)slices[n].bytes;
        parts[n].len = (u_long)(whole ? length : MAX_BYTES);
    }
    return WSASend(socket_of(fd), parts, n, &written, 0, NULL, NULL) == 0 ? (ptrdiff_t)written
                                                                          : failure_of_connection();
}

void net_close(int fd)
{
    (void)shutdown(socket_of(fd), SD_BOTH); /* fails where the peer was faster, which is as good */
    (void)closesocket(socket_of(fd));
}

void net_close_copy(int fd)
{
    (void)closesocket(socket_of(fd));
}

/* -------------------------------------------------------------------- names */

void net_host_name(char *name, size_t size)
{
    char whole[NET_NAME_SIZE];
    sockets_start();
    if (gethostname(whole, sizeof whole) != 0) {
        snprintf(whole, sizeof whole, "localhost");
    }
    whole[sizeof whole - 1] = '\0';
    snprintf(name, size, "%s", whole);
}

long net_raise_descriptor_limit(void)
{
    return 1L << 24; /* as many handles as a process may have */
}

/* ------------------------------------------------------------- Unix sockets */

static int without_local(void)
{
    errno = EAFNOSUPPORT;
    return ERR_IO;
}

bool net_has_local(void)
{
    return false;
}

int net_adopt(int fd, bool *local, int *port)
{
    (void)fd;
    (void)local;
    (void)port;
    return without_local();
}

int net_listen_local(const char *path, unsigned mode, struct net_local *listener)
{
    (void)path;
    (void)mode;
    listener->fd = -1;
    return without_local();
}

void net_remove_local(const struct net_local *listener)
{
    (void)listener;
}

void net_close_local(struct net_local *listener)
{
    (void)listener;
}

int net_connect_local(const char *path, int *fd)
{
    (void)path;
    *fd = -1;
    return without_local();
}
