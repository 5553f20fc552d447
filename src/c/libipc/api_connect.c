/*
 * API: initializing, connecting, errors and verbosity [manual 4.1 to 4.19].
 */
#include <stdio.h>

#include "libipc/api.h"
#include "libipc/closing.h"
#include "libipc/connect.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/inbox.h"
#include "libipc/wait.h"

IPC_RETURN_TYPE IPC_initialize(void)
{
    struct library *library = library_enter();
    library_initialise(library);
    library_leave(library);
    return IPC_OK;
}

IPC_RETURN_TYPE IPC_connectModule(const char *taskName, const char *serverName)
{
    return connect_module(taskName, serverName, true);
}

IPC_RETURN_TYPE IPC_connect(const char *taskName)
{
    return connect_module(taskName, NULL, true);
}

IPC_RETURN_TYPE IPC_connectModuleNoListen(const char *taskName, const char *serverName)
{
    return connect_module(taskName, serverName, false);
}

IPC_RETURN_TYPE IPC_connectNoListen(const char *taskName)
{
    return connect_module(taskName, NULL, false);
}

IPC_RETURN_TYPE IPC_disconnect(void)
{
    struct library *library = library_enter();
    struct _X_IPC_CONTEXT *context = context_current(library);
    if (context != NULL) {
        closing_disconnect(context, true);
    }
    if (!context_any_live(library)) {
        library->initialised = false;
    }
    library_leave(library);
    return IPC_OK;
}

int IPC_isConnected(void)
{
    struct library *library = library_enter();
    const struct _X_IPC_CONTEXT *context = context_current_live(library);
    if (context != NULL && context->away != NULL) {
        (void)wait_turn(library,
                        clock_ns()); /* a program that asks again and again sees it come back */
        inbox_tell(library);
    }
    const int connected = context_current_connected(library) != NULL;
    library_leave(library);
    return connected;
}

int IPC_isModuleConnected(const char *moduleName)
{
    struct api api;
    int connected = 0;
    if (api_is_missing(moduleName)) {
        (void)report(IPC_Null_Argument);
        return -1;
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = exchange_ask(api.context, LM_IS_CONNECTED, &moduleName, &connected);
    }
    return api_leave(&api, error) == IPC_OK ? connected != 0 : -1;
}

/* The set under construction, and whose it is. */
struct connections {
    struct library *library;
    fd_set set;
};

static void add_fd(void *connections_pointer, int fd)
{
    struct connections *connections = connections_pointer;
    ready_set_add(&connections->set, fd);
    if (fd > connections->library->max_fd) {
        connections->library->max_fd = fd;
    }
}

fd_set IPC_getConnections(void)
{
    struct api api;
    struct connections connections;
    FD_ZERO(&connections.set);
    if (api_enter_live(&api) == IPC_No_Error) {
        connections.library = api.library;
        struct list *position = api.library->watched_fds.next;
        add_fd(&connections, api.context->link.fd);
        direct_each_fd(api.context, add_fd, &connections);
        for (; position != &api.library->watched_fds; position = position->next) {
            add_fd(&connections, source_at(position)->fd);
        }
        if (inbox_first(api.context) != NULL) {
            /* A program that waits for these descriptors must not sleep over messages that are
             * here. */
            add_fd(&connections, api.library->waker.read_fd);
            waker_wake(&api.library->waker);
        }
    }
    library_leave(api.library);
    return connections.set;
}

void IPC_perror(const char *msg)
{
    const int error = (int)IPC_errno;
    if (!api_is_missing(msg)) {
        fprintf(stderr, "%s: ", msg);
    }
    if (error >= 0 && error < NUM_ERRORS) {
        fprintf(stderr, "%s\n", ipcErrorStrings[error]);
    } else {
        fprintf(stderr, "Unknown IPC error %d\n", error);
    }
}

IPC_RETURN_TYPE IPC_setVerbosity(IPC_VERBOSITY_TYPE verbosity)
{
    if ((int)verbosity < IPC_Silent || (int)verbosity > IPC_Exit_On_Errors) {
        return report(IPC_Argument_Out_Of_Range);
    }
    ipcVerbosity = verbosity;
    return IPC_OK;
}
