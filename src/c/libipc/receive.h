/*
 * What comes from central: frames become answers, instances in the inbox, or
 * news for the library itself.  No user code runs here.
 */
#ifndef IPC_LIBIPC_RECEIVE_H
#define IPC_LIBIPC_RECEIVE_H

#include "libipc/context.h"

struct peer;

/* From now on whoever waits writes and reads what there is over the context's connection. */
void receive_start(struct _X_IPC_CONTEXT *context);

/* Reads what central has sent and takes in all complete frames; returns whether anything came. */
bool receive(struct _X_IPC_CONTEXT *context);

/* The same for another module.  A peer that breaks the protocol or goes loses its link only. */
bool receive_from_peer(struct peer *peer);

#endif
