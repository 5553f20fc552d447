/*
 * Users, groups and who is at the other end of a Unix socket, on POSIX systems.
 */
#define _GNU_SOURCE /* struct ucred */
#include "platform/process.h"

#include <errno.h>
#include <grp.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

int64_t process_user(void)
{
    return geteuid();
}

int process_find_group(const char *name, int64_t *group)
{
    char *end;
    const struct group *found = getgrnam(name);
    if (found != NULL) {
        *group = found->gr_gid;
        return 0;
    }
    *group = strtol(name, &end, 10);
    return name[0] >= '0' && name[0] <= '9' && *end == '\0' ? 0 : ERR_UNKNOWN;
}

#if defined(SO_PEERCRED)

int process_peer_user(int fd, int64_t *user)
{
    struct ucred peer = {0, 0, 0};
    socklen_t length = sizeof peer;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0) {
        return ERR_UNKNOWN;
    }
    *user = peer.uid;
    return 0;
}

static bool has_main_group(int fd, int64_t group)
{
    struct ucred peer = {0, 0, 0};
    socklen_t length = sizeof peer;
    return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 && peer.gid == group;
}

#else

int process_peer_user(int fd, int64_t *user)
{
    uid_t uid;
    gid_t gid;
    if (getpeereid(fd, &uid, &gid) != 0) {
        return ERR_UNKNOWN;
    }
    *user = uid;
    return 0;
}

static bool has_main_group(int fd, int64_t group)
{
    uid_t uid;
    gid_t gid;
    return getpeereid(fd, &uid, &gid) == 0 && gid == group;
}

#endif

#if defined(SO_PEERGROUPS)

static bool has_group(int fd, int64_t group)
{
    socklen_t length = 0;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, NULL, &length) == 0 || errno != ERANGE) {
        return false; /* it has none, or they are not told */
    }
    gid_t *groups = mem_new(length);
    bool found = false;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups, &length) == 0) {
        for (size_t i = 0; i < length / sizeof *groups && !found; i++) {
            found = groups[i] == group;
        }
    }
    free(groups);
    return found;
}

#else

static bool has_group(int fd, int64_t group)
{
    (void)fd;
    (void)group;
    return false; /* only the main group is told here */
}

#endif

bool process_peer_is_in_group(int fd, int64_t group)
{
    return has_main_group(fd, group) || has_group(fd, group);
}
