/*
 * Standard streams, signals and the time of day on POSIX systems.
 */
#define _XOPEN_SOURCE 700
#include "platform/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"

/* A pipe that poll calls writable takes this much at once (POSIX promises 512, systems give a
 * page). */
enum { PIPE_PIECE = 4096 };

void process_complete_streams(void)
{
    int fd;
    do {
        fd = open("/dev/null", O_RDWR);
    } while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd > STDERR_FILENO) {
        close(fd);
    }
}

int stream_open(const char *name, bool append, int *fd)
{
    *fd = open(name, O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK | (append ? O_APPEND : O_TRUNC),
               0666);
    return *fd < 0 ? ERR_IO : 0;
}

void stream_close(int fd)
{
    close(fd);
}

uint64_t stream_size(int fd)
{
    struct stat status;
    return fstat(fd, &status) == 0 && S_ISREG(status.st_mode) ? (uint64_t)status.st_size : 0;
}

static bool is_ready(int fd, short events)
{
    struct pollfd item = {fd, events, 0};
    return poll(&item, 1, 0) > 0;
}

ptrdiff_t stream_read(int fd, void *bytes, size_t room)
{
    if (!is_ready(fd, POLLIN)) {
        return 0;
    }
    const ssize_t n = read(fd, bytes, room);
    if (n > 0) {
        return n;
    }
    if (n == 0) {
        return ERR_CLOSED;
    }
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : ERR_IO;
}

/*
 * A terminal that is called writable may still take less than it is given, and
 * then the write waits.  Its flags are shared with other processes, so they are
 * changed for this one write only.
 */
static ssize_t write_terminal(int fd, const void *bytes, size_t count)
{
    const int flags = fcntl(fd, F_GETFL);
    if (flags >= 0) {
        (void)fcntl(fd, F_SETFL,
                    flags | O_NONBLOCK); /* a refusal only means that the write may wait */
    }
    const ssize_t n = write(fd, bytes, count);
    const int saved = errno;
    if (flags >= 0) {
        (void)fcntl(fd, F_SETFL, flags);
    }
    errno = saved;
    return n;
}

static ssize_t write_once(int fd, const void *bytes, size_t count)
{
    struct stat status;
    if (fstat(fd, &status) < 0) {
        return -1;
    }
    if (S_ISCHR(status.st_mode)) {
        return write_terminal(fd, bytes, count);
    }
    if (S_ISREG(status.st_mode)) {
        return write(fd, bytes, count);
    }
    return write(fd, bytes, count < PIPE_PIECE ? count : PIPE_PIECE);
}

ptrdiff_t stream_write(int fd, const void *bytes, size_t count)
{
    size_t written = 0;
    while (written < count && is_ready(fd, POLLOUT)) {
        const ssize_t n = write_once(fd, (const char *)bytes + written, count - written);
        if (n > 0) {
            written += (size_t)n;
        } else if (n == 0 || errno == EAGAIN || errno == EWOULDBLOCK) {
            break;
        } else if (errno != EINTR) {
            return errno == EPIPE ? ERR_CLOSED : ERR_IO;
        }
    }
    return (ptrdiff_t)written;
}

bool stream_write_all(int fd, const void *bytes, size_t count)
{
    const char *at = bytes;
    while (count > 0) {
        const ssize_t n = write(fd, at, count);
        if (n > 0) {
            at += n;
            count -= (size_t)n;
        } else if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            struct pollfd item = {fd, POLLOUT, 0};
            (void)poll(&item, 1, -1); /* a failure shows at the next try */
        } else if (n < 0 && errno != EINTR) {
            return false;
        }
    }
    return true;
}

int stream_watched(int fd)
{
    return fd;
}

bool stream_is_terminal(int fd)
{
    return isatty(fd) == 1;
}

/* ------------------------------------------------------------------ signals */

/* A signal handler gets no argument of ours, so what it needs has to stand here. */
static struct {
    const struct waker *waker;
    volatile sig_atomic_t interrupted;
    volatile sig_atomic_t terminated;
    volatile sig_atomic_t hung_up;
} caught;

static void note_signal(int number)
{
    if (number == SIGINT) {
        caught.interrupted = 1;
    } else if (number == SIGTERM) {
        caught.terminated = 1;
    } else {
        caught.hung_up = 1;
    }
    waker_wake(caught.waker);
}

static int catch_signal(int number, void (*handler)(int))
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    return sigaction(number, &action, NULL) == 0 ? 0 : ERR_IO;
}

int process_catch_signals(const struct waker *waker)
{
    caught.waker = waker;
    const bool done = catch_signal(SIGINT, note_signal) == 0 &&
                      catch_signal(SIGTERM, note_signal) == 0 &&
                      catch_signal(SIGHUP, note_signal) == 0 && catch_signal(SIGPIPE, SIG_IGN) == 0;
    return done ? 0 : ERR_IO;
}

static bool take(volatile sig_atomic_t *flag)
{
    const bool was_set = *flag != 0;
    *flag = 0;
    return was_set;
}

int process_take_signal(void)
{
    if (take(&caught.interrupted)) {
        return SIGINT;
    }
    if (take(&caught.terminated)) {
        return SIGTERM;
    }
    return take(&caught.hung_up) ? SIGHUP : 0;
}

bool process_signal_ends(int number)
{
    return number == SIGINT || number == SIGTERM;
}

/* -------------------------------------------------------------- time of day */

void clock_local(struct local_time *local)
{
    struct timeval now;
    struct tm parts;
    gettimeofday(&now, NULL);
    const time_t seconds = now.tv_sec;
    memset(&parts, 0, sizeof parts);
    localtime_r(&seconds, &parts);
    local->year = parts.tm_year + 1900;
    local->month = parts.tm_mon + 1;
    local->day = parts.tm_mday;
    local->weekday = parts.tm_wday;
    local->hour = parts.tm_hour;
    local->minute = parts.tm_min;
    local->second = parts.tm_sec;
    local->hundredths = (int)(now.tv_usec / 10000);
    local->epoch = (int64_t)seconds;
}

void clock_utc(char text[CLOCK_UTC_SIZE])
{
    struct timespec now = {0, 0};
    struct tm parts;
    char seconds[CLOCK_UTC_SIZE];
    clock_gettime(CLOCK_REALTIME, &now);
    memset(&parts, 0, sizeof parts);
    gmtime_r(&now.tv_sec, &parts);
    (void)strftime(seconds, sizeof seconds, "%Y-%m-%dT%H:%M:%S", &parts);
    (void)snprintf(text, CLOCK_UTC_SIZE, "%.20s.%09ldZ", seconds, now.tv_nsec);
}
