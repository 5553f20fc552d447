/*
 * Locks and conditions on POSIX systems.
 */
#define _POSIX_C_SOURCE 200809L
#include "platform/platform.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>

#include "base/error.h"
#include "base/memory.h"

struct mutex {
    pthread_mutex_t mutex;
};

struct condition {
    pthread_cond_t condition;
};

struct mutex *mutex_new(void)
{
    struct mutex *mutex = mem_new(sizeof *mutex);
    pthread_mutex_init(&mutex->mutex, NULL);
    return mutex;
}

void mutex_free(struct mutex *mutex)
{
    pthread_mutex_destroy(&mutex->mutex);
    free(mutex);
}

void mutex_lock(struct mutex *mutex)
{
    pthread_mutex_lock(&mutex->mutex);
}

void mutex_unlock(struct mutex *mutex)
{
    pthread_mutex_unlock(&mutex->mutex);
}

struct condition *condition_new(void)
{
    struct condition *condition = mem_new(sizeof *condition);
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
#if !defined(__APPLE__)
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
#endif
    pthread_cond_init(&condition->condition, &attributes);
    pthread_condattr_destroy(&attributes);
    return condition;
}

void condition_free(struct condition *condition)
{
    pthread_cond_destroy(&condition->condition);
    free(condition);
}

void condition_wait(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns)
{
    if (deadline_ns == UINT64_MAX) {
        pthread_cond_wait(&condition->condition, &mutex->mutex);
        return;
    }
    struct timespec until;
#if defined(__APPLE__)
    /* No monotonic condition there: the remaining time is added to the wall clock. */
    const uint64_t now = clock_ns();
    const uint64_t left = deadline_ns > now ? deadline_ns - now : 0;
    clock_gettime(CLOCK_REALTIME, &until);
    const uint64_t nanoseconds = (uint64_t)until.tv_nsec + left % 1000000000u;
    until.tv_sec += (time_t)(left / 1000000000u + nanoseconds / 1000000000u);
    until.tv_nsec = (long)(nanoseconds % 1000000000u);
#else
    until.tv_sec = (time_t)(deadline_ns / 1000000000u);
    until.tv_nsec = (long)(deadline_ns % 1000000000u);
#endif
    pthread_cond_timedwait(&condition->condition, &mutex->mutex, &until);
}

void condition_tell_all(struct condition *condition)
{
    pthread_cond_broadcast(&condition->condition);
}

uintptr_t thread_number(void)
{
    return (uintptr_t)pthread_self();
}

/* What a new thread runs; it frees this. */
struct start {
    void (*run)(void *argument);
    void *argument;
};

static void *begin(void *start_pointer)
{
    const struct start start = *(const struct start *)start_pointer;
    free(start_pointer);
    start.run(start.argument);
    return NULL;
}

int thread_start(void (*run)(void *argument), void *argument)
{
    sigset_t all, before;
    pthread_t thread;
    pthread_attr_t attributes;
    struct start *start = mem_new(sizeof *start);
    start->run = run;
    start->argument = argument;
    sigfillset(&all);
    pthread_attr_init(&attributes);
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_sigmask(SIG_SETMASK, &all, &before); /* the new thread inherits it */
    const int error = pthread_create(&thread, &attributes, begin, start);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    if (error != 0) {
        free(start);
    }
    return error == 0 ? 0 : ERR_IO;
}

void thread_once(void (*initialise)(void))
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, initialise);
}
