/*
 * What the project needs from an operating system.
 *
 * Each folder beside this header implements all of it for one family of
 * systems; no other place asks which system it is.  Sockets are non-blocking,
 * closed on exec, and never raise a signal.
 */
#ifndef IPC_PLATFORM_PLATFORM_H
#define IPC_PLATFORM_PLATFORM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What the system says of the failure behind an ERR_IO that has just been returned. */
const char *system_reason(void);

/* ----------------------------------------------------------------- sockets */

#define NET_SOCKET_DIRECTORY "/tmp/x_ipc"
#define NET_NAME_SIZE 256 /* enough for any host name or numeric address */

/* Listens on TCP at an address, a name or a number, IPv4 or IPv6 (NULL: all of IPv4); *port 0 asks for
 * any free one, and is set to the one in use: 0, ERR_UNKNOWN (no such address), ERR_IO. */
int net_listen_tcp(const char *address, int *port, int *fd);

/* Takes over a socket that listens already: whether it is a Unix socket, and its port, or the number
 * that its path ends in (0: none).  0, or ERR_IO (it is no such socket). */
int net_adopt(int fd, bool *local, int *port);

/* Whether the system has Unix sockets; without them, those that follow fail. */
bool net_has_local(void);

#define NET_PATH_SIZE 108 /* bytes of the longest socket path, with its NUL */

/* A Unix socket that listens, and which file it made, so that no other is ever removed. */
struct net_local {
    int fd; /* -1: none */
    uint64_t device;
    uint64_t inode;
    int64_t process; /* that made the file: a child's copy leaves it alone */
    char path[NET_PATH_SIZE];
};

/* Listens on a Unix socket under path, making the common directory where that is meant; an abandoned
 * socket there is replaced: 0, ERR_REFUSED (somebody else listens there), ERR_LIMIT (path too long),
 * ERR_IO. */
int net_listen_local(const char *path, unsigned mode, struct net_local *listener);

/* Removes the listener's path if that is still the file it made.  May be called at any time. */
void net_remove_local(const struct net_local *listener);

/* Closes the listener and removes its path. */
void net_close_local(struct net_local *listener);

/* Accepts one connection: 0, or 1 when none is waiting, or ERR_LIMIT (out of descriptors or memory),
 * ERR_IO. */
int net_accept(int listener, int *fd);

/* A descriptor whose only use is to be given up; -1: none. */
int net_open_spare(void);

/* Accepts one connection and closes it, for which the spare descriptor makes room for a moment:
 * 0, 1 when none is waiting, ERR_LIMIT, ERR_IO. */
int net_refuse(int listener, int *spare);

/* Connects, waiting at most timeout_ms: 0 or ERR_REFUSED, ERR_TIMEOUT, ERR_UNKNOWN (no such host), ERR_IO.
 * give_up (may be NULL) is asked when a signal was caught: anything but 0 is the end of the time. */
int net_connect_tcp(const char *host, int port, int timeout_ms, int (*give_up)(void), int *fd);
int net_connect_local(const char *path, int *fd);

/* Begins to connect to a numeric address, without waiting: 0 or ERR_UNKNOWN (not numeric), ERR_REFUSED, ERR_IO. */
int net_start_tcp(const char *address, int port, int *fd);

/* How far that has come: 0 (connected), 1 (not yet; the descriptor will be writable), ERR_REFUSED, ERR_IO. */
int net_look_at_start(int fd);

struct net_slice {
    const void *bytes;
    size_t length;
};

/* Number of bytes read (at least 1), 0 when none is there now, ERR_CLOSED, ERR_IO. */
ptrdiff_t net_read(int fd, void *bytes, size_t room);

/* Tells the sender at once what has been read, where the system would wait for more to say first: a
 * sender with a small buffer waits for that meanwhile.  false: there is nothing like that here. */
bool net_acknowledge(int fd);

/* Number of bytes written, 0 when the kernel takes none now, ERR_CLOSED, ERR_IO. */
ptrdiff_t net_write(int fd, const struct net_slice *slices, size_t n_slices);

/* Ends both directions and closes. */
void net_close(int fd);

/* Closes this process's copy only; the connection lives on in others. */
void net_close_copy(int fd);

/* This host's name, cut to size - 1 bytes. */
void net_host_name(char *name, size_t size);

/* Numeric address of the peer of a TCP connection, or of this end of it; "" for others. */
void net_peer_address(int fd, char *name, size_t size);
void net_own_address(int fd, char *name, size_t size);

/* The name of a numeric address, if it leads back to that address, else "".  Waits for the network. */
void net_find_name(const char *number, char name[NET_NAME_SIZE]);

/* Lets the process have as many descriptors as the system allows, and returns that number. */
long net_raise_descriptor_limit(void);

/* --------------------------------------------------------------- readiness */

enum {
    READY_READ = 1,
    READY_WRITE = 2,
    READY_ERROR = 4,  /* failed or hung up; what is left may still be read */
    READY_INVALID = 8 /* not an open descriptor */
};

struct ready_item {
    int fd;
    short wanted; /* READY_READ | READY_WRITE */
    short found;  /* also READY_ERROR, READY_INVALID */
};

/* Waits for any of a few descriptors (-1: none), timeout_ms -1 for ever: number of items found, 0, or
 * ERR_IO.  A signal does not end the wait. */
int ready_wait(struct ready_item *items, size_t n_items, int64_t timeout_ms);

/* The same, but a signal that is caught ends the wait as if its time were over. */
int ready_wait_or_signal(struct ready_item *items, size_t n_items, int64_t timeout_ms);

/* A set of many descriptors whose cost does not grow with those that are idle. */
struct poller;

struct poller_event {
    void *owner;
    int found;
};

struct poller *poller_new(void); /* NULL: the system refused */
void poller_free(struct poller *poller);

/* A descriptor that is readable when the set has an event; -1 where there is no such thing. */
int poller_descriptor(const struct poller *poller);
int poller_add(struct poller *poller, int fd, int wanted, void *owner);
int poller_change(struct poller *poller, int fd, int wanted, void *owner);
void poller_remove(struct poller *poller, int fd);

/* Number of events (at most room), 0 at the time-out or after a signal, ERR_IO. */
int poller_wait(struct poller *poller, struct poller_event *events, int room, int64_t timeout_ms);

/* A descriptor that is readable from waker_wake until waker_clear; wake may be called in signal handlers. */
struct waker {
    int read_fd;
    int write_fd;
};
int waker_open(struct waker *waker);
void waker_close(struct waker *waker);
void waker_wake(const struct waker *waker);
void waker_clear(const struct waker *waker);

/* Adds a descriptor to the system's fd_set, unless that cannot hold it. */
void ready_set_add(void *fd_set, int fd);

/* ------------------------------------------------------------------- clock */

/* Monotonic, from an arbitrary start. */
uint64_t clock_ns(void);

/* ------------------------------------------------------------------ memory */

/* How many bytes a malloc block really has; 0 where the system does not tell. */
size_t memory_usable_size(void *block);

/* ----------------------------------------------------------------- threads */

struct mutex;
struct condition;

struct mutex *mutex_new(void);
void mutex_free(struct mutex *mutex);
void mutex_lock(struct mutex *mutex);
void mutex_unlock(struct mutex *mutex);

struct condition *condition_new(void);
void condition_free(struct condition *condition);

/* Waits until told or until clock_ns() reaches deadline_ns (UINT64_MAX: for ever); may wake early. */
void condition_wait(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns);
void condition_tell_all(struct condition *condition);

/* A number that is this thread's alone while it lives, never 0. */
uintptr_t thread_number(void);

/* Runs a function in a thread of its own, which gets no signals and for which nobody waits: 0, ERR_IO. */
int thread_start(void (*run)(void *argument), void *argument);

/* Runs initialise in the first call in this process; others wait until it is done. */
void thread_once(void (*initialise)(void));

#endif
