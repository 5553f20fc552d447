/*
 * Owners of sockets on POSIX systems; most of it only where there is a Linux /proc.
 */
#define _GNU_SOURCE /* struct ucred */
#include "platform/owner.h"

#include <dirent.h>
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/error.h"

int owner_of_peer(int fd)
{
#ifdef SO_PEERCRED
    struct ucred peer = {0, 0, 0};
    socklen_t length = sizeof peer;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0) {
        return (int)peer.pid;
    }
#else
    (void)fd;
#endif
    return 0;
}

int owner_peer_port(int fd)
{
    struct sockaddr_storage address;
    socklen_t length = sizeof address;
    if (getpeername(fd, (struct sockaddr *)&address, &length) != 0) {
        return 0;
    }
    return address.ss_family == AF_INET
               ? ntohs(((const struct sockaddr_in *)(const void *)&address)->sin_port)
               : 0;
}

/* The number of the socket on that port in the kernel's table, 0: none. */
static unsigned long socket_number(int port, bool listening)
{
    enum { STATE_CONNECTED = 1, STATE_LISTENING = 10 };
    char line[512];
    unsigned long number = 0;
    FILE *table = fopen("/proc/net/tcp", "r");
    while (table != NULL && number == 0 && fgets(line, sizeof line, table) != NULL) {
        unsigned local_port;
        unsigned state;
        unsigned long inode;
        if (sscanf(line, " %*d: %*x:%x %*x:%*x %x %*s %*s %*s %*s %*s %lu", &local_port, &state,
                   &inode) == 3 &&
            (int)local_port == port && state == (listening ? STATE_LISTENING : STATE_CONNECTED)) {
            number = inode;
        }
    }
    if (table != NULL) {
        fclose(table);
    }
    return number;
}

/* Whether a process has a descriptor that leads to what the text says. */
static bool has_open(const char *process, const char *text)
{
    char directory[300];
    snprintf(directory, sizeof directory, "/proc/%s/fd", process);
    DIR *descriptors = opendir(directory);
    bool found = false;
    const struct dirent *entry;
    while (descriptors != NULL && !found && (entry = readdir(descriptors)) != NULL) {
        char path[600];
        char target[64];
        snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
        const ssize_t length = readlink(path, target, sizeof target - 1);
        if (length > 0) {
            target[length] = '\0';
            found = strcmp(target, text) == 0;
        }
    }
    if (descriptors != NULL) {
        closedir(descriptors);
    }
    return found;
}

int owner_of_port(int port, bool listening)
{
    char text[64];
    const unsigned long number = socket_number(port, listening);
    snprintf(text, sizeof text, "socket:[%lu]", number);
    DIR *processes = number != 0 ? opendir("/proc") : NULL;
    int process = 0;
    const struct dirent *entry;
    while (processes != NULL && process == 0 && (entry = readdir(processes)) != NULL) {
        if (entry->d_name[0] >= '1' && entry->d_name[0] <= '9' && has_open(entry->d_name, text)) {
            process = atoi(entry->d_name);
        }
    }
    if (processes != NULL) {
        closedir(processes);
    }
    return process;
}

int owner_end(int process)
{
    if (process <= 0) {
        return ERR_UNKNOWN;
    }
    if (kill((pid_t)process, SIGTERM) == 0) {
        return 0;
    }
    return errno == EPERM ? ERR_REFUSED : ERR_UNKNOWN;
}
