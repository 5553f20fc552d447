/*
 * Releasing what a failed decoding has allocated.
 */
#ifndef IPC_FORMAT_RELEASE_H
#define IPC_FORMAT_RELEASE_H

#include "format/counts.h"
#include "format/format.h"
#include "format/walk.h"

/*
 * Frees what a partly decoded value points to.  Its dimensions may be missing or
 * wrong, so the numbers of elements of its arrays with elements that hold
 * pointers come from arrays, in the order of decoding.  stack is the decoder's,
 * which has been as deep as this will go.
 */
void release_partial(const struct format *format, void *value, const struct counts *arrays,
                     struct frame_stack *stack);

#endif
