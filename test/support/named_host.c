/*
 * Another network around a program: what this machine is called, which other names mean it, and
 * where the default port of central is.
 *
 * Linked into a program, these functions take the place of the C library's, for the program and for
 * the libraries that it uses:
 *
 *   IPC_TEST_OWN_NAME      the name of this machine
 *   IPC_TEST_HOSTS         names, with blanks between them, that mean 127.0.0.1
 *   IPC_TEST_UNKNOWN       a name that nobody knows
 *   IPC_TEST_DEFAULT_PORT  the port that is reached by connecting to 1381
 */
#define _GNU_SOURCE /* RTLD_NEXT */
#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#define DEFAULT_PORT 1381
#define DEFAULT_PATH "/tmp/x_ipc/1381"

typedef int connect_function(int, const struct sockaddr *, socklen_t);
typedef int getaddrinfo_function(const char *, const char *, const struct addrinfo *,
                                 struct addrinfo **);
typedef struct hostent *gethostbyname_function(const char *);

/* The function whose place another one here takes; function points to a pointer to it. */
static void find_original(const char *name, void *function)
{
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(function, &found, sizeof found);
}

static const char *setting(const char *name)
{
    const char *value = getenv(name);
    return value ? value : "";
}

static bool is_known(const char *host)
{
    size_t length = strlen(host);
    for (const char *at = setting("IPC_TEST_HOSTS"); *at;) {
        size_t word = strcspn(at, " ");
        if (word == length && strncmp(at, host, length) == 0) {
            return true;
        }
        at += word + strspn(at + word, " ");
    }
    return false;
}

/* As the C library's: of a name that is too long comes what has room, without an end. */
int gethostname(char *name, size_t size)
{
    const char *own = setting("IPC_TEST_OWN_NAME");
    size_t wanted = strlen(own) + 1;
    memcpy(name, own, wanted < size ? wanted : size);
    if (wanted > size) {
        errno = ENAMETOOLONG;
        return -1;
    }
    return 0;
}

int getaddrinfo(const char *host, const char *service, const struct addrinfo *hints,
                struct addrinfo **found)
{
    getaddrinfo_function *original;
    find_original("getaddrinfo", &original);
    if (host && strcmp(host, setting("IPC_TEST_UNKNOWN")) == 0) {
        return EAI_NONAME;
    }
    return original(host && is_known(host) ? "127.0.0.1" : host, service, hints, found);
}

struct hostent *gethostbyname(const char *host)
{
    gethostbyname_function *original;
    find_original("gethostbyname", &original);
    return original(is_known(host) ? "127.0.0.1" : host);
}

int connect(int fd, const struct sockaddr *address, socklen_t length)
{
    const char *port = setting("IPC_TEST_DEFAULT_PORT");
    struct sockaddr_in tcp;
    struct sockaddr_un local;
    connect_function *original;
    find_original("connect", &original);

    if (*port && address->sa_family == AF_INET) {
        memcpy(&tcp, address, sizeof tcp);
        if (tcp.sin_port == htons(DEFAULT_PORT)) {
            tcp.sin_port = htons((uint16_t)atoi(port));
            return original(fd, (struct sockaddr *)&tcp, sizeof tcp);
        }
    } else if (*port && address->sa_family == AF_UNIX) {
        memset(&local, 0, sizeof local);
        memcpy(&local, address, length < sizeof local ? length : sizeof local);
        if (strcmp(local.sun_path, DEFAULT_PATH) == 0) {
            snprintf(local.sun_path, sizeof local.sun_path, "/tmp/x_ipc/%s", port);
            return original(fd, (struct sockaddr *)&local, sizeof local);
        }
    }
    return original(fd, address, length);
}
