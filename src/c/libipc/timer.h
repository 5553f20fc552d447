/*
 * Timers: functions that listening calls run when their time has come.
 */
#ifndef IPC_LIBIPC_TIMER_H
#define IPC_LIBIPC_TIMER_H

#include "libipc/library.h"

/* Adds or, without want_reference, replaces the timer of the same handler.  Returns its reference. */
TIMER_REF timer_add(struct library *library, uint64_t delay_ms, long count,
                    TIMER_HANDLER_TYPE handler, void *client_data, bool want_reference);

/* Removes the oldest timer with that handler; false: there is none. */
bool timer_remove(struct library *library, TIMER_HANDLER_TYPE handler);
bool timer_remove_reference(struct library *library, TIMER_REF reference);

/* Calls that are left, -1 for ever, 0 for an unknown timer. */
long timer_count(const struct library *library, TIMER_REF reference);

/* Runs all timers that are due and whose turn is free, in the order in which they were added. */
void timer_run_due(struct library *library);

/* Removes all of them. */
void timer_clear(struct library *library);

/* Milliseconds as timer handlers see them. */
unsigned long timer_milliseconds(uint64_t ns);

#endif
