/*
 * What the library says to the user, and how it ends the process.
 *
 * Errors of API calls set IPC_errno, print by verbosity, and at
 * IPC_Exit_On_Errors end the process or call the exit procedure.  Warnings and
 * notes only print.  None of the report_… functions that may end the process is
 * called with the library's lock held.
 */
#ifndef IPC_LIBIPC_REPORT_H
#define IPC_LIBIPC_REPORT_H

#include "ipc/ipc.h"

#include "libipc/library.h"

#if defined(__GNUC__)
#define REPORT_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define REPORT_PRINTF(text, first)
#endif

/* IPC_ERROR_TYPE of a code of the layers below. */
IPC_ERROR_TYPE report_code(int error);

/* Prints on standard error at IPC_Print_Warnings and up.  May be called with the lock held. */
void report_warning(const char *text, ...) REPORT_PRINTF(1, 2);

/* Prints on standard output at IPC_Print_Warnings and up. */
void report_banner(const char *text, ...) REPORT_PRINTF(1, 2);

/* Prints on standard error at IPC_Print_Errors and up.  May be called with the lock held. */
void report_note(const char *text, ...) REPORT_PRINTF(1, 2);

/* An API call failed: IPC_Error, unless the process ends.  IPC_No_Error gives IPC_OK. */
IPC_RETURN_TYPE report(IPC_ERROR_TYPE error);

/* An error with a text of its own at IPC_Print_Errors; ends the process at IPC_Exit_On_Errors. */
void report_internal_error(const char *text, ...) REPORT_PRINTF(1, 2);

/* The connection to central is lost: prints, and ends the process or calls the exit procedure,
 * whatever the verbosity. */
void report_loss(struct _X_IPC_CONTEXT *context);

#endif
