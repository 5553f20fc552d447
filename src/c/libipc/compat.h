/*
 * Symbols beyond ipc.h that existing programs declare by hand and link with.
 *
 * They are thin forwards to the API and are shown by the library for these
 * programs alone.  Two variables of the same kind are in report.h.
 */
#ifndef IPC_LIBIPC_COMPAT_H
#define IPC_LIBIPC_COMPAT_H

#include <stddef.h>

#include "ipc/ipc.h"

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(default)
#endif

/* Registers what is called instead of exit when the library would end the process; NULL: nothing. */
void x_ipcRegisterExitProc(void (*procedure)(void));

/* The descriptors of IPC_getConnections; valid until the next call of the library. */
fd_set *x_ipcGetConnections(void);
/* The largest descriptor that was ever among them. */
int x_ipcGetMaxConnection(void);
/* The descriptor of the connection to central, -1: none. */
int x_ipcGetServer(void);
/* Milliseconds of the clock of the timer handlers. */
unsigned long x_ipc_timeInMsecs(void);
/* Disconnects; with 0 only this process's copy of the connection, as after fork. */
void x_ipcCloseInternal(int informServer);
void x_ipcClose(void);
void *x_ipcMalloc(size_t size);
void x_ipcFree(void *block);

/* As IPC_subscribe or (autoUnmarshall 1) IPC_subscribeData, known by hndName instead of the function. */
IPC_RETURN_TYPE _IPC_subscribe(const char *msgName, const char *hndName, HANDLER_TYPE handler,
                               void *clientData, int autoUnmarshall);
IPC_RETURN_TYPE _IPC_unsubscribe(const char *msgName, const char *hndName);
/* As IPC_queryResponse, and gives the formatter of the response (replyFormatter may be NULL). */
IPC_RETURN_TYPE _IPC_queryResponse(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                   BYTE_ARRAY *replyHandle, FORMATTER_PTR *replyFormatter,
                                   unsigned int timeoutMsecs);
/* As the IPC_connect and IPC_initialize functions; isLispModule has no effect. */
IPC_RETURN_TYPE _IPC_connect(const char *taskName, const char *serverName, int willListen,
                             int isLispModule);
IPC_RETURN_TYPE _IPC_initialize(int isLispModule);

/* Sets IPC_errno, prints and terminates as a failing call does. */
void ipcSetError(IPC_ERROR_TYPE error);
/* Calls that a timer still has to make; 0 for an unknown one. */
unsigned int maxTriggers(TIMER_REF timerRef);

/* As IPC_parseFormat, but an illegal string gives a formatter that every call refuses. */
FORMATTER_PTR ParseFormatString(const char *formatString);
/* Sizes in memory and on the wire; data may be NULL for formats without pointers. */
int x_ipc_dataStructureSize(FORMATTER_PTR formatter);
int x_ipc_bufferSize(FORMATTER_PTR formatter, const void *data);
int formatsEqual(FORMATTER_PTR first, FORMATTER_PTR second);
int x_ipc_sameFixedSizeDataBuffer(FORMATTER_PTR formatter);
int formatContainsPointers(FORMATTER_PTR formatter);

#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif

#endif
