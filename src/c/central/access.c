/*
 * Access control: who may be a module.
 */
#include "central/access.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "platform/rules.h"

#define SERVICE_NAME "central"

enum { SUPERUSER = 0 };

/* A connection whose name is being looked up. */
struct newcomer {
    struct list in_waiting;
    int fd;
    uint64_t deadline_ns;
    struct look_up *look_up; /* NULL: as many as may are under way */
    char address[NET_NAME_SIZE];
};

void access_init(struct access *access, struct server *server, const struct waker *waker)
{
    memset(access, 0, sizeof *access);
    access->server = server;
    access->waker = waker;
    list_init(&access->waiting);
}

static enum access_answer refuse(struct access *access, int fd, const char *who)
{
    access->server->statistics.n_refused++;
    log_always(&access->server->log, "WARNING: connection rejected from %s\n", who);
    net_close(fd);
    return ACCESS_REFUSED;
}

/* ---------------------------------------------------------------- Unix sockets */

static bool may_connect(const struct options *options, int fd, int64_t user)
{
    return options->users == USERS_ALL || user == SUPERUSER || user == process_user() ||
           (options->users == USERS_GROUP && process_peer_is_in_group(fd, options->group));
}

static enum access_answer ask_about_user(struct access *access, int fd)
{
    char who[40];
    int64_t user;
    if (access->server->options->users == USERS_ALL) {
        return ACCESS_GRANTED;
    }
    if (process_peer_user(fd, &user) != 0) {
        return refuse(access, fd, "an unknown user");
    }
    (void)snprintf(who, sizeof who, "user %" PRId64, user);
    return may_connect(access->server->options, fd, user) ? ACCESS_GRANTED
                                                          : refuse(access, fd, who);
}

/* ------------------------------------------------------------------------- TCP */

/* name NULL: not looked up yet. */
static enum rules_answer ask_rules(const struct access *access, int fd, const char *address,
                                   const char *name)
{
    const struct options *options = access->server->options;
    char own_address[NET_NAME_SIZE];
    net_own_address(fd, own_address, sizeof own_address);
    const struct rules_question question = {
        SERVICE_NAME, options->allow_file, options->deny_file, address, name, own_address};
    return rules_ask(&question);
}

/* Decides by a name, "" for none. */
static enum access_answer decide(struct access *access, int fd, const char *address,
                                 const char *name)
{
    if (ask_rules(access, fd, address, name) == RULES_ALLOW) {
        return ACCESS_GRANTED;
    }
    return refuse(access, fd, name[0] != '\0' ? name : address);
}

static void begin_look_up(struct access *access, struct newcomer *newcomer)
{
    if (access->resolver == NULL) {
        access->resolver = resolver_new(access->waker);
    }
    newcomer->look_up = resolver_ask(access->resolver, newcomer->address);
}

static enum access_answer wait_for_name(struct access *access, int fd, const char *address)
{
    struct newcomer *newcomer = mem_new(sizeof *newcomer);
    newcomer->fd = fd;
    newcomer->deadline_ns = access->server->now_ns + access->server->options->limits.look_up_ns;
    memcpy(newcomer->address, address, strlen(address) + 1);
    begin_look_up(access, newcomer);
    list_append(&access->waiting, &newcomer->in_waiting);
    access->n_waiting++;
    return ACCESS_LATER;
}

static enum access_answer ask_about_address(struct access *access, int fd)
{
    char address[NET_NAME_SIZE];
    if (!rules_are_known()) {
        return ACCESS_GRANTED;
    }
    net_peer_address(fd, address, sizeof address);
    if (address[0] == '\0') {
        return refuse(access, fd, "unknown"); /* it has gone, but what it has sent could be read */
    }
    switch (ask_rules(access, fd, address, NULL)) {
    case RULES_ALLOW:
        return ACCESS_GRANTED;
    case RULES_REFUSE:
        return refuse(access, fd, address);
    default:
        break;
    }
    if (access->n_waiting >= access->server->options->limits.unintroduced) {
        return decide(access, fd, address, ""); /* as if the look-up had taken too long */
    }
    return wait_for_name(access, fd, address);
}

enum access_answer access_ask(struct access *access, int fd, bool local)
{
    return local ? ask_about_user(access, fd) : ask_about_address(access, fd);
}

/* --------------------------------------------------------------- those that wait */

static void remove_newcomer(struct access *access, struct newcomer *newcomer)
{
    if (newcomer->look_up != NULL) {
        look_up_forget(newcomer->look_up);
    }
    list_remove(&newcomer->in_waiting);
    access->n_waiting--;
    free(newcomer);
}

/* Whether its time has come: the name is known, or patience is over. */
static bool is_due(struct access *access, struct newcomer *newcomer)
{
    if (newcomer->look_up == NULL) {
        begin_look_up(access, newcomer);
    }
    return access->server->now_ns >= newcomer->deadline_ns ||
           (newcomer->look_up != NULL && look_up_is_done(newcomer->look_up));
}

bool access_has_news(const struct access *access)
{
    return !list_is_empty(&access->waiting) &&
           (access_deadline_ns(access) <= access->server->now_ns ||
            resolver_n_done(access->resolver) != access->n_looked_up);
}

int access_next(struct access *access)
{
    struct list *at, *following;
    if (list_is_empty(&access->waiting)) {
        return -1;
    }
    const uint64_t n_looked_up = resolver_n_done(access->resolver);
    LIST_EACH (at, following, &access->waiting) {
        struct newcomer *newcomer = LIST_OWNER(at, struct newcomer, in_waiting);
        if (!is_due(access, newcomer)) {
            continue;
        }
        const int fd = newcomer->fd;
        const bool known = newcomer->look_up != NULL && look_up_is_done(newcomer->look_up);
        const enum access_answer answer =
            decide(access, fd, newcomer->address, known ? look_up_name(newcomer->look_up) : "");
        remove_newcomer(access, newcomer);
        if (answer == ACCESS_GRANTED) {
            return fd;
        }
    }
    access->n_looked_up = n_looked_up;
    return -1;
}

uint64_t access_deadline_ns(const struct access *access)
{
    return list_is_empty(&access->waiting)
               ? UINT64_MAX
               : LIST_OWNER(access->waiting.next, struct newcomer, in_waiting)->deadline_ns;
}

void access_fini(struct access *access)
{
    struct list *at, *following;
    LIST_EACH (at, following, &access->waiting) {
        struct newcomer *newcomer = LIST_OWNER(at, struct newcomer, in_waiting);
        net_close(newcomer->fd);
        remove_newcomer(access, newcomer);
    }
    resolver_free(access->resolver);
}
