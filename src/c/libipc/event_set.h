/*
 * What a program with an event loop of its own waits for.
 *
 * On request the library keeps one set of all its descriptors in the kernel, which
 * is itself a descriptor.  A message that has been taken in and not handled makes it
 * readable through the waker (inbox_tell).
 */
#ifndef IPC_LIBIPC_EVENT_SET_H
#define IPC_LIBIPC_EVENT_SET_H

#include "libipc/source.h"

/* The set's descriptor, made at the first call; -1: none. */
int event_set_descriptor(struct library *library);

/* Brings the set up to date, if there is one, after anything has changed. */
void event_set_update(struct library *library);

/* What belongs into the set: a list that the caller ends with source_list_fini. */
void event_set_list(struct library *library, struct source_list *list);

#endif
