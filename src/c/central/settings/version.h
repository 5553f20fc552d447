/*
 * What the server says about itself.
 *
 * The numbers come from the build; the texts keep the shape that log viewers
 * look for.
 */
#ifndef IPC_CENTRAL_VERSION_H
#define IPC_CENTRAL_VERSION_H

#define SERVER_TITLE "Task Control Server " IPC_VERSION
#define SERVER_BANNER SERVER_TITLE " (" IPC_RELEASE_DATE ")"

/* The name under which the server appears as a party in the log. */
#define SERVER_NAME "X_IPC Server"

/* Version of the protocol.  Modules refuse another major number than 3; 3.9 was the last version of
 * CMU IPC, and no module of it looks at the minor number. */
enum { PROTOCOL_MAJOR = 3, PROTOCOL_MINOR = 10 };

#endif
