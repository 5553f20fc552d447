/*
 * Connecting to central for the first time.
 */
#ifndef IPC_LIBIPC_CONNECT_H
#define IPC_LIBIPC_CONNECT_H

#include "libipc/context.h"

/* Connects as a module of that name; server NULL or empty: CENTRALHOST, or this host.  Called
 * without the lock, since it waits; returns the result of the API call. */
IPC_RETURN_TYPE connect_module(const char *module, const char *server, bool will_listen);

/* The same, once; IPC_Timeout when nobody listens there. */
IPC_RETURN_TYPE connect_if_there(const char *module, const char *server);

#endif
