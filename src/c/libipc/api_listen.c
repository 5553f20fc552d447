/*
 * API: listening and descriptors [manual 4.29 to 4.38].
 */
#include "libipc/api.h"
#include "libipc/listen.h"
#include "libipc/wait.h"
#include "libipc/watch_fd.h"

enum { CLEAR_MS = 5 }; /* IPC_listenClear ends when nothing comes for that long */

/* Reports losses that came before this call, found by a failed write. */
static void report_old_losses(void)
{
    struct library *library = library_enter();
    struct _X_IPC_CONTEXT *lost = context_take_loss(library, true);
    library_leave(library);
    if (lost != NULL) {
        report_loss(lost);
    }
}

static IPC_RETURN_TYPE result_of(struct api *api, enum listen_result result)
{
    const int broken = watch_fd_broken(api->library);
    switch (result) {
    case LISTEN_HANDLED:
        return api_leave(api, IPC_No_Error);
    case LISTEN_BAD_DESCRIPTOR:
        report_note("ERROR: Bad file descriptor %d in listen\n", broken);
        return api_leave(api, IPC_Communication_Error);
    case LISTEN_DISCONNECTED:
        return api_leave(api, IPC_Not_Connected);
    case LISTEN_NOTHING:
    case LISTEN_GIVEN_UP:
    default:
        return api_leave(api, IPC_No_Error) == IPC_OK ? IPC_Timeout : IPC_Error;
    }
}

/* One pass.  A connection that is lost during it is reported and counts as an event. */
static IPC_RETURN_TYPE listen_until(uint64_t deadline_ns, enum listen_mode mode)
{
    struct api api;
    report_old_losses();
    const IPC_ERROR_TYPE error = api_enter_live(&api);
    if (error != IPC_No_Error) {
        return api_leave(&api, error);
    }
    const enum listen_result result = listen_pass(api.library, deadline_ns, mode);
    struct _X_IPC_CONTEXT *lost = context_take_loss(api.library, true);
    if (lost != NULL) {
        library_leave(api.library);
        report_loss(lost);
        return IPC_OK;
    }
    return result_of(&api, result);
}

IPC_RETURN_TYPE IPC_listen(unsigned int timeoutMSecs)
{
    return listen_until(wait_deadline(timeoutMSecs), LISTEN_BATCH);
}

IPC_RETURN_TYPE IPC_listenClear(unsigned int timeoutMSecs)
{
    const IPC_RETURN_TYPE first = IPC_listen(timeoutMSecs);
    IPC_RETURN_TYPE result = first;
    while (result == IPC_OK && IPC_isConnected() && !api_is_given_up()) {
        result = IPC_listen(CLEAR_MS);
    }
    return result == IPC_Error ? IPC_Error : first;
}

IPC_RETURN_TYPE IPC_listenWait(unsigned int timeoutMSecs)
{
    const uint64_t deadline = wait_deadline(timeoutMSecs);
    IPC_RETURN_TYPE result;
    do {
        result = listen_until(deadline, LISTEN_BATCH);
    } while (result != IPC_Error && !wait_is_over(deadline) && !api_is_given_up());
    return result;
}

IPC_RETURN_TYPE IPC_handleMessage(unsigned int timeoutMSecs)
{
    return listen_until(wait_deadline(timeoutMSecs), LISTEN_ONE);
}

IPC_RETURN_TYPE IPC_dispatch(void)
{
    IPC_RETURN_TYPE result;
    do {
        result = IPC_listen(IPC_WAIT_FOREVER);
    } while (result != IPC_Error && !api_is_given_up());
    return result;
}

/* ---------------------------------------------------------------- descriptors */

static bool is_open(int fd)
{
    struct ready_item item = {fd, READY_READ, 0};
    return fd >= 0 && ready_wait(&item, 1, 0) >= 0 && (item.found & READY_INVALID) == 0;
}

IPC_RETURN_TYPE IPC_subscribeFD(int fd, FD_HANDLER_TYPE handler, void *clientData)
{
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    if (!is_open(fd)) {
        return report(IPC_Argument_Out_Of_Range);
    }
    struct library *library = library_enter();
    watch_fd_add(library, fd, handler, clientData);
    library_leave(library);
    return IPC_OK;
}

IPC_RETURN_TYPE IPC_unsubscribeFD(int fd, FD_HANDLER_TYPE handler)
{
    (void)handler; /* a descriptor has one handler, and goes whichever is named */
    struct library *library = library_enter();
    watch_fd_remove(library, fd);
    library_leave(library);
    return IPC_OK;
}
