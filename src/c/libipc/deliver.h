/*
 * Running the handlers of instances.
 */
#ifndef IPC_LIBIPC_DELIVER_H
#define IPC_LIBIPC_DELIVER_H

#include "libipc/instance.h"

/* Runs the handlers of an instance that has left the inbox, acknowledges and frees it. */
void deliver(struct instance *instance);

#endif
