/*
 * API: the additions of ipcx.h.
 */
#include "ipc/ipcx.h"

#include "libipc/api.h"
#include "libipc/closing.h"
#include "libipc/connect.h"
#include "libipc/event_set.h"
#include "libipc/formatter.h"
#include "libipc/inbox.h"
#include "libipc/known_arrays.h"
#include "libipc/notify.h"
#include "libipc/shell.h"
#include "libipc/wait.h"

/* One pass of a listening call handles what waits when it begins; what its handlers cause comes next,
 * but a program whose handlers always cause more gets back to its own loop. */
enum { MAX_PASSES = 16 };

int IPCx_fd(void)
{
    struct library *library = library_enter();
    const int fd = event_set_descriptor(library);
    inbox_tell(library);
    library_leave(library);
    return fd;
}

int IPCx_descriptors(IPCX_DESCRIPTOR *list, int room)
{
    struct source_list sources;
    int count = 0;
    struct library *library = library_enter();
    event_set_list(library, &sources);
    for (size_t i = 0; i < sources.count; i++) {
        const struct ready_item *item = &sources.items[i];
        if (item->fd < 0) {
            continue;
        }
        if (count < room && list != NULL) {
            list[count].fd = item->fd;
            list[count].events = (item->wanted & READY_READ ? IPCX_READ : 0) |
                                 (item->wanted & READY_WRITE ? IPCX_WRITE : 0);
        }
        count++;
    }
    source_list_fini(&sources);
    library_leave(library);
    return count;
}

long IPCx_nextTimeout(void)
{
    struct library *library = library_enter();
    const bool waiting = inbox_is_any_waiting(library);
    const uint64_t again = wait_due(library);
    const uint64_t due = again < library->next_timer_ns ? again : library->next_timer_ns;
    library_leave(library);
    const uint64_t now = clock_ns();
    if (waiting || due <= now) {
        return 0;
    }
    return due == NO_DEADLINE ? -1 : (long)((due - now + 999999u) / 1000000u);
}

IPC_RETURN_TYPE IPCx_process(void)
{
    IPC_RETURN_TYPE first = IPC_listen(0);
    IPC_RETURN_TYPE result = first;
    for (int i = 1; i < MAX_PASSES && result == IPC_OK && IPC_isConnected() && !api_is_given_up();
         i++) {
        result = IPC_listen(0);
    }
    struct library *library = library_enter();
    event_set_update(library);
    inbox_tell(library);
    library_leave(library);
    return result == IPC_Error ? IPC_Error : first;
}

void IPCx_setGiveUp(int (*giveUp)(void))
{
    struct library *library = library_enter();
    library->give_up = giveUp;
    library->ask_again_ns = 0;
    library_leave(library);
}

void IPCx_setTextHandler(IPCX_TEXT_HANDLER handler)
{
    report_to(handler);
}

IPC_RETURN_TYPE IPCx_arrayInfo(BYTE_ARRAY byteArray, unsigned int *length, int *isBigEndian)
{
    if (byteArray == NULL || length == NULL || isBigEndian == NULL) {
        return report(IPC_Null_Argument);
    }
    struct library *library = library_enter();
    const struct format_source source = known_arrays_find(library, byteArray);
    library_leave(library);
    if (source.length == SIZE_MAX) {
        return report(IPC_Argument_Out_Of_Range);
    }
    *length = (unsigned int)source.length;
    *isBigEndian = source.order == ORDER_BIG;
    return IPC_OK;
}

IPC_RETURN_TYPE IPCx_unmarshallN(FORMATTER_PTR formatter, BYTE_ARRAY byteArray, unsigned int length,
                                 void **dataHandle)
{
    const struct format *format = formatter_format(formatter);
    const struct format_source source = {byteArray, length, byte_order_of_host()};
    struct library *library = library_enter();
    const bool ready = library->initialised;
    library_leave(library);
    if (!ready) {
        return report(IPC_Not_Initialized);
    }
    if (dataHandle == NULL || (byteArray == NULL && length > 0)) {
        return report(IPC_Null_Argument);
    }
    *dataHandle = NULL;
    if (format == NULL || format_size(format) == 0) {
        return IPC_OK;
    }
    if (format_is_bad(format)) {
        return report(IPC_Illegal_Formatter);
    }
    return report(format_decode_new(format, &source, dataHandle, NULL) == 0
                      ? IPC_No_Error
                      : IPC_Wrong_Buffer_Length);
}

IPC_RETURN_TYPE IPCx_setEmptyStrings(int keep)
{
    if (keep != 0 && keep != 1) {
        return report(IPC_Argument_Out_Of_Range);
    }
    format_set_empty_strings(keep != 0);
    return IPC_OK;
}

IPC_RETURN_TYPE IPCx_tryConnect(const char *taskName, const char *serverName)
{
    return connect_if_there(taskName, serverName);
}

/* ------------------------------------------------------------- loss of central */

IPC_RETURN_TYPE IPCx_setReconnect(IPCX_RECONNECT mode)
{
    struct api api;
    if ((int)mode < IPCX_RECONNECT_NEVER || (int)mode > IPCX_RECONNECT_WAIT) {
        return report(IPC_Argument_Out_Of_Range);
    }
    const IPC_ERROR_TYPE error = api_enter_live(&api);
    if (error == IPC_No_Error) {
        api.context->reconnect = mode;
        if (mode == IPCX_RECONNECT_NEVER && api.context->away != NULL) {
            closing_end(api.context, CONTEXT_CLOSED);
        }
        wait_changed(api.library); /* calls that wait look again */
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPCx_subscribeConnection(IPCX_CONNECTION_HANDLER handler, void *clientData)
{
    struct api api;
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    const IPC_ERROR_TYPE error = api_enter_live(&api);
    if (error == IPC_No_Error) {
        notify_add_connection(api.context, handler, clientData);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPCx_unsubscribeConnection(IPCX_CONNECTION_HANDLER handler)
{
    struct api api;
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    const IPC_ERROR_TYPE error = api_enter_live(&api);
    if (error == IPC_No_Error) {
        notify_remove_connection(api.context, handler);
    }
    return api_leave(&api, error);
}

/* ----------------------------------------------------------------------- shell */

static IPC_RETURN_TYPE result_of(enum shell_result result, IPC_ERROR_TYPE if_none)
{
    switch (result) {
    case SHELL_ENDED:
        return IPC_OK;
    case SHELL_STAYS:
        return IPC_Timeout;
    case SHELL_NONE:
        return report(if_none);
    case SHELL_CANNOT_ASK:
        return report(IPC_Message_Not_Defined);
    case SHELL_ELSEWHERE:
    case SHELL_REFUSED:
    default:
        return report(IPC_Communication_Error);
    }
}

IPC_RETURN_TYPE IPCx_killCentral(const char *server)
{
    return result_of(shell_end_central(server), IPC_Not_Connected);
}

IPC_RETURN_TYPE IPCx_killModule(const char *moduleName, const char *server)
{
    if (api_is_missing(moduleName)) {
        return report(IPC_Null_Argument);
    }
    return result_of(shell_end_module(moduleName, server), IPC_Argument_Out_Of_Range);
}

void killCentral(void)
{
    (void)IPCx_killCentral(NULL); /* what goes wrong has been printed */
}

void killModule(char *taskName)
{
    if (IPCx_killModule(taskName, NULL) == IPC_Error && IPC_errno == IPC_Argument_Out_Of_Range) {
        report_warning("No task named %s was found\n", taskName);
    }
}
