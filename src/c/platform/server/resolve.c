/*
 * Names of addresses, each looked up in a thread of its own, on any system.
 *
 * A look-up is shared by the thread that carries it out and by who asked for it;
 * who lets go last frees it.  The same holds for the resolver, which counts one
 * reference for itself and one for each thread.
 */
#include "platform/resolve.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { MAX_THREADS = 16, ADDRESS_SIZE = 64 };

struct resolver {
    struct mutex *lock;        /* of everything here and of the states of all look-ups */
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
    resolver->lock = mutex_new();
    resolver->waker = waker;
    resolver->references = 1;
    return resolver;
}

/* Gives a reference back, and the lock. */
static void let_go(struct resolver *resolver)
{
    const bool last = --resolver->references == 0;
    mutex_unlock(resolver->lock);
    if (last) {
        mutex_free(resolver->lock);
        free(resolver);
    }
}

void resolver_free(struct resolver *resolver)
{
    if (resolver != NULL) {
        mutex_lock(resolver->lock);
        resolver->waker = NULL;
        let_go(resolver);
    }
}

/* ---------------------------------------------------------------- in the thread */

static void carry_out(void *argument)
{
    struct look_up *look_up = argument;
    struct resolver *resolver = look_up->resolver;
    net_find_name(look_up->address, look_up->name);
    mutex_lock(resolver->lock);
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
}

/* --------------------------------------------------------------- of who asks */

struct look_up *resolver_ask(struct resolver *resolver, const char *address)
{
    struct look_up *look_up = NULL;
    mutex_lock(resolver->lock);
    if (resolver->n_threads < MAX_THREADS && strlen(address) < ADDRESS_SIZE) {
        look_up = mem_new(sizeof *look_up);
        look_up->resolver = resolver;
        memcpy(look_up->address, address, strlen(address) + 1);
        if (thread_start(carry_out, look_up) == 0) {
            resolver->n_threads++;
            resolver->references++;
        } else {
            free(look_up);
            look_up = NULL;
        }
    }
    mutex_unlock(resolver->lock);
    return look_up;
}

uint64_t resolver_n_done(struct resolver *resolver)
{
    mutex_lock(resolver->lock);
    const uint64_t n_done = resolver->n_done;
    mutex_unlock(resolver->lock);
    return n_done;
}

bool look_up_is_done(struct look_up *look_up)
{
    mutex_lock(look_up->resolver->lock);
    const bool done = look_up->done;
    mutex_unlock(look_up->resolver->lock);
    return done;
}

const char *look_up_name(const struct look_up *look_up)
{
    return look_up->name;
}

void look_up_forget(struct look_up *look_up)
{
    struct resolver *resolver = look_up->resolver;
    mutex_lock(resolver->lock);
    const bool done = look_up->done;
    look_up->forgotten = true;
    mutex_unlock(resolver->lock);
    if (done) {
        free(look_up); /* the thread has let go of it */
    }
}
