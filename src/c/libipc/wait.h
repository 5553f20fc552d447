/*
 * Waiting.
 *
 * One thread at a time waits in the kernel, for all contexts and for everybody's
 * descriptors; the others wait for it.  Whoever wakes looks at what it was
 * waiting for and, if that has not come, waits again.
 */
#ifndef IPC_LIBIPC_WAIT_H
#define IPC_LIBIPC_WAIT_H

#include "libipc/library.h"

#define NO_DEADLINE UINT64_MAX

/* clock_ns() timeout_ms from now; IPC_WAIT_FOREVER gives NO_DEADLINE. */
uint64_t wait_deadline(unsigned int timeout_ms);

/* Whether the deadline has passed. */
bool wait_is_over(uint64_t deadline_ns);

/* Writes what waits, then waits until something may have changed, or until the deadline.  Returns
 * whether to go on waiting if it has not: false when the program gives up. */
bool wait_turn(struct library *library, uint64_t deadline_ns);

/* Whether the program gives up what this thread waits for.  The lock is given up while it is asked. */
bool wait_is_given_up(struct library *library);

/* Waits so long for nothing, without the lock; false when the program gives up. */
bool wait_pause(int milliseconds);

/* What a wait would be for, for those who wait elsewhere: how many items, in a list that the caller
 * frees. */
size_t wait_list(struct library *library, struct ready_item **items);

/* Looks without waiting whether descriptors of the user are ready. */
void wait_poll_fds(struct library *library);

#endif
