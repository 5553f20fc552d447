/*
 * What becomes of an API call that fails, and how the library ends the process.
 *
 * Errors of API calls set IPC_errno, print by verbosity, and at
 * IPC_Exit_On_Errors end the process or call the exit procedure.  None of these
 * functions is called with the library's lock held.
 */
#ifndef IPC_LIBIPC_REPORT_RESULT_H
#define IPC_LIBIPC_REPORT_RESULT_H

#include "libipc/context.h"
#include "libipc/report.h"

/* An API call failed: IPC_Error, unless the process ends.  IPC_No_Error gives IPC_OK. */
IPC_RETURN_TYPE report(IPC_ERROR_TYPE error);

/* An error with a text of its own at IPC_Print_Errors; ends the process at IPC_Exit_On_Errors. */
void report_internal_error(const char *text, ...) LIKE_PRINTF(1, 2);

/* The connection to central is lost: prints, and ends the process or calls the exit procedure,
 * whatever the verbosity. */
void report_loss(struct _X_IPC_CONTEXT *context);

#endif
