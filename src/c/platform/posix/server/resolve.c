/*
 * Names of addresses on POSIX systems.
 *
 * A look-up is shared by the thread that carries it out and by who asked for it;
 * who lets go last frees it.  The same holds for the resolver, which counts one
 * reference for itself and one for each thread.
 */
#define _POSIX_C_SOURCE 200809L
#include "platform/resolve.h"

#include <netdb.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "base/memory.h"

enum { MAX_THREADS = 16, ADDRESS_SIZE = 64 };

struct resolver {
    pthread_mutex_t lock;      /* of everything here and of the states of all look-ups */
    const struct waker *waker; /* NULL: nobody wants to be woken */
    int n_threads;
    uint64_t n_done;
    int references;
};

struct look_up {
    struct resolver *resolver; /* a reference is the thread's */
    bool done;
    bool forgotten;
    char address[ADDRESS_SIZE];
    char name[NET_NAME_SIZE];
};

struct resolver *resolver_new(const struct waker *waker)
{
    struct resolver *resolver = mem_new(sizeof *resolver);
    pthread_mutex_init(&resolver->lock, NULL);
    resolver->waker = waker;
    resolver->references = 1;
    return resolver;
}

/* Gives a reference back, and the lock. */
static void let_go(struct resolver *resolver)
{
    const bool last = --resolver->references == 0;
    pthread_mutex_unlock(&resolver->lock);
    if (last) {
        pthread_mutex_destroy(&resolver->lock);
        free(resolver);
    }
}

void resolver_free(struct resolver *resolver)
{
    if (resolver != NULL) {
        pthread_mutex_lock(&resolver->lock);
        resolver->waker = NULL;
        let_go(resolver);
    }
}

/* ---------------------------------------------------------------- in the thread */

static struct addrinfo *resolve(const char *text, int flags)
{
    struct addrinfo hints;
    struct addrinfo *found = NULL;
    memset(&hints, 0, sizeof hints);
    hints.ai_flags = flags;
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    return getaddrinfo(text, NULL, &hints, &found) == 0 ? found : NULL;
}

/* Whether the name leads to the address, and is not just another number. */
static bool leads_back(const char *name, const struct addrinfo *address)
{
    struct addrinfo *number = resolve(name, AI_NUMERICHOST);
    if (number != NULL) {
        freeaddrinfo(number);
        return false;
    }
    struct addrinfo *found = resolve(name, 0);
    bool same = false;
    for (const struct addrinfo *at = found; at != NULL && !same; at = at->ai_next) {
        same = at->ai_addrlen == address->ai_addrlen &&
               memcmp(at->ai_addr, address->ai_addr, at->ai_addrlen) == 0;
    }
    if (found != NULL) {
        freeaddrinfo(found);
    }
    return same;
}

static void find_name(struct look_up *look_up)
{
    char name[NET_NAME_SIZE];
    struct addrinfo *address = resolve(look_up->address, AI_NUMERICHOST);
    if (address == NULL) {
        return;
    }
    if (getnameinfo(address->ai_addr, address->ai_addrlen, name, sizeof name, NULL, 0,
                    NI_NAMEREQD) == 0 &&
        leads_back(name, address)) {
        memcpy(look_up->name, name, strlen(name) + 1);
    }
    freeaddrinfo(address);
}

static void *carry_out(void *argument)
{
    struct look_up *look_up = argument;
    struct resolver *resolver = look_up->resolver;
    find_name(look_up);
    pthread_mutex_lock(&resolver->lock);
    look_up->done = true;
    const bool forgotten = look_up->forgotten;
    resolver->n_threads--;
    resolver->n_done++;
    if (resolver->waker != NULL) {
        waker_wake(
            resolver->waker); /* even if this one is forgotten: another may wait for its turn */
    }
    let_go(resolver);
    if (forgotten) {
        free(look_up);
    }
    return NULL;
}

/* --------------------------------------------------------------- of who asks */

/* Signals stay with the threads that were there before. */
static int start_thread(struct look_up *look_up)
{
    sigset_t all, before;
    pthread_attr_t attributes;
    pthread_t thread;
    sigfillset(&all);
    pthread_attr_init(&attributes);
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(&thread, &attributes, carry_out, look_up);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return error;
}

struct look_up *resolver_ask(struct resolver *resolver, const char *address)
{
    struct look_up *look_up = NULL;
    pthread_mutex_lock(&resolver->lock);
    if (resolver->n_threads < MAX_THREADS && strlen(address) < ADDRESS_SIZE) {
        look_up = mem_new(sizeof *look_up);
        look_up->resolver = resolver;
        memcpy(look_up->address, address, strlen(address) + 1);
        if (start_thread(look_up) == 0) {
            resolver->n_threads++;
            resolver->references++;
        } else {
            free(look_up);
            look_up = NULL;
        }
    }
    pthread_mutex_unlock(&resolver->lock);
    return look_up;
}

uint64_t resolver_n_done(struct resolver *resolver)
{
    pthread_mutex_lock(&resolver->lock);
    const uint64_t n_done = resolver->n_done;
    pthread_mutex_unlock(&resolver->lock);
    return n_done;
}

bool look_up_is_done(struct look_up *look_up)
{
    pthread_mutex_lock(&look_up->resolver->lock);
    const bool done = look_up->done;
    pthread_mutex_unlock(&look_up->resolver->lock);
    return done;
}

const char *look_up_name(const struct look_up *look_up)
{
    return look_up->name;
}

void look_up_forget(struct look_up *look_up)
{
    struct resolver *resolver = look_up->resolver;
    pthread_mutex_lock(&resolver->lock);
    const bool done = look_up->done;
    look_up->forgotten = true;
    pthread_mutex_unlock(&resolver->lock);
    if (done) {
        free(look_up); /* the thread has let go of it */
    }
}
