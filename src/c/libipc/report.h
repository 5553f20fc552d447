/*
 * What the library says to the user, by verbosity.
 *
 * Warnings and notes are only said, on the standard streams or to a function of the
 * program.  What errors of API calls lead to is in report_result.h.
 */
#ifndef IPC_LIBIPC_REPORT_H
#define IPC_LIBIPC_REPORT_H

#include <stdarg.h>

#include "base/printf.h"
#include "ipc/ipc.h"
#include "ipc/ipcx.h"

/* The API's own globals (IPC_errno is declared in ipc.h).  The library shows them to programs that
 * declare them by hand. */
#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(default)
#endif
extern IPC_VERBOSITY_TYPE ipcVerbosity;         /* assigning to it is IPC_setVerbosity */
extern const char *ipcErrorStrings[NUM_ERRORS]; /* texts of IPC_errno */
#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif

/* IPC_ERROR_TYPE of a code of the layers below. */
IPC_ERROR_TYPE report_code(int error);

/* Who takes what is said below, instead of the standard streams; NULL: nobody. */
void report_to(IPCX_TEXT_HANDLER handler);

/* A warning, at IPC_Print_Warnings and up: on standard error.  May be called with the lock held. */
void report_warning(const char *text, ...) LIKE_PRINTF(1, 2);

/* A banner, at IPC_Print_Warnings and up: on standard output. */
void report_banner(const char *text, ...) LIKE_PRINTF(1, 2);

/* An error, at IPC_Print_Errors and up: on standard error.  May be called with the lock held. */
void report_note(const char *text, ...) LIKE_PRINTF(1, 2);
void report_note_values(const char *text, va_list values) LIKE_PRINTF(1, 0);

#endif
