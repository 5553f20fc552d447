/*
 * The lengths and byte orders of byte arrays that were handed out.
 *
 * IPC_unmarshall is given an address only.  For arrays that the library made, this
 * table tells how far it may read and in which order, until the array is
 * released through the library.  The table is bounded; the oldest entries go.
 */
#ifndef IPC_LIBIPC_KNOWN_ARRAYS_H
#define IPC_LIBIPC_KNOWN_ARRAYS_H

#include "libipc/library.h"

void known_arrays_add(struct library *library, const void *bytes, size_t length,
                      enum byte_order order);
void known_arrays_remove(struct library *library, const void *bytes);

/* What is known of an array: running callbacks first, then the table; else unknown length, host order. */
struct format_source known_arrays_find(struct library *library, const void *bytes);

#endif
