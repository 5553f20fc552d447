/*
 * Owners of sockets on Windows.
 */
#include "platform/owner.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "platform/sockets.h"
#include "platform/windows/owner.h"

#include <iphlpapi.h>

int owner_of_peer(int fd)
{
    (void)fd;
    return 0; /* there are no Unix sockets */
}

int owner_peer_port(int fd)
{
    struct sockaddr_storage address;
    socklen_t length = sizeof address;
    if (getpeername(socket_of(fd), (struct sockaddr *)&address, &length) != 0 ||
        address.ss_family != AF_INET) {
        return 0;
    }
    return socket_port_of(&address);
}

/* The connections of the machine over IPv4; the caller frees them.  NULL: they are not told. */
static MIB_TCPTABLE_OWNER_PID *list_connections(bool listening)
{
    enum { TRIES = 5, RESERVE = 4096 }; /* there may be more by the time that they are asked for */
    const TCP_TABLE_CLASS kind =
        listening ? TCP_TABLE_OWNER_PID_LISTENER : TCP_TABLE_OWNER_PID_CONNECTIONS;
    void *connections = NULL;
    DWORD size = RESERVE;
    for (int i = 0; i < TRIES; i++) {
        free(connections);
        connections = malloc(size);
        if (connections == NULL) {
            return NULL;
        }
        const DWORD result = GetExtendedTcpTable(connections, &size, FALSE, AF_INET, kind, 0);
        if (result == NO_ERROR) {
            return connections;
        }
        if (result != ERROR_INSUFFICIENT_BUFFER) {
            break;
        }
        size += RESERVE;
    }
    free(connections);
    return NULL;
}

int owner_of_port(int port, bool listening)
{
    MIB_TCPTABLE_OWNER_PID *connections = list_connections(listening);
    int process = 0;
    for (DWORD i = 0; connections != NULL && i < connections->dwNumEntries && process == 0; i++) {
        const MIB_TCPROW_OWNER_PID *row = &connections->table[i];
        if (ntohs((u_short)row->dwLocalPort) == port &&
            (listening || row->dwState == MIB_TCP_STATE_ESTAB)) {
            process = (int)row->dwOwningPid;
        }
    }
    free(connections);
    return process;
}

/* Whether the process listens to such requests, as central does. */
static bool ask_to_end(int process)
{
    char name[OWNER_END_EVENT_SIZE];
    (void)snprintf(name, sizeof name, OWNER_END_EVENT, (unsigned long)process);
    const HANDLE event = OpenEventA(EVENT_MODIFY_STATE, FALSE, name);
    const bool asked = event != NULL && SetEvent(event) != 0;
    if (event != NULL) {
        (void)CloseHandle(event);
    }
    return asked;
}

int owner_end(int process)
{
    if (process <= 0) {
        return ERR_UNKNOWN;
    }
    if (ask_to_end(process)) {
        return 0;
    }
    const HANDLE handle = OpenProcess(PROCESS_TERMINATE, FALSE, (DWORD)process);
    if (handle == NULL) {
        return GetLastError() == ERROR_ACCESS_DENIED ? ERR_REFUSED : ERR_UNKNOWN;
    }
    const bool ended = TerminateProcess(handle, 1) != 0;
    (void)CloseHandle(handle);
    return ended ? 0 : ERR_REFUSED;
}
