/*
 * The public API of IPC: everything that a program which exchanges messages
 * through central includes, and the only header that is public.
 *
 * The comments name the section of the IPC Reference Manual that describes a
 * function in full, e.g. [4.22].  What holds for all functions is said once, here.
 *
 * Results.  A function that returns IPC_RETURN_TYPE gives IPC_OK when it did its
 * work, IPC_Timeout when time ran out before anything came, and otherwise
 * IPC_Error with the reason in IPC_errno.  "Errors" lists the reasons that are
 * particular to a function.  Successful calls leave IPC_errno as it was.
 *
 * Verbosity.  By default (IPC_Exit_On_Errors) an error prints its text and ends
 * the process with status 255, so that IPC_Error is only seen after
 * IPC_setVerbosity() chose another level.
 *
 * Threads.  Any thread may call any function at any time, in handlers too; no
 * lock of the library is held while a handler runs.  The handlers of one context
 * never run at the same time as one another.  Functions return without waiting
 * for another process unless their comment says "Waits"; a function that asks
 * central something, or sends while the connection is congested, runs no handler
 * while it waits.  Only the listening calls do: IPC_listen, IPC_listenClear,
 * IPC_listenWait, IPC_handleMessage, IPC_dispatch and the IPC_queryResponse
 * family.
 *
 * Ownership.  Strings and data that are passed in stay the caller's and are not
 * needed after the call; client data are kept as the pointer they are.  What is
 * handed out is a block of malloc, freed as the comment says.
 *
 * Names of messages and modules compare without regard to ASCII case, names of
 * formats exactly.  A message's name has 1 to 1024 bytes; a longer one is
 * IPC_Argument_Out_Of_Range.
 *
 * Times are milliseconds.
 */
#ifndef _IPC_H
#define _IPC_H

#include <stdio.h>
#if defined(_WIN32)
#if !defined(_WINSOCKAPI_)
#include <winsock2.h> /* fd_set */
#endif
#else
#include <sys/select.h> /* fd_set */
#endif

/* Declares a function with C linkage; some programs use it for functions of their own. */
#if defined(__cplusplus)
#define IPC_EXTERN_FUNCTION(rtn, args) rtn args
#else
#define IPC_EXTERN_FUNCTION(rtn, args) extern rtn args
#endif

#if defined(__cplusplus)
extern "C" {
#endif

/* The library is compiled with hidden symbols; these are the ones it shows. */
#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(default)
#endif

/* ------------------------------------------------------------ constants */

/* As a time limit: none. */
#define IPC_WAIT_FOREVER 0xFFFFFFFF

/* As the length of a message that is being defined: each instance has its own. */
#define IPC_VARIABLE_LENGTH 0xFFFFFFFF

/* As the length of an instance: the one that the message was defined with. */
#define IPC_FIXED_LENGTH (IPC_VARIABLE_LENGTH - 1)

/* As the number of times that a timer fires: until it is removed. */
#define TRIGGER_FOREVER (-1)

/* ---------------------------------------------------------------- types */

/* What a call came to. [4.1] */
typedef enum {
    IPC_Error = 0,  /* it failed: see IPC_errno */
    IPC_OK = 1,     /* it did what it says */
    IPC_Timeout = 2 /* nothing came in the time allowed */
} IPC_RETURN_TYPE;

/* Why a call failed. [4.2] */
typedef enum {
    IPC_No_Error = 0,
    IPC_Not_Connected = 1,          /* needs a connection to central */
    IPC_Not_Initialized = 2,        /* needs IPC_initialize() or a connection */
    IPC_Message_Not_Defined = 3,    /* no module has defined a message of this name */
    IPC_Not_Fixed_Length = 4,       /* fixed length claimed for a variable-length message */
    IPC_Message_Lengths_Differ = 5, /* the length is not that of the definition */
    IPC_Argument_Out_Of_Range = 6,  /* a number, or something stale or foreign */
    IPC_Null_Argument = 7,          /* NULL, or an empty name */
    IPC_Illegal_Formatter = 8,      /* the format string is not one */
    IPC_Mismatched_Formatter = 9,   /* the format does not fit the length or the definition */
    IPC_Wrong_Buffer_Length = 10,   /* the bytes, or the room for the data, have another size */
    IPC_Communication_Error = 11    /* the connection failed */
} IPC_ERROR_TYPE;

/* How many errors there are, IPC_No_Error included. */
#define NUM_ERRORS (1 + (int)IPC_Communication_Error)

/* What the library prints; each level includes those before it. [4.10] */
typedef enum {
    IPC_Silent = 0,         /* nothing */
    IPC_Print_Warnings = 1, /* a banner on stdout, warnings on stderr */
    IPC_Print_Errors = 2,   /* errors on stderr */
    IPC_Exit_On_Errors = 3  /* and ends the process after an error; the default */
} IPC_VERBOSITY_TYPE;

/* Encoded bytes: the content of a message. [4.3] */
typedef void *BYTE_ARRAY;

/* Bytes and their number. [4.4] */
typedef struct {
    unsigned int length; /* in bytes */
    BYTE_ARRAY content;  /* NULL if length is 0 */
} IPC_VARCONTENT_TYPE, *IPC_VARCONTENT_PTR;

/*
 * One received message.  Valid until its handler returns or, after
 * IPC_delayResponse(), until it is answered; used later it is recognised as
 * stale and the call fails with IPC_Argument_Out_Of_Range.
 */
typedef struct _X_IPC_REF *MSG_INSTANCE;

/* One connection to one central with all that belongs to it. [7] */
typedef struct _X_IPC_CONTEXT *IPC_CONTEXT_PTR;

/* A parsed format; NULL is "no format".  Nobody frees it. [6] */
typedef const struct _FORMAT_TYPE *FORMATTER_PTR;

/*
 * Is called with a message. [4.5]
 *   msgInstance  the message, for IPC_msgInstanceName() and others
 *   callData     its content, NULL if it has none; the handler frees it with
 *                IPC_freeByteArray(), or IPC_freeData() after IPC_subscribeData()
 *   clientData   as given to the subscription
 */
typedef void (*HANDLER_TYPE)(MSG_INSTANCE msgInstance, BYTE_ARRAY callData, void *clientData);

/* The same, with callData unmarshalled. [4.6] */
typedef void (*HANDLER_DATA_TYPE)(MSG_INSTANCE msgInstance, void *callData, void *clientData);

/* Is called when fd can be read; reads it, or is called again at once. [4.7] */
typedef void (*FD_HANDLER_TYPE)(int fd, void *clientData);

/* Is told a module that came or went; moduleName is valid during the call. [4.8] */
typedef void (*CONNECT_HANDLE_TYPE)(const char *moduleName, void *clientData);

/* Is told how many subscriptions msgName has now; msgName is valid during the call. [4.9] */
typedef void (*CHANGE_HANDLE_TYPE)(const char *msgName, int numHandlers, void *clientData);

/*
 * Is called when a timer fires. [8.1]
 *   currentTime    milliseconds of a clock that only goes forward
 *   scheduledTime  when it should have fired, on the same clock; never later
 */
typedef void (*TIMER_HANDLER_TYPE)(void *clientData, unsigned long currentTime,
                                   unsigned long scheduledTime);

/* One timer, for IPC_removeTimerByRef(). */
typedef void *TIMER_REF;

/* --------------------------------------------------- errors and printing */

/*
 * The reason of the last failure in this process, of any thread and context.
 * Successful calls do not reset it; a program may assign IPC_No_Error. [4.11]
 */
#if defined(_WIN32) && defined(IPC_DLL)
__declspec(dllimport) /* data of a DLL; functions need nothing */
#endif
extern IPC_ERROR_TYPE IPC_errno;

/*
 * Prints "<msg>: <text of IPC_errno>" on stderr, or the text alone if msg is NULL
 * or empty.  Works before connecting; changes nothing. [4.12]
 */
extern void IPC_perror(const char *msg);

/*
 * Chooses what the library prints, and whether an error ends the process; holds
 * for all contexts, at once, and across disconnecting. [4.39]
 * Errors: IPC_Argument_Out_Of_Range (then nothing changes).
 */
extern IPC_RETURN_TYPE IPC_setVerbosity(IPC_VERBOSITY_TYPE verbosity);

/* ----------------------------------------------------------- connecting */

/*
 * Makes formats and marshalling usable without a connection.  Connecting does
 * this too, and calling it again does no harm.  Always IPC_OK. [4.13]
 */
extern IPC_RETURN_TYPE IPC_initialize(void);

/*
 * Connects to a central server and makes the connection the current context.
 * [4.14]
 *   taskName    the name that this module goes by; need not be unique
 *   serverName  "host" or "host:port" (default port 1381); NULL or "": what the
 *               environment variable CENTRALHOST says, else this machine
 * If the current context is connected to a server of the same name, only whether
 * it listens regularly changes.  While no other context is connected, a new
 * connection starts afresh: subscriptions, definitions and formatters of messages
 * are gone.
 * Errors: IPC_Null_Argument (taskName NULL or empty), IPC_Not_Connected (five
 * tries, a second apart, have failed).
 * Waits: for the tries, each at most 10 seconds after the server accepted.
 */
extern IPC_RETURN_TYPE IPC_connectModule(const char *taskName, const char *serverName);

/* IPC_connectModule(taskName, NULL). [4.15] */
extern IPC_RETURN_TYPE IPC_connect(const char *taskName);

/*
 * IPC_connectModule() for a module that will not listen regularly: central sends
 * it nothing of its own accord, and subscribing prints a warning. [4.16]
 */
extern IPC_RETURN_TYPE IPC_connectModuleNoListen(const char *taskName, const char *serverName);

/* IPC_connectModuleNoListen(taskName, NULL). [4.16] */
extern IPC_RETURN_TYPE IPC_connectNoListen(const char *taskName);

/*
 * Ends the connection of the current context: its subscriptions end, messages
 * that wait are dropped, queries that wait are forgotten, calls of other threads
 * that wait in it fail.  Always IPC_OK, connected or not. [4.17]
 */
extern IPC_RETURN_TYPE IPC_disconnect(void);

/*
 * 1 if the current context has a connection, else 0.  A server that vanished is
 * noticed by the next call that reads or writes. [4.18]
 */
extern int IPC_isConnected(void);

/*
 * 1 if a module of this name is connected to the server of the current context,
 * 0 if not, -1 on error. [4.19]
 * Errors: IPC_Null_Argument, IPC_Not_Connected.  Waits: for central's answer.
 */
extern int IPC_isModuleConnected(const char *moduleName);

/*
 * The descriptors that a listening call of the current context waits for, for
 * programs with a select() loop of their own: when one is readable, call
 * IPC_listenClear(0).  Empty if not connected; changes as connections come and
 * go; cannot hold descriptors from FD_SETSIZE on. [4.31]
 */
extern fd_set IPC_getConnections(void);

/* -------------------------------------------------- defining and publishing */

/*
 * Defines a message. [4.20]
 *   length        bytes of its content, 0 for none, or IPC_VARIABLE_LENGTH
 *   formatString  format of its data [6]; NULL or "" for plain bytes.  With a
 *                 fixed length it must describe a C value of just that size
 * Any module may define a message, before or after others subscribe to it.  A
 * definition that differs from the one in force replaces it, with a warning.
 * Errors: IPC_Null_Argument (msgName), IPC_Not_Connected,
 * IPC_Mismatched_Formatter (length and format), IPC_Illegal_Formatter,
 * IPC_Argument_Out_Of_Range (length, or too long a name), IPC_Communication_Error.
 * Waits: for central if the format uses a named format that is not known here.
 */
extern IPC_RETURN_TYPE IPC_defineMsg(const char *msgName, unsigned int length,
                                     const char *formatString);

/*
 * 1 if some module has defined the message, else 0, also on error. [4.21]
 * Errors: IPC_Null_Argument, IPC_Not_Connected.
 * Waits: for central's answer, until it was 1 once.
 */
extern int IPC_isMsgDefined(const char *msgName);

/*
 * Sends content to all who subscribe to the message. [4.22]
 *   length   bytes of content, or IPC_FIXED_LENGTH
 *   content  may be NULL if there are none
 * Errors: IPC_Null_Argument, IPC_Not_Connected, IPC_Message_Not_Defined,
 * IPC_Message_Lengths_Differ (not the length of the definition),
 * IPC_Not_Fixed_Length (IPC_FIXED_LENGTH for a variable-length message),
 * IPC_Argument_Out_Of_Range (more bytes than a message may have),
 * IPC_Communication_Error.
 * Waits: for central the first time a message is used, and while the connection
 * takes no more bytes.
 */
extern IPC_RETURN_TYPE IPC_publish(const char *msgName, unsigned int length, BYTE_ARRAY content);

/*
 * IPC_publish() of varcontent's bytes. [4.23]
 * Errors, Waits: as there; IPC_Null_Argument also for varcontent.
 */
extern IPC_RETURN_TYPE IPC_publishVC(const char *msgName, IPC_VARCONTENT_PTR varcontent);

/* IPC_publish() with IPC_FIXED_LENGTH, errors and waiting as there. [4.24] */
extern IPC_RETURN_TYPE IPC_publishFixed(const char *msgName, BYTE_ARRAY content);

/* --------------------------------------------- subscribing and receiving */

/*
 * Has handler called with the bytes of each instance of the message. [4.26]
 * The message need not be defined yet.  Subscribing the same handler again only
 * replaces its client data; several handlers are called in the order of their
 * subscriptions.
 * Errors: IPC_Null_Argument (msgName, handler), IPC_Not_Connected,
 * IPC_Communication_Error.
 * Waits: until central has the subscription.
 */
extern IPC_RETURN_TYPE IPC_subscribe(const char *msgName, HANDLER_TYPE handler, void *clientData);

/*
 * IPC_subscribe(), but the handler gets the data unmarshalled: a C value of the
 * message's format, which it frees with
 * IPC_freeData(IPC_msgInstanceFormatter(msgInstance), callData).  For a message
 * without a format it gets the bytes. [4.27, 6.18]
 * Errors, Waits: as IPC_subscribe().
 */
extern IPC_RETURN_TYPE IPC_subscribeData(const char *msgName, HANDLER_DATA_TYPE handler,
                                         void *clientData);

/*
 * Ends the subscription of handler, or with NULL those of all handlers of this
 * context, to the message; instances that wait for it are dropped with a warning.
 * IPC_OK also if there is none. [4.28]
 * Errors: IPC_Null_Argument (msgName), IPC_Not_Connected, IPC_Communication_Error.
 */
extern IPC_RETURN_TYPE IPC_unsubscribe(const char *msgName, HANDLER_TYPE handler);

/*
 * The name of the message, as it was defined. [4.25]
 * The string belongs to the instance.
 * NULL on error: IPC_Null_Argument, IPC_Argument_Out_Of_Range (stale instance).
 */
extern const char *IPC_msgInstanceName(MSG_INSTANCE msgInstance);

/*
 * The number of content bytes of the instance, as they travelled. [4.37]
 * 0 on error: IPC_Null_Argument, IPC_Argument_Out_Of_Range (stale instance).
 */
extern unsigned int IPC_dataLength(MSG_INSTANCE msgInstance);

/* ------------------------------------------------------ file descriptors */

/*
 * Has handler called by listening calls whenever fd can be read.  One handler a
 * descriptor; subscribing again replaces it and its client data, with a warning.
 * Works before connecting too. [4.29]
 * Errors: IPC_Argument_Out_Of_Range (not an open descriptor), IPC_Null_Argument.
 */
extern IPC_RETURN_TYPE IPC_subscribeFD(int fd, FD_HANDLER_TYPE handler, void *clientData);

/*
 * Ends what IPC_subscribeFD() began, whichever handler is given.  To be done
 * before fd is closed.  Always IPC_OK. [4.30]
 */
extern IPC_RETURN_TYPE IPC_unsubscribeFD(int fd, FD_HANDLER_TYPE handler);

/* ------------------------------------------------------------- listening */

/*
 * Waits until a message arrives or a subscribed descriptor can be read, and calls
 * the handlers of all that is there then.  Timers fire meanwhile but do not end
 * the wait. [4.32]
 *   timeoutMSecs  longest wait for the first event; 0 looks only,
 *                 IPC_WAIT_FOREVER has no limit
 * All contexts are served, each handler runs with its own context current, and
 * the current context is the caller's again afterwards.
 * IPC_Timeout if nothing came.
 * Errors: IPC_Not_Connected, IPC_Communication_Error (a subscribed descriptor
 * was closed).
 * Threads: if several listen they take turns.
 */
extern IPC_RETURN_TYPE IPC_listen(unsigned int timeoutMSecs);

/*
 * IPC_listen(timeoutMSecs), and if that handled something goes on until nothing
 * more comes. [4.33]
 * Results, errors and threads as IPC_listen().
 */
extern IPC_RETURN_TYPE IPC_listenClear(unsigned int timeoutMSecs);

/*
 * Listens for timeoutMSecs, whatever comes. [4.34]
 * IPC_Timeout as a rule, IPC_OK if something was handled at the very end: both
 * are success.  Errors and threads as IPC_listen().
 */
extern IPC_RETURN_TYPE IPC_listenWait(unsigned int timeoutMSecs);

/*
 * IPC_listen(), but handles one event only. [4.35]
 * Results, errors and threads as there.
 */
extern IPC_RETURN_TYPE IPC_handleMessage(unsigned int timeoutMSecs);

/*
 * Listens for ever: returns only IPC_Error, once there is no connection any
 * more. [4.36]
 * Errors and threads as IPC_listen().
 */
extern IPC_RETURN_TYPE IPC_dispatch(void);

/* --------------------------------------------------------- flow of messages */

/*
 * How many messages central may give to this module before the handlers of the
 * first have returned, or answered after IPC_delayResponse(). [4.38]
 *   capacity  from 1, the default
 * Errors: IPC_Argument_Out_Of_Range, IPC_Not_Connected, IPC_Communication_Error.
 */
extern IPC_RETURN_TYPE IPC_setCapacity(int capacity);

/*
 * Instances of a message with a higher priority overtake those with a lower one
 * while they wait. [4.40]
 *   priority  from 0; messages without one come after all others
 * Errors: IPC_Argument_Out_Of_Range, IPC_Null_Argument, IPC_Not_Connected,
 * IPC_Communication_Error.
 */
extern IPC_RETURN_TYPE IPC_setMsgPriority(const char *msgName, int priority);

/*
 * Limits how many instances of a message may wait for this module; when another
 * comes, the oldest is dropped. [4.41]
 *   queueLength  from 1
 * Errors: as IPC_setMsgPriority().
 */
extern IPC_RETURN_TYPE IPC_setMsgQueueLength(const char *msgName, int queueLength);

/* ---------------------------------------------------------- notifications */

/*
 * Has handler called when a module connects to the server; not for this module,
 * nor for those that are there already.  Subscribing again replaces the client
 * data; several handlers are called latest first. [4.42]
 * Errors: IPC_Not_Connected, IPC_Null_Argument, IPC_Communication_Error.
 */
extern IPC_RETURN_TYPE IPC_subscribeConnect(CONNECT_HANDLE_TYPE handler, void *clientData);

/* The same for modules that disconnect, end or die. [4.43] */
extern IPC_RETURN_TYPE IPC_subscribeDisconnect(CONNECT_HANDLE_TYPE handler, void *clientData);

/*
 * Ends what IPC_subscribeConnect() began; IPC_OK also if there was nothing.
 * [4.44]  Errors: IPC_Not_Connected.
 */
extern IPC_RETURN_TYPE IPC_unsubscribeConnect(CONNECT_HANDLE_TYPE handler);

/*
 * Ends what IPC_subscribeDisconnect() began; IPC_OK also if there was nothing.
 * [4.45]  Errors: IPC_Not_Connected.
 */
extern IPC_RETURN_TYPE IPC_unsubscribeDisconnect(CONNECT_HANDLE_TYPE handler);

/*
 * The number of subscriptions to a message, of all handlers of all modules; 0
 * for unknown messages, -1 on error. [4.46]
 * Errors: IPC_Null_Argument, IPC_Not_Connected.  Waits: for central's answer.
 */
extern int IPC_numHandlers(const char *msgName);

/*
 * Has handler called when a subscription to the message begins or ends, here or
 * in another module.  Subscribing again replaces the client data; several
 * handlers are called latest first. [4.47]
 * Errors: IPC_Null_Argument (msgName, handler), IPC_Not_Connected,
 * IPC_Message_Not_Defined.  Waits: for central's answer.
 */
extern IPC_RETURN_TYPE IPC_subscribeHandlerChange(const char *msgName, CHANGE_HANDLE_TYPE handler,
                                                  void *clientData);

/*
 * Ends what IPC_subscribeHandlerChange() began; IPC_OK also if there was nothing.
 * [4.48]  Errors: IPC_Null_Argument (msgName), IPC_Not_Connected.
 */
extern IPC_RETURN_TYPE IPC_unsubscribeHandlerChange(const char *msgName,
                                                    CHANGE_HANDLE_TYPE handler);

/* ------------------------------------------------------ query and response */

/*
 * Answers the query msgInstance with an instance of the message msgName. [5.1]
 *   length, content  as for IPC_publish()
 * Only the module that asked gets the answer.  A query can be answered once, by
 * its handler or, after IPC_delayResponse(), later and by any thread; that frees
 * a delayed instance.  After a failed check another attempt is possible.
 * Errors, Waits: as IPC_publish(); IPC_Null_Argument also for msgInstance,
 * IPC_Argument_Out_Of_Range also for one that is stale or answered.
 */
extern IPC_RETURN_TYPE IPC_respond(MSG_INSTANCE msgInstance, const char *msgName,
                                   unsigned int length, BYTE_ARRAY content);

/*
 * Keeps msgInstance valid after its handler returns, until it is answered.  To be
 * called by the handler.  The query counts against the capacity until then.
 * [5.2]
 * Errors: IPC_Null_Argument, IPC_Argument_Out_Of_Range (stale instance).
 */
extern IPC_RETURN_TYPE IPC_delayResponse(MSG_INSTANCE msgInstance);

/*
 * Sends a query and listens until the answer is there. [5.3]
 *   length, content  as for IPC_publish()
 *   replyHandle      gets the bytes of the answer, for the caller to free with
 *                    IPC_freeByteArray(); NULL if it has none and if the call fails
 *   timeoutMsecs     longest wait; an answer that comes later is thrown away
 * The query goes to one subscription only: the oldest whose module is free.
 * IPC_Timeout if no answer came.
 * Errors: as IPC_publish().
 */
extern IPC_RETURN_TYPE IPC_queryResponse(const char *msgName, unsigned int length,
                                         BYTE_ARRAY content, BYTE_ARRAY *replyHandle,
                                         unsigned int timeoutMsecs);

/*
 * Sends a query and returns; a listening call later calls handler with the
 * answer: an instance of the answer's message, its bytes (which the handler frees
 * with IPC_freeByteArray()) and clientData. [5.4]
 *   handler  NULL: the answer is thrown away
 * Errors, Waits: as IPC_publish().
 */
extern IPC_RETURN_TYPE IPC_queryNotify(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                       HANDLER_TYPE handler, void *clientData);

/* IPC_respond() with varcontent's bytes; IPC_Null_Argument also for varcontent. [5.5] */
extern IPC_RETURN_TYPE IPC_respondVC(MSG_INSTANCE msgInstance, const char *msgName,
                                     IPC_VARCONTENT_PTR varcontent);

/* IPC_queryResponse() with varcontent's bytes; IPC_Null_Argument also for varcontent. [5.6] */
extern IPC_RETURN_TYPE IPC_queryResponseVC(const char *msgName, IPC_VARCONTENT_PTR varcontent,
                                           BYTE_ARRAY *replyHandle, unsigned int timeoutMsecs);

/* IPC_queryNotify() with varcontent's bytes; IPC_Null_Argument also for varcontent. [5.7] */
extern IPC_RETURN_TYPE IPC_queryNotifyVC(const char *msgName, IPC_VARCONTENT_PTR varcontent,
                                         HANDLER_TYPE handler, void *clientData);

/* ------------------------------------------------- formats and marshalling */

/*
 * The formatter of a format string; equal strings may give the same one. [6.1]
 * NULL on error: IPC_Not_Initialized, IPC_Illegal_Formatter; NULL without an
 * error for NULL and "".
 * Waits: for central if the string uses a named format that is not known here.
 */
extern FORMATTER_PTR IPC_parseFormat(const char *formatString);

/*
 * Gives a format a name, which formats of all modules may then use; a later
 * definition wins. [6.2]
 * Errors: IPC_Null_Argument, IPC_Not_Connected (nor initialised),
 * IPC_Illegal_Formatter (the name of a primitive type), IPC_Communication_Error.
 */
extern IPC_RETURN_TYPE IPC_defineFormat(const char *formatName, const char *formatString);

/*
 * IPC_OK if formatString means the same as the format that the message was
 * defined with; NULL and "" mean no format. [6.3]
 * Errors: IPC_Mismatched_Formatter (it does not), IPC_Null_Argument,
 * IPC_Not_Connected, IPC_Message_Not_Defined.
 * Waits: for central the first time a message is used.
 */
extern IPC_RETURN_TYPE IPC_checkMsgFormats(const char *msgName, const char *formatString);

/*
 * The formatter of a message, NULL without an error if it has none.  Valid until
 * the connection ends. [6.4]
 * NULL on error: IPC_Null_Argument, IPC_Not_Connected, IPC_Message_Not_Defined,
 * IPC_Illegal_Formatter.
 * Waits: for central the first time a message is used.
 */
extern FORMATTER_PTR IPC_msgFormatter(const char *msgName);

/*
 * The formatter of the message of an instance, as IPC_msgFormatter(). [6.5]
 * NULL on error: IPC_Null_Argument, IPC_Argument_Out_Of_Range (stale instance),
 * IPC_Illegal_Formatter.
 */
extern FORMATTER_PTR IPC_msgInstanceFormatter(MSG_INSTANCE msgInstance);

/*
 * Encodes the C value at dataptr into new bytes, which the caller frees with
 * IPC_freeByteArray(varcontent->content). [6.6]
 *   formatter  NULL: no data; varcontent gets length 0
 * Errors: IPC_Not_Initialized, IPC_Illegal_Formatter, IPC_Null_Argument,
 * IPC_Argument_Out_Of_Range (the value cannot be encoded).
 */
extern IPC_RETURN_TYPE IPC_marshall(FORMATTER_PTR formatter, void *dataptr,
                                    IPC_VARCONTENT_PTR varcontent);

/*
 * Decodes bytes into a new C value, which the caller frees with IPC_freeData().
 * byteArray stays the caller's. [6.7]
 *   byteArray   received by a handler or a query, or made by IPC_marshall(): then
 *               its length is known; for others the content is trusted
 *   dataHandle  gets the value, NULL if formatter is NULL or on error
 * Errors: IPC_Not_Initialized, IPC_Illegal_Formatter, IPC_Null_Argument,
 * IPC_Wrong_Buffer_Length (the bytes are no such value).
 */
extern IPC_RETURN_TYPE IPC_unmarshall(FORMATTER_PTR formatter, BYTE_ARRAY byteArray,
                                      void **dataHandle);

/*
 * Decodes bytes into memory of the caller; what the value points to is new and
 * freed with IPC_freeDataElements(). [6.8]
 *   dataHandle  where the value goes
 *   dataSize    its sizeof, for a check against the format
 * Errors: as IPC_unmarshall(); IPC_Wrong_Buffer_Length also for dataSize,
 * IPC_Null_Argument also for formatter.
 */
extern IPC_RETURN_TYPE IPC_unmarshallData(FORMATTER_PTR formatter, BYTE_ARRAY byteArray,
                                          void *dataHandle, int dataSize);

/* Frees a byte array; NULL is fine, and so is free() instead. [6.9] */
extern void IPC_freeByteArray(BYTE_ARRAY byteArray);

/*
 * Frees a C value and all that it points to.  IPC_OK if both are NULL. [6.10]
 * Errors: IPC_Not_Initialized, IPC_Null_Argument (one is NULL),
 * IPC_Illegal_Formatter.
 */
extern IPC_RETURN_TYPE IPC_freeData(FORMATTER_PTR formatter, void *dataptr);

/* IPC_freeData(), but the memory of the value itself is kept. [6.11] */
extern IPC_RETURN_TYPE IPC_freeDataElements(FORMATTER_PTR formatter, void *dataptr);

/*
 * Encodes the C value at dataptr by the format of the message, and publishes it.
 * If the message has no format, publishes no bytes. [6.12]
 * Errors, Waits: as IPC_publish(); IPC_Null_Argument also for dataptr,
 * IPC_Not_Initialized, IPC_Illegal_Formatter, IPC_Argument_Out_Of_Range (the
 * value cannot be encoded).
 */
extern IPC_RETURN_TYPE IPC_publishData(const char *msgName, void *dataptr);

/*
 * The same for an answer. [6.13]
 * Errors, Waits: as IPC_respond() and IPC_publishData().
 */
extern IPC_RETURN_TYPE IPC_respondData(MSG_INSTANCE msgInstance, const char *msgName,
                                       void *dataptr);

/*
 * The same for IPC_queryNotify(); the handler gets the answer's bytes. [6.14]
 * Errors, Waits: as IPC_publishData().
 */
extern IPC_RETURN_TYPE IPC_queryNotifyData(const char *msgName, void *dataptr, HANDLER_TYPE handler,
                                           void *clientData);

/*
 * The same for IPC_queryResponse(). [6.15]
 *   replyData  gets the answer as a C value of the format of its message, for the
 *              caller to free with IPC_freeData(); NULL if it has none, and if the
 *              call fails
 * Errors: as IPC_publishData(); IPC_Wrong_Buffer_Length if the answer cannot be
 * decoded.
 */
extern IPC_RETURN_TYPE IPC_queryResponseData(const char *msgName, void *dataptr, void **replyData,
                                             unsigned int timeoutMsecs);

/*
 * Writes a C value as text, one line, to stream. [6.16]
 * Errors: IPC_Not_Initialized, IPC_Illegal_Formatter, IPC_Null_Argument.
 */
extern IPC_RETURN_TYPE IPC_printData(FORMATTER_PTR formatter, FILE *stream, void *dataptr);

/*
 * Reads a value in the form that IPC_printData() writes into a new C value, which
 * the caller frees with IPC_freeData().  Not in the manual.
 *   dataHandle  gets the value, NULL on error
 * Errors: IPC_Not_Initialized, IPC_Illegal_Formatter, IPC_Null_Argument,
 * IPC_Mismatched_Formatter (the text is no such value).
 */
extern IPC_RETURN_TYPE IPC_readData(FORMATTER_PTR formatter, FILE *stream, void **dataHandle);

/* -------------------------------------------------------------- contexts */

/*
 * The current context, NULL before connecting and after disconnecting it.  It
 * lives as long as the process.  In a handler: the one its event came from.
 * [7.1]
 */
extern IPC_CONTEXT_PTR IPC_getContext(void);

/*
 * Chooses the context that the following calls act on, in the whole process, or
 * within a handler until it returns. [7.2]
 * Errors: IPC_Null_Argument, IPC_Argument_Out_Of_Range (not a context).
 */
extern IPC_RETURN_TYPE IPC_setContext(IPC_CONTEXT_PTR context);

/* ---------------------------------------------------------------- timers */

/*
 * Has handler called by listening calls every tdelay milliseconds, count times.
 * A timer of the same handler is replaced, with a warning.  Works before
 * connecting too. [8.2]
 *   tdelay  from 1; also the time until the first call
 *   count   from 1, or TRIGGER_FOREVER
 * A call that comes late delays those after it; none is made up for.
 * Errors: IPC_Null_Argument (handler), IPC_Argument_Out_Of_Range.
 */
extern IPC_RETURN_TYPE IPC_addTimer(unsigned long tdelay, long count, TIMER_HANDLER_TYPE handler,
                                    void *clientData);

/* IPC_addTimer(tdelay, 1, ...); errors as there. [8.3] */
extern IPC_RETURN_TYPE IPC_addOneShotTimer(long tdelay, TIMER_HANDLER_TYPE handler,
                                           void *clientData);

/* IPC_addTimer(tdelay, TRIGGER_FOREVER, ...); errors as there. [8.4] */
extern IPC_RETURN_TYPE IPC_addPeriodicTimer(long tdelay, TIMER_HANDLER_TYPE handler,
                                            void *clientData);

/*
 * Removes the oldest timer of this handler; a warning, but IPC_OK, if there is
 * none.  It will not be called again, even if it is due. [8.5]
 * Errors: IPC_Null_Argument.
 */
extern IPC_RETURN_TYPE IPC_removeTimer(TIMER_HANDLER_TYPE handler);

/*
 * IPC_addTimer(), but always a new timer, told apart by timerRef: a handler can
 * have several. [8.6]
 *   timerRef  gets the reference; with NULL this is IPC_addTimer()
 * Errors: as there.
 */
extern IPC_RETURN_TYPE IPC_addTimerGetRef(unsigned long tdelay, long count,
                                          TIMER_HANDLER_TYPE handler, void *clientData,
                                          TIMER_REF *timerRef);

/*
 * Removes one timer; a warning, but IPC_OK, if it has ended or never was. [8.7]
 * Errors: IPC_Null_Argument.
 */
extern IPC_RETURN_TYPE IPC_removeTimerByRef(TIMER_REF timerRef);

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif

#if defined(__cplusplus)
}
#endif

#endif
