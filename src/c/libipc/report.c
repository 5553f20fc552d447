/*
 * Verbosity, IPC_errno, texts, and the end of the process.
 */
#include "libipc/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "libipc/compat.h"
#include "libipc/closing.h"
#include "libipc/context.h"

/* The API's own globals.  Old programs read and write them directly. */
IPC_ERROR_TYPE IPC_errno = IPC_No_Error;
IPC_VERBOSITY_TYPE ipcVerbosity = IPC_Exit_On_Errors;

const char *ipcErrorStrings[NUM_ERRORS] = {
    "No IPC error",
    "Not connected to IPC central",
    "IPC not initialized",
    "IPC message not defined",
    "Message is not fixed length",
    "Fixed length of message differs from length argument",
    "Argument out of range",
    "Argument is (unexpectedly) NULL",
    "Illegal format string",
    "Format string does not match that of registered message",
    "Size of byte array does not match dataSize argument",
    "Low level communication (socket) error",
};

IPC_ERROR_TYPE report_code(int error)
{
    switch (error) {
    case 0:
        return IPC_No_Error;
    case ERR_NULL:
        return IPC_Null_Argument;
    case ERR_RANGE:
    case ERR_DEPTH:
    case ERR_LIMIT:
        return IPC_Argument_Out_Of_Range;
    case ERR_FORMAT:
    case ERR_UNKNOWN:
        return IPC_Illegal_Formatter;
    case ERR_CONTENT:
        return IPC_Wrong_Buffer_Length;
    case ERR_CLOSED:
        return IPC_Not_Connected;
    default:
        return IPC_Communication_Error;
    }
}

static void print(FILE *stream, IPC_VERBOSITY_TYPE from, const char *text, va_list values)
{
    if (ipcVerbosity >= from) {
        vfprintf(stream, text, values);
        fflush(stream);
    }
}

void report_warning(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    print(stderr, IPC_Print_Warnings, text, values);
    va_end(values);
}

void report_banner(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    print(stdout, IPC_Print_Warnings, text, values);
    va_end(values);
}

void report_note(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    print(stderr, IPC_Print_Errors, text, values);
    va_end(values);
}

/* Calls the exit procedure if there is one, otherwise ends the process.  The procedure is not
 * called again while it runs. */
static void end_process(struct _X_IPC_CONTEXT *lost)
{
    struct library *library = library_enter();
    void (*const procedure)(void) = library->exit_procedure;
    const bool nested = library->in_exit_procedure;
    if (procedure == NULL) {
        library_leave(library);
        exit(-1);
    }
    if (nested) {
        library_leave(library);
        return;
    }
    struct _X_IPC_CONTEXT *const current = library->current;
    library->in_exit_procedure = true;
    if (lost != NULL) {
        lost->shown_as_lost = true;
        library->current = lost;
    }
    library_leave(library);
    procedure();
    library = library_enter();
    library->in_exit_procedure = false;
    if (lost != NULL) {
        lost->shown_as_lost = false;
        if (library->current == lost) {
            library->current = current;
        }
    }
    library_leave(library);
}

/* What IPC_Exit_On_Errors asks for.  In state fresh nothing ends. */
static void end_if_wished(void)
{
    if (ipcVerbosity < IPC_Exit_On_Errors) {
        return;
    }
    struct library *library = library_enter();
    const bool used = library->used;
    struct _X_IPC_CONTEXT *context = context_current(library);
    if (used && context != NULL && !library->in_exit_procedure) {
        closing_disconnect(context, true);
    }
    library_leave(library);
    if (used) {
        end_process(context);
    }
}

IPC_RETURN_TYPE report(IPC_ERROR_TYPE error)
{
    if (error == IPC_No_Error) {
        return IPC_OK;
    }
    IPC_errno = error;
    report_note("ERROR: %s\n", ipcErrorStrings[error]);
    end_if_wished();
    return IPC_Error;
}

void report_internal_error(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    print(stderr, IPC_Print_Errors, text, values);
    va_end(values);
    report_note("\n");
    end_if_wished();
}

void report_loss(struct _X_IPC_CONTEXT *context)
{
    report_note("Closed Connection Detected from: Central Server %s\n\n", context->server_name);
    end_process(context);
}
