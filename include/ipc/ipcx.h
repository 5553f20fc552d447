/*
 * Additions to the API of the manual: for programs with an event loop of their
 * own, for byte arrays from elsewhere, and for those who tell "" from NULL.
 *
 * What ipc.h says of results, threads and ownership holds here as well.
 */
#ifndef _IPCX_H
#define _IPCX_H

#include <ipc/ipc.h>

#if defined(__cplusplus)
extern "C" {
#endif

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(default)
#endif

/* ------------------------------------------------------------- event loops */

/*
 * A program with an event loop of its own waits there, not in a listening call:
 * for IPCx_fd() to be readable, and for IPCx_nextTimeout() milliseconds; then it
 * calls IPCx_process().  Systems without such a descriptor (IPCx_fd() is -1)
 * wait for all of IPCx_descriptors().
 */

/*
 * One descriptor that is readable when IPCx_process() has something to do, timers
 * aside.  It stands for all contexts and for the descriptors of IPC_subscribeFD, and
 * stays the same whatever is connected or subscribed.  It is the library's: wait for
 * it, and do nothing else with it.
 * Returns -1 where the system has no such thing.
 */
int IPCx_fd(void);

#define IPCX_READ 1
#define IPCX_WRITE 2

typedef struct {
    int fd;
    int events; /* IPCX_READ, IPCX_WRITE, or both */
} IPCX_DESCRIPTOR;

/*
 * The descriptors to wait for now, and the events of each: at most room of them are
 * written to list.  They change with every call of the library.
 * Returns how many there are, which may be more than room.
 */
int IPCx_descriptors(IPCX_DESCRIPTOR *list, int room);

/*
 * Milliseconds until IPCx_process() has something to do without any descriptor being
 * ready: 0 when it has now, -1 for ever.
 */
long IPCx_nextTimeout(void);

/*
 * Does everything that can be done now, without waiting: due timers, ready
 * descriptors, messages.  A listening call: handlers run in it.
 * Returns IPC_OK when something was handled, IPC_Timeout when there was nothing,
 * IPC_Error as IPC_listen.
 */
IPC_RETURN_TYPE IPCx_process(void);

/*
 * Lets a program end calls that wait, as interpreters have to for Ctrl-C and for handlers that
 * failed.  giveUp is asked by the thread that waits: after each wait, when a signal was caught, every
 * 200 milliseconds, and after handlers ran if the call is to go on.  It may do all that a handler may.
 * When it returns anything but 0 the call ends: listening calls, queries and IPCx_process as if
 * their time were over, others with an error unless their work is done; what was to be sent is.
 * NULL: nobody is asked.
 */
void IPCx_setGiveUp(int (*giveUp)(void));

/* -------------------------------------------------------------------- data */

/*
 * What the library knows of the bytes of a message: their number, and whether their numbers
 * have the most significant byte first, as the sender's host has it.
 *   byteArray  given to a handler that runs, or kept by one, or the response to a query
 * Returns IPC_OK, or IPC_Error with IPC_Null_Argument, or IPC_Argument_Out_Of_Range (bytes from
 * elsewhere).
 */
IPC_RETURN_TYPE IPCx_arrayInfo(BYTE_ARRAY byteArray, unsigned int *length, int *isBigEndian);

/*
 * As IPC_unmarshall, for bytes whose number is known: nothing behind length is read.
 * The bytes are in this host's order.
 * Errors: IPC_Wrong_Buffer_Length when the bytes do not hold a value of the format;
 * otherwise as IPC_unmarshall.
 */
IPC_RETURN_TYPE IPCx_unmarshallN(FORMATTER_PTR formatter, BYTE_ARRAY byteArray,
                                 unsigned int length, void **dataHandle);

/*
 * An empty string that arrives is NULL, as programs for CMU IPC expect.  With keep 1 it
 * is "" from now on.  For the whole process; to be called before data arrive.  The
 * environment variable IPC_EMPTY_STRINGS=1 has the same effect.
 * Returns IPC_OK, or IPC_Error with IPC_Argument_Out_Of_Range for other values than 0 and 1.
 */
IPC_RETURN_TYPE IPCx_setEmptyStrings(int keep);

/* --------------------------------------------------------------------- shell */

/*
 * Ends the central of that server in good order [4.49]: its process is found on this
 * machine and asked to end, which the caller must be allowed to do.  Works with a central
 * of CMU IPC as well.  server: as for IPC_connectModule.  Waits up to 5 seconds.
 * Returns IPC_OK when it has ended, IPC_Timeout when it stays, IPC_Error with
 * IPC_Not_Connected (there is none), IPC_Communication_Error (it is not on this machine, or
 * ending it is not allowed).
 */
IPC_RETURN_TYPE IPCx_killCentral(const char *server);

/*
 * Ends all modules of that name [4.50], as IPCx_killCentral ends central; central notices
 * and tells the others.  server NULL: the central of the current context, or as for
 * IPC_connect.  A central of CMU IPC does not know the processes of its modules: then the
 * result is IPC_Error with IPC_Message_Not_Defined.
 * Errors: IPC_Null_Argument; IPC_Argument_Out_Of_Range (no module of that name is
 * connected); otherwise as IPCx_killCentral.
 */
IPC_RETURN_TYPE IPCx_killModule(const char *moduleName, const char *server);

/* The functions of the manual, for CENTRALHOST; what goes wrong is printed by verbosity. */
void killCentral(void);
void killModule(char *taskName);

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif

#if defined(__cplusplus)
}
#endif

#endif /* _IPCX_H */
