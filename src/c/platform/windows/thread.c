/*
 * Locks, conditions and threads on Windows.
 */
#include "platform/platform.h"

#include <process.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "platform/windows/system.h"

struct mutex {
    SRWLOCK lock;
};

struct condition {
    CONDITION_VARIABLE variable;
};

struct mutex *mutex_new(void)
{
    struct mutex *mutex = mem_new(sizeof *mutex);
    InitializeSRWLock(&mutex->lock);
    return mutex;
}

void mutex_free(struct mutex *mutex)
{
    free(mutex);
}

void mutex_lock(struct mutex *mutex)
{
    AcquireSRWLockExclusive(&mutex->lock);
}

void mutex_unlock(struct mutex *mutex)
{
    ReleaseSRWLockExclusive(&mutex->lock);
}

struct condition *condition_new(void)
{
    struct condition *condition = mem_new(sizeof *condition);
    InitializeConditionVariable(&condition->variable);
    return condition;
}

void condition_free(struct condition *condition)
{
    free(condition);
}

static DWORD milliseconds_until(uint64_t deadline_ns)
{
    const uint64_t now = clock_ns();
    const uint64_t left_ms = now < deadline_ns ? (deadline_ns - now + 999999u) / 1000000u : 0;
    return left_ms < INFINITE ? (DWORD)left_ms : INFINITE - 1;
}

void condition_wait(struct condition *condition, struct mutex *mutex, uint64_t deadline_ns)
{
    const DWORD limit_ms = deadline_ns == UINT64_MAX ? INFINITE : milliseconds_until(deadline_ns);
    (void)SleepConditionVariableSRW(&condition->variable, &mutex->lock, limit_ms, 0);
}

void condition_tell_all(struct condition *condition)
{
    WakeAllConditionVariable(&condition->variable);
}

uintptr_t thread_number(void)
{
    return GetCurrentThreadId();
}

/* What a new thread runs; it frees this. */
struct start {
    void (*run)(void *argument);
    void *argument;
};

static void begin(void *start_pointer)
{
    const struct start start = *(const struct start *)start_pointer;
    free(start_pointer);
    start.run(start.argument);
}

int thread_start(void (*run)(void *argument), void *argument)
{
    struct start *start = mem_new(sizeof *start);
    start->run = run;
    start->argument = argument;
    if (_beginthread(begin, 0, start) == (uintptr_t)-1) {
        free(start);
        return ERR_IO;
    }
    return 0;
}

static BOOL CALLBACK run_once(INIT_ONCE *once, void *initialise, void **context)
{
    void (**const function)(void) = initialise;
    (void)once;
    (void)context;
    (*function)();
    return TRUE;
}

void thread_once(void (*initialise)(void))
{
    static INIT_ONCE once = INIT_ONCE_STATIC_INIT;
    (void)InitOnceExecuteOnce(&once, run_once, &initialise, NULL);
}
