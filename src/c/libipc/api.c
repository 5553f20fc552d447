/*
 * Entering and leaving the library.
 */
#include "libipc/api.h"

#include "libipc/event_set.h"
#include "libipc/wait.h"

IPC_ERROR_TYPE api_enter(struct api *api)
{
    api->library = library_enter();
    api->context = library_connected(api->library);
    return api->context != NULL ? IPC_No_Error : IPC_Not_Connected;
}

IPC_ERROR_TYPE api_enter_to_marshall(struct api *api)
{
    const IPC_ERROR_TYPE error = api_enter(api);
    return library_is_ready(api->library) ? error : IPC_Not_Initialized;
}

IPC_RETURN_TYPE api_leave(struct api *api, IPC_ERROR_TYPE error)
{
    struct _X_IPC_CONTEXT *lost = context_take_loss(api->library, false);
    event_set_tell(api->library); /* the call may have taken in messages */
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
