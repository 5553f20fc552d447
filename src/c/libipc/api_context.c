/*
 * API: contexts and timers [manual 7 and 8].
 */
#include <inttypes.h>

#include "libipc/api.h"
#include "libipc/timer.h"

/* ------------------------------------------------------------------- contexts */

IPC_CONTEXT_PTR IPC_getContext(void)
{
    struct library *library = library_enter();
    struct _X_IPC_CONTEXT *context = context_current(library);
    if (context != NULL && !context_is_live(context) && !context->shown_as_lost) {
        context = NULL;
    }
    library_leave(library);
    return context;
}

IPC_RETURN_TYPE IPC_setContext(IPC_CONTEXT_PTR context)
{
    if (context == NULL) {
        return report(IPC_Null_Argument);
    }
    struct library *library = library_enter();
    const bool known = context_is_known(library, context);
    struct running *running = library_running(library);
    if (known && running != NULL && running->context != NULL) {
        running->context = context;
    } else if (known) {
        library->current = context;
    }
    library_leave(library);
    return report(known ? IPC_No_Error : IPC_Argument_Out_Of_Range);
}

/* --------------------------------------------------------------------- timers */

static IPC_RETURN_TYPE add(bool negative, unsigned long delay, long count,
                           TIMER_HANDLER_TYPE handler, void *clientData, TIMER_REF *reference)
{
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    if (negative || delay == 0 || (count <= 0 && count != TRIGGER_FOREVER)) {
        return report(IPC_Argument_Out_Of_Range);
    }
    struct library *library = library_enter();
    const TIMER_REF added =
        timer_add(library, delay, count, handler, clientData, reference != NULL);
    library_leave(library);
    if (reference != NULL) {
        *reference = added;
    }
    return IPC_OK;
}

IPC_RETURN_TYPE IPC_addTimer(unsigned long tdelay, long count, TIMER_HANDLER_TYPE handler,
                             void *clientData)
{
    return add(false, tdelay, count, handler, clientData, NULL);
}

IPC_RETURN_TYPE IPC_addTimerGetRef(unsigned long tdelay, long count, TIMER_HANDLER_TYPE handler,
                                   void *clientData, TIMER_REF *timerRef)
{
    return add(false, tdelay, count, handler, clientData, timerRef);
}

IPC_RETURN_TYPE IPC_addOneShotTimer(long tdelay, TIMER_HANDLER_TYPE handler, void *clientData)
{
    return add(tdelay < 0, (unsigned long)tdelay, 1, handler, clientData, NULL);
}

IPC_RETURN_TYPE IPC_addPeriodicTimer(long tdelay, TIMER_HANDLER_TYPE handler, void *clientData)
{
    return add(tdelay < 0, (unsigned long)tdelay, TRIGGER_FOREVER, handler, clientData, NULL);
}

IPC_RETURN_TYPE IPC_removeTimer(TIMER_HANDLER_TYPE handler)
{
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    struct library *library = library_enter();
    if (!timer_remove(library, handler)) {
        report_warning("Timer for handler (0x%" PRIxPTR ") does not exist\n", (uintptr_t)handler);
    }
    library_leave(library);
    return IPC_OK;
}

IPC_RETURN_TYPE IPC_removeTimerByRef(TIMER_REF timerRef)
{
    if (timerRef == NULL) {
        return report(IPC_Null_Argument);
    }
    struct library *library = library_enter();
    if (!timer_remove_reference(library, timerRef)) {
        report_warning("Timer with ref 0x%" PRIxPTR " does not exist\n", (uintptr_t)timerRef);
    }
    library_leave(library);
    return IPC_OK;
}
