/*
 * The opening: everything by which others reach the server, in order.
 *
 * Sockets that a supervisor hands over, else those that the options ask for; the
 * socket of the numbers; the files that say where the server is.  What cannot be
 * had is said on standard error, and in the logs that there are.
 */
#ifndef IPC_CENTRAL_OPENING_H
#define IPC_CENTRAL_OPENING_H

#include "central/loop.h"

/* 0, or ERR_IO: the server cannot start. */
int opening_open(struct loop *loop);

#endif
