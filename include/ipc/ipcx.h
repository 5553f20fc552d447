/*
 * Additions to the API of the manual: for programs with an event loop of their
 * own, for those that outlive central, for byte arrays from elsewhere, and for
 * those who tell "" from NULL.
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
 * Connects as IPC_connectModule does, if a central is there now: it tries once, and prints
 * nothing when nobody listens there.  A program whose loop must not stand still calls it
 * again a little later.  Names are looked up, and a central that is there is waited for.
 *   taskName    the name of this module
 *   serverName  host or host:port; NULL or "": CENTRALHOST, or else this host
 * Returns IPC_OK when there is a connection, this or an earlier one, and IPC_Timeout when
 * nobody listens there, or an earlier connection has not come back yet.
 * Errors: IPC_Null_Argument (no name); IPC_Not_Connected (serverName names no host, or who
 * listens there is no central).
 */
IPC_RETURN_TYPE IPCx_tryConnect(const char *taskName, const char *serverName);

/* --------------------------------------------------------- loss of central */

/*
 * When central goes, the library prints a line and ends the process, or calls the exit
 * procedure, as CMU IPC does.  A program may choose that it stays instead, and that the
 * library connects again as soon as a central is there where the old one was.
 */
typedef enum {
    IPCX_RECONNECT_NEVER, /* the loss of central ends the connection, as always */
    IPCX_RECONNECT_FAIL,  /* the library connects again; until then calls fail */
    IPCX_RECONNECT_WAIT   /* the library connects again; until then calls wait */
} IPCX_RECONNECT;

/*
 * Chooses what follows the loss of central, for the current context.  Without a choice
 * it is what the environment variable IPC_RECONNECT says when the process begins, fail or
 * wait, which helps programs that know nothing of this, or else IPCX_RECONNECT_NEVER.
 *
 * While central is away the context stays what it is, IPC_isConnected() is 0, and:
 * - Listening calls go on: timers, descriptors, other contexts, and messages that have
 *   arrived.  The loss does not end them.  They, IPCx_process, calls that wait, and all
 *   others that need central keep trying to connect, first after 0.1 seconds, then after
 *   pauses of up to 2 seconds.  None of that takes time: it goes on beside what they do.
 *   A program must call the library now and then for it.
 * - Other calls that need central fail with IPC_Not_Connected, or wait.  As always,
 *   errors end the process at IPC_Exit_On_Errors, which is the verbosity at the start.
 *   No handlers run in a thread whose call waits.
 * - IPC_connect and the like for the same server wait for the context to come back, up to
 *   5 seconds, whatever is chosen; they make no second one.
 * - IPC_disconnect ends it, and so does choosing IPCX_RECONNECT_NEVER: calls that wait
 *   fail with IPC_Not_Connected.  The exit procedure is not called.
 *
 * When central is back, be it one of CMU IPC, it is told everything that this module has
 * told the old one: its name, definitions of messages and of named formats, subscriptions
 * (in their order), notifications, queue lengths, priorities, capacity.  Only then is the
 * context connected.  A message that another module had defined and has not yet defined
 * again is defined for it, as it was, when this module uses it.
 *
 * What the loss costs:
 * - Queries under way fail with IPC_Not_Connected; handlers of IPC_queryNotify that wait
 *   for a response are not called.
 * - Queries of others that have not been answered cannot be any more: IPC_respond fails
 *   with IPC_Not_Connected in their handlers, later (IPC_delayResponse) with
 *   IPC_Argument_Out_Of_Range; those that wait for their handlers are dropped.  All other
 *   messages that have arrived are handled.
 * - What central had taken and not passed on is gone with it.
 * - A call that fails while it changes something, such as IPC_subscribe, may have taken
 *   effect when central is back.  Repeating it does no harm.
 *
 * With IPCX_RECONNECT_WAIT a publication is not lost because central is away: if the
 * connection is known to be broken, or turns out to be while the message is written,
 * the call waits and sends it to the central that comes; modules with direct links
 * (central -c) may then get it twice.  IPC_OK means, as always, that the message is on
 * its way to a central, not that it was handled.
 *
 * central is looked for where it was found the first time, by its numeric address.
 * Errors: IPC_Not_Connected; IPC_Argument_Out_Of_Range.
 */
IPC_RETURN_TYPE IPCx_setReconnect(IPCX_RECONNECT mode);

/* connected: 0 when central is lost, 1 when it is back. */
typedef void (*IPCX_CONNECTION_HANDLER)(int connected, void *clientData);

/*
 * Has handler called, in listening calls, when the current context loses central and is
 * going to connect again, and when it has done so.  The same handler once more only
 * changes clientData.  Like other subscriptions it lasts as long as the context.
 * Errors: IPC_Null_Argument; IPC_Not_Connected.
 */
IPC_RETURN_TYPE IPCx_subscribeConnection(IPCX_CONNECTION_HANDLER handler, void *clientData);

/* Ends that; if handler was not subscribed nothing happens.  Errors: the same. */
IPC_RETURN_TYPE IPCx_unsubscribeConnection(IPCX_CONNECTION_HANDLER handler);

/*
 * Lets a program end calls that wait, as interpreters have to for Ctrl-C and for handlers that
 * failed.  giveUp is asked by the thread that waits: after a wait in which nothing came but perhaps a
 * signal, about every 200 milliseconds, and after handlers ran if the call is to go on.  It may do all
 * that a handler may.
 * When it returns anything but 0 the call ends: listening calls, queries and IPCx_process as if
 * their time were over, others with an error unless their work is done; what was to be sent is.
 * NULL: nobody is asked.
 */
void IPCx_setGiveUp(int (*giveUp)(void));

/* ------------------------------------------------------------------- texts */

/* What a text of the library is, and where it is written if nobody takes it. */
typedef enum {
    IPCX_TEXT_BANNER,  /* versions and connections: standard output */
    IPCX_TEXT_WARNING, /* standard error */
    IPCX_TEXT_ERROR    /* standard error */
} IPCX_TEXT;

/*
 * text: a part of a line, or some lines with their line ends, as it would be written; valid until the
 * function returns.  Called by any thread in the middle of a call of the library, of which the function
 * itself may call nothing.
 */
typedef void (*IPCX_TEXT_HANDLER)(IPCX_TEXT kind, const char *text);

/*
 * Has the texts that the verbosity lets through handed to a function instead of written.  To be called
 * while no other thread uses the library.
 *   handler  NULL: they are written again
 */
void IPCx_setTextHandler(IPCX_TEXT_HANDLER handler);

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
IPC_RETURN_TYPE IPCx_unmarshallN(FORMATTER_PTR formatter, BYTE_ARRAY byteArray, unsigned int length,
                                 void **dataHandle);

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
