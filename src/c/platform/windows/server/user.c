/*
 * Users and groups, of which Windows has others than central's options speak of: none has a name,
 * and of no peer it is known whose it is.
 */
#include "platform/process.h"

#include <stdlib.h>

#include "base/error.h"

int64_t process_user(void)
{
    return 0;
}

int process_find_group(const char *name, int64_t *group)
{
    char *end;
    *group = strtol(name, &end, 10);
    return name[0] >= '0' && name[0] <= '9' && *end == '\0' ? 0 : ERR_UNKNOWN;
}

int process_peer_user(int fd, int64_t *user)
{
    (void)fd;
    (void)user;
    return ERR_UNKNOWN;
}

bool process_peer_is_in_group(int fd, int64_t group)
{
    (void)fd;
    (void)group;
    return false;
}
