/*
 * Entering and leaving the library.
 */
#include "libipc/api.h"

#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/receive.h"
#include "libipc/wait.h"

/* Whether the connection is there.  A program that never listens gets it back by its calls, and what
 * waits for a connection does not go out over one that has broken. */
static bool is_there(struct _X_IPC_CONTEXT *context)
{
    if (context->away != NULL) {
        (void)wait_turn(context->library, clock_ns());
    } else if (context->reconnect == IPCX_RECONNECT_WAIT) {
        (void)receive(context); /* a loss shows in the context's state */
    }
    return exchange_await_central(context);
}

IPC_ERROR_TYPE api_enter(struct api *api)
{
    IPC_ERROR_TYPE error = api_enter_live(api);
    if (error == IPC_No_Error && !is_there(api->context)) {
        api->context = NULL;
        error = IPC_Not_Connected;
    }
    return error;
}

IPC_ERROR_TYPE api_enter_live(struct api *api)
{
    api->library = library_enter();
    api->context = context_current_live(api->library);
    return api->context != NULL ? IPC_No_Error : IPC_Not_Connected;
}

IPC_ERROR_TYPE api_enter_to_marshall(struct api *api)
{
    const IPC_ERROR_TYPE error = api_enter(api);
    return api->library->initialised ? error : IPC_Not_Initialized;
}

IPC_RETURN_TYPE api_leave(struct api *api, IPC_ERROR_TYPE error)
{
    struct _X_IPC_CONTEXT *lost = context_take_loss(api->library, false);
    inbox_tell(api->library); /* the call may have taken in messages */
    library_leave(api->library);
    if (lost == NULL) {
        return report(error);
    }
    report_loss(lost);
    if (error == IPC_No_Error) {
        return IPC_OK;
    }
    IPC_errno = IPC_Not_Connected; /* the loss has been reported; once is enough */
    return IPC_Error;
}

bool api_is_given_up(void)
{
    struct library *library = library_enter();
    const bool given_up = wait_is_given_up(library);
    library_leave(library);
    return given_up;
}
