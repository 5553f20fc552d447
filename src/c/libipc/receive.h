/*
 * What comes from central: frames become answers, instances in the inbox, or
 * news for the library itself.  No user code runs here.
 */
#ifndef IPC_LIBIPC_RECEIVE_H
#define IPC_LIBIPC_RECEIVE_H

#include "libipc/context.h"

/* Reads what is there and takes in all complete frames; returns whether anything came. */
bool receive(struct _X_IPC_CONTEXT *context);

/* Takes in the complete frames that have been read already. */
void receive_frames(struct _X_IPC_CONTEXT *context);

#endif
