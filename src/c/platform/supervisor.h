/*
 * The program that has started this one and looks after it, such as systemd.
 *
 * Both talk by environment variables and datagrams: sockets that listen already
 * are handed over (LISTEN_PID, LISTEN_FDS, LISTEN_FDNAMES), states are told
 * (NOTIFY_SOCKET), and a sign of life may be wanted now and then (WATCHDOG_PID,
 * WATCHDOG_USEC).  Without a supervisor none of this does anything.
 */
#ifndef IPC_PLATFORM_SUPERVISOR_H
#define IPC_PLATFORM_SUPERVISOR_H

#include <stddef.h>
#include <stdint.h>

/* How many descriptors were handed over; *first is the lowest of them, the others follow. */
size_t supervisor_sockets(int *first);

/* The name that descriptor number i of these was given, "" if none; cut to size - 1 bytes. */
void supervisor_socket_name(size_t i, char *name, size_t size);

/* Tells assignments, one a line, such as "READY=1\nSTATUS=ready".  Never waits. */
void supervisor_tell(const char *text);

/* How often a sign of life ("WATCHDOG=1") is wanted at least; 0: never. */
uint64_t supervisor_watchdog_ns(void);

#endif
