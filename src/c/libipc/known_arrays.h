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

enum { MARK_BYTES = 8 };

/* What an array is recognised by.  Programs may release arrays with plain free, and other data may
 * then be at the same address. */
struct array_mark {
    uintptr_t address;
    size_t usable; /* of its malloc block */
    size_t length;
    enum byte_order order;
    uint8_t first[MARK_BYTES];
    uint8_t last[MARK_BYTES];
};

/* Takes the mark of an array of at least one byte that is certainly still there. */
struct array_mark known_arrays_mark(const void *bytes, size_t length, enum byte_order order);

/* Remembers an array by its mark; the array itself may be gone already. */
void known_arrays_add(struct library *library, const struct array_mark *mark);
void known_arrays_remove(struct library *library, const void *bytes);

/* What is known of an array: running callbacks first, then the table; else unknown length, host order. */
struct format_source known_arrays_find(struct library *library, const void *bytes);

#endif
