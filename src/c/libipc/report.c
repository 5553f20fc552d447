/*
 * Verbosity, IPC_errno, and texts.
 */
#include "libipc/report.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/error.h"
#include "base/text.h"

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

/* ---------------------------------------------------------------------- texts */

/* As the verbosity, a choice of the program for all that the library says. */
static IPCX_TEXT_HANDLER text_handler;

void report_to(IPCX_TEXT_HANDLER handler)
{
    text_handler = handler;
}

static void write_text(IPCX_TEXT kind, const char *format, va_list values)
{
    FILE *stream = kind == IPCX_TEXT_BANNER ? stdout : stderr;
    vfprintf(stream, format, values);
    fflush(stream);
}

static void hand_over_text(IPCX_TEXT kind, const char *format, va_list values)
{
    struct buffer text;
    buffer_init(&text);
    text_append_list(&text, format, values);
    if (buffer_append(&text, "", 1) == 0) {
        text_handler(kind, (const char *)text.bytes);
    }
    buffer_fini(&text);
}

static void say(IPCX_TEXT kind, const char *format, va_list values)
{
    if (ipcVerbosity < (kind == IPCX_TEXT_ERROR ? IPC_Print_Errors : IPC_Print_Warnings)) {
        return;
    }
    if (text_handler != NULL) {
        hand_over_text(kind, format, values);
    } else {
        write_text(kind, format, values);
    }
}

void report_warning(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    say(IPCX_TEXT_WARNING, text, values);
    va_end(values);
}

void report_banner(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    say(IPCX_TEXT_BANNER, text, values);
    va_end(values);
}

void report_note_values(const char *text, va_list values)
{
    say(IPCX_TEXT_ERROR, text, values);
}

void report_note(const char *text, ...)
{
    va_list values;
    va_start(values, text);
    report_note_values(text, values);
    va_end(values);
}
