/*
 * Verbosity, IPC_errno, and texts.
 */
#include "libipc/report.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/error.h"

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

void report_note_values(const char *text, va_list values)
{
    print(stderr, IPC_Print_Errors, text, values);
}

void report_note(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    report_note_values(text, values);
    va_end(values);
}
