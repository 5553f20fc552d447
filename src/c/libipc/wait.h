/*
 * Waiting.
 *
 * One thread at a time waits in the kernel, for all sources; the others wait for
 * it.  Whoever wakes looks at what it was waiting for and, if that has not come,
 * waits again.
 */
#ifndef IPC_LIBIPC_WAIT_H
#define IPC_LIBIPC_WAIT_H

#include "libipc/source.h"

/* clock_ns() timeout_ms from now; IPC_WAIT_FOREVER gives NO_DEADLINE. */
uint64_t wait_deadline(unsigned int timeout_ms);

/* Whether the deadline has passed. */
bool wait_is_over(uint64_t deadline_ns);

/* Every wait is for this source too, from now on. */
void wait_add(struct library *library, struct source *source);

/* No wait is for this source any more, and nothing refers to it; harmless if none was. */
void wait_remove(struct library *library, struct source *source);

/* Threads that wait, in the kernel or in turn, look again. */
void wait_wake(struct library *library);

/* What is to be waited for has changed: they look again, and so do other event loops. */
void wait_changed(struct library *library);

/* Writes what waits, then waits until something may have changed, or until the deadline.  Returns
 * whether to go on waiting if it has not: false when the program gives up. */
bool wait_turn(struct library *library, uint64_t deadline_ns);

/* Whether the program gives up what this thread waits for.  The lock is given up while it is asked. */
bool wait_is_given_up(struct library *library);

/* Waits so long for nothing, without the lock; false when the program gives up. */
bool wait_pause(int milliseconds);

/* When a source has something to do though nothing has arrived; NO_DEADLINE: never. */
uint64_t wait_due(const struct library *library);

#endif
