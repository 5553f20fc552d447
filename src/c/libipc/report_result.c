/*
 * What becomes of an API call that fails, and the end of the process.
 */
#include "libipc/report_result.h"

#include <stdarg.h>
#include <stdlib.h>

#include "libipc/closing.h"

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
    report_note_values(text, values);
    va_end(values);
    report_note("\n");
    end_if_wished();
}

void report_loss(struct _X_IPC_CONTEXT *context)
{
    report_note("Closed Connection Detected from: Central Server %s\n\n", context->server_name);
    end_process(context);
}
