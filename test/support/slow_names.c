/*
 * Preloaded into a program: names of addresses as a test wants them.
 *
 * Looking up the name of any address waits until the file SLOW_NAMES_GO is there,
 * and then finds SLOW_NAMES_NAME.  That name leads to the address SLOW_NAMES_ADDRESS.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef int (*name_function)(const struct sockaddr *, socklen_t, char *, socklen_t, char *,
                             socklen_t, int);
typedef int (*address_function)(const char *, const char *, const struct addrinfo *,
                                struct addrinfo **);

int getnameinfo(const struct sockaddr *address, socklen_t length, char *host, socklen_t host_room,
                char *service, socklen_t service_room, int flags)
{
    if (flags & NI_NUMERICHOST) {
        void *real = dlsym(RTLD_NEXT, "getnameinfo");
        name_function function;
        memcpy(&function, &real, sizeof function);
        return function(address, length, host, host_room, service, service_room, flags);
    }
    while (access(getenv("SLOW_NAMES_GO"), F_OK) != 0) {
        usleep(2000);
    }
    snprintf(host, host_room, "%s", getenv("SLOW_NAMES_NAME"));
    return 0;
}

int getaddrinfo(const char *node, const char *service, const struct addrinfo *hints,
                struct addrinfo **found)
{
    void *real = dlsym(RTLD_NEXT, "getaddrinfo");
    address_function function;
    memcpy(&function, &real, sizeof function);
    const int is_ours = node != NULL && strcmp(node, getenv("SLOW_NAMES_NAME")) == 0;
    if (is_ours && hints->ai_flags & AI_NUMERICHOST) {
        return EAI_NONAME;
    }
    return function(is_ours ? getenv("SLOW_NAMES_ADDRESS") : node, service, hints, found);
}
