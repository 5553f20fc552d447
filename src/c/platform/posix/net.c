/*
 * Sockets on POSIX systems.
 */
#define _XOPEN_SOURCE 700
#include "platform/sockets.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/error.h"

#ifndef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0 /* systems without it have SO_NOSIGPIPE */
#endif

enum { LOCAL_BUFFER = 1 << 20, MAX_SLICES = 64 };

const char *system_reason(void)
{
    return strerror(errno);
}

static int ready_socket(int fd)
{
    const int flags = fcntl(fd, F_GETFL);
    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0 ||
        fcntl(fd, F_SETFD, FD_CLOEXEC) < 0) {
        return ERR_IO;
    }
#ifdef SO_NOSIGPIPE
    const int on = 1;
    (void)setsockopt(fd, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on); /* a second line of defence */
#endif
    return 0;
}

int socket_new(int family, int *fd)
{
    *fd = socket(family, SOCK_STREAM, 0);
    if (*fd < 0) {
        return ERR_IO;
    }
    if (ready_socket(*fd) != 0) {
        close(*fd);
        return ERR_IO;
    }
    return 0;
}

bool socket_may_rebind(int fd)
{
    const int on = 1;
    return setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0;
}

/* Each is a wish, so a refusal is of no matter. */
void socket_tune_tcp(int fd)
{
    const int on = 1;
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
}

/* Unix sockets have small default buffers, which cost a context switch per piece of a long message. */
static void tune_local(int fd)
{
    const int size = LOCAL_BUFFER;
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
}

int socket_close_with(int fd, int error)
{
    const int saved = errno;
    close(fd);
    errno = saved;
    return error;
}

/* --------------------------------------------------------------- listening */

bool net_has_local(void)
{
    return true;
}

static bool listens(int fd)
{
    int type = 0;
    int on = 0;
    socklen_t length = sizeof type;
    const bool is_stream =
        getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &length) == 0 && type == SOCK_STREAM;
    length = sizeof on;
    return is_stream && getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &on, &length) == 0 && on != 0;
}

/* The number at the end of a path, 0: none. */
static int number_of_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash == NULL ? path : slash + 1;
    const size_t length = strspn(name, "0123456789");
    return length > 0 && length <= 5 && name[length] == '\0' ? atoi(name) : 0;
}

int net_adopt(int fd, bool *local, int *port)
{
    union {
        struct sockaddr_storage any;
        struct sockaddr_un local;
    } name;
    socklen_t length = sizeof name;
    memset(&name, 0, sizeof name); /* so that a path has its end */
    /* Who connects is told which process has called listen last; that is the one that accepts. */
    if (!listens(fd) || getsockname(fd, (struct sockaddr *)&name, &length) < 0 ||
        ready_socket(fd) != 0 || listen(fd, SOCKET_BACKLOG) < 0) {
        return ERR_IO;
    }
    *local = name.any.ss_family == AF_UNIX;
    *port = *local ? number_of_path(name.local.sun_path) : socket_port_of(&name.any);
    return 0;
}

static int fill_local(const char *path, struct sockaddr_un *name)
{
    memset(name, 0, sizeof *name);
    name->sun_family = AF_UNIX;
    if (strlen(path) >= sizeof name->sun_path || strlen(path) >= NET_PATH_SIZE) {
        return ERR_LIMIT;
    }
    memcpy(name->sun_path, path, strlen(path));
    return 0;
}

/* Everybody may make sockets in the common directory, nobody may remove another's. */
static void make_directory_of(const char *path)
{
    if (strncmp(path, NET_SOCKET_DIRECTORY "/", sizeof NET_SOCKET_DIRECTORY) == 0 &&
        mkdir(NET_SOCKET_DIRECTORY, 0777) == 0) {
        /* The umask has cut mkdir's mode; bind reports what matters. */
        (void)chmod(NET_SOCKET_DIRECTORY, S_ISVTX | 0777);
    }
}

/* Removes a socket on which nobody listens any more: 0, ERR_REFUSED when it is in use, ERR_IO. */
static int remove_abandoned(const char *path)
{
    struct stat status;
    if (lstat(path, &status) < 0) {
        return 0;
    }
    if (!S_ISSOCK(status.st_mode)) {
        errno = EEXIST; /* somebody's file, whatever it is */
        return ERR_IO;
    }
    int fd;
    if (net_connect_local(path, &fd) == 0) {
        net_close(fd);
        return ERR_REFUSED;
    }
    return unlink(path) == 0 ? 0 : ERR_IO;
}

int net_listen_local(const char *path, unsigned mode, struct net_local *listener)
{
    struct sockaddr_un name;
    struct stat status;
    listener->fd = -1;
    int error = fill_local(path, &name);
    if (error == 0) {
        make_directory_of(path);
        error = remove_abandoned(path);
    }
    if (error == 0) {
        error = socket_new(AF_UNIX, &listener->fd);
    }
    if (error != 0) {
        listener->fd = -1;
        return error;
    }
    tune_local(listener->fd);
    if (bind(listener->fd, (struct sockaddr *)&name, sizeof name) < 0 ||
        listen(listener->fd, SOCKET_BACKLOG) < 0 || chmod(path, (mode_t)mode) < 0 ||
        lstat(path, &status) < 0) {
        error = socket_close_with(listener->fd, ERR_IO);
        listener->fd = -1;
        return error;
    }
    memcpy(listener->path, path, strlen(path) + 1);
    listener->device = (uint64_t)status.st_dev;
    listener->inode = (uint64_t)status.st_ino;
    listener->process = getpid();
    return 0;
}

void net_remove_local(const struct net_local *listener)
{
    struct stat status;
    if (listener->fd >= 0 && listener->process == getpid() && lstat(listener->path, &status) == 0 &&
        (uint64_t)status.st_dev == listener->device && (uint64_t)status.st_ino == listener->inode) {
        (void)unlink(listener->path); /* at worst a stale file stays, which the next one replaces */
    }
}

void net_close_local(struct net_local *listener)
{
    net_remove_local(listener);
    if (listener->fd >= 0) {
        close(listener->fd);
        listener->fd = -1;
    }
}

int net_accept(int listener, int *fd)
{
    struct sockaddr_storage name;
    socklen_t length = sizeof name;
    for (;;) {
        *fd = accept(listener, (struct sockaddr *)&name, &length);
        if (*fd >= 0) {
            break;
        }
        if (errno == EAGAIN || errno == EWOULDBLOCK) {
            return 1;
        }
        if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            return ERR_LIMIT;
        }
        if (errno != EINTR && errno != ECONNABORTED && errno != EPROTO) {
            return ERR_IO;
        }
    }
    if (ready_socket(*fd) != 0) {
        return socket_close_with(*fd, ERR_IO);
    }
    if (name.ss_family == AF_INET || name.ss_family == AF_INET6) {
        socket_tune_tcp(*fd);
    } else {
        tune_local(*fd);
    }
    return 0;
}

int net_open_spare(void)
{
    return open("/dev/null", O_RDONLY | O_CLOEXEC);
}

/* -------------------------------------------------------------- connecting */

bool socket_is_connecting(void)
{
    return errno == EINPROGRESS || errno == EINTR;
}

/* Whether a connection that is no longer under way has come about. */
static int result_of_connecting(int fd)
{
    int reason = 0;
    socklen_t length = sizeof reason;
    if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &reason, &length) < 0) {
        return ERR_IO;
    }
    errno = reason;
    return reason == 0 ? 0 : ERR_REFUSED;
}

int socket_await_connection(int fd, uint64_t deadline_ns, int (*give_up)(void))
{
    for (;;) {
        const uint64_t now = clock_ns();
        const int left_ms = now >= deadline_ns ? 0 : (int)((deadline_ns - now) / 1000000u) + 1;
        struct pollfd item = {fd, POLLOUT, 0};
        const int n = poll(&item, 1, left_ms);
        if (n > 0) {
            break;
        }
        if (n == 0 && clock_ns() >= deadline_ns) {
            return ERR_TIMEOUT;
        }
        if (n < 0 && errno != EINTR) {
            return ERR_IO;
        }
        if (n < 0 && give_up != NULL && give_up() != 0) {
            return ERR_TIMEOUT;
        }
    }
    return result_of_connecting(fd);
}

int socket_look_at_connection(int fd)
{
    struct pollfd item = {fd, POLLOUT, 0};
    const int n = poll(&item, 1, 0);
    if (n == 0 || (n < 0 && errno == EINTR)) {
        return 1;
    }
    return n < 0 ? ERR_IO : result_of_connecting(fd);
}

int net_connect_local(const char *path, int *fd)
{
    struct sockaddr_un name;
    int error = fill_local(path, &name);
    if (error != 0) {
        return error;
    }
    error = socket_new(AF_UNIX, fd);
    if (error != 0) {
        return error;
    }
    tune_local(*fd);
    if (connect(*fd, (struct sockaddr *)&name, sizeof name) < 0) {
        return socket_close_with(*fd, ERR_REFUSED);
    }
    return 0;
}

/* -------------------------------------------------------- reading, writing */

bool net_acknowledge(int fd)
{
#if defined(TCP_QUICKACK)
    const int on = 1;
    /* No Unix socket has it. */
    return setsockopt(fd, IPPROTO_TCP, TCP_QUICKACK, &on, sizeof on) == 0;
#else
    (void)fd;
    return false;
#endif
}

ptrdiff_t net_read(int fd, void *bytes, size_t room)
{
    for (;;) {
        const ssize_t n = recv(fd, bytes, room, 0);
        if (n > 0) {
            return n;
        }
        if (n == 0) {
            return ERR_CLOSED;
        }
        if (errno == EAGAIN || errno == EWOULDBLOCK) {
            return 0;
        }
        if (errno != EINTR) {
            return errno == ECONNRESET ? ERR_CLOSED : ERR_IO;
        }
    }
}

static ssize_t send_slices(int fd, const struct net_slice *slices, size_t n_slices)
{
    if (n_slices == 1) {
        return send(fd, slices[0].bytes, slices[0].length, MSG_NOSIGNAL);
    }
    struct iovec parts[MAX_SLICES];
    struct msghdr message;
    /* 16 bits, since msg_iovlen is a size_t to some systems and an int to others. */
    const uint16_t n = (uint16_t)(n_slices < MAX_SLICES ? n_slices : MAX_SLICES);
    for (size_t i = 0; i < n; i++) {
        /* sendmsg does not write through the pointer, whatever iovec's type says. */
        parts[i].iov_base = (void *)(uintptr_t)slices[i].bytes;
        parts[i].iov_len = slices[i].length;
    }
    memset(&message, 0, sizeof message);
    message.msg_iov = parts;
    message.msg_iovlen = n;
    return sendmsg(fd, &message, MSG_NOSIGNAL);
}

ptrdiff_t net_write(int fd, const struct net_slice *slices, size_t n_slices)
{
    for (;;) {
        const ssize_t n = send_slices(fd, slices, n_slices);
        if (n >= 0) {
            return n;
        }
        if (errno == EAGAIN || errno == EWOULDBLOCK) {
            return 0;
        }
        if (errno != EINTR) {
            return errno == EPIPE || errno == ECONNRESET ? ERR_CLOSED : ERR_IO;
        }
    }
}

void net_close(int fd)
{
    (void)shutdown(fd, SHUT_RDWR); /* fails where the peer was faster, which is as good */
    close(fd);
}

void net_close_copy(int fd)
{
    close(fd);
}

/* -------------------------------------------------------------------- names */

void net_host_name(char *name, size_t size)
{
    char whole[NET_NAME_SIZE]; /* a name that has no room is an error to some systems */
    if (gethostname(whole, sizeof whole) != 0) {
        snprintf(whole, sizeof whole, "localhost");
    }
    whole[sizeof whole - 1] = '\0';
    snprintf(name, size, "%s", whole);
}

long net_raise_descriptor_limit(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) < 0) {
        return 1024;
    }
    if (limit.rlim_cur < limit.rlim_max) {
        limit.rlim_cur = limit.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &limit); /* the old limit then stays, and is returned */
        (void)getrlimit(RLIMIT_NOFILE, &limit);
    }
    return limit.rlim_cur > 1000000000u ? 1000000000L : (long)limit.rlim_cur;
}
