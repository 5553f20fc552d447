/*
 * How one process of this project asks another to end, on Windows.
 */
#ifndef IPC_PLATFORM_WINDOWS_OWNER_H
#define IPC_PLATFORM_WINDOWS_OWNER_H

/* The name of the event by which a process that ends in good order is asked to. */
#define OWNER_END_EVENT "Local\\ipc-end-%lu"
enum { OWNER_END_EVENT_SIZE = 40 };

#endif
