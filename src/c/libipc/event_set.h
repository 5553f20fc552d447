/*
 * What a program with an event loop of its own waits for.
 *
 * On request the library keeps one set of all its descriptors in the kernel, which
 * is itself a descriptor.  A message that has been taken in and not handled makes it
 * readable through the waker.
 */
#ifndef IPC_LIBIPC_EVENT_SET_H
#define IPC_LIBIPC_EVENT_SET_H

#include "libipc/library.h"

/* The set's descriptor, made at the first call; -1: none. */
int event_set_descriptor(struct library *library);

/* Brings the set up to date, if there is one, after anything has changed. */
void event_set_update(struct library *library);

/* Makes the set readable if a message waits. */
void event_set_tell(struct library *library);

/* Whether a message waits to be handled that has been taken in already. */
bool event_set_is_waiting(const struct library *library);

#endif
