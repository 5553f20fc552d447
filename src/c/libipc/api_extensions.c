/*
 * API: the additions of ipcx.h.
 */
#include "ipc/ipcx.h"

#include <stdlib.h>

#include "libipc/api.h"
#include "libipc/event_set.h"
#include "libipc/formatter.h"
#include "libipc/known_arrays.h"
#include "libipc/shell.h"
#include "libipc/wait.h"

/* One pass of a listening call handles what waits when it begins; what its handlers cause comes next,
 * but a program whose handlers always cause more gets back to its own loop. */
enum { MAX_PASSES = 16 };

int IPCx_fd(void)
{
    struct library *library = library_enter();
    const int fd = event_set_descriptor(library);
    library_leave(library);
    return fd;
}

int IPCx_descriptors(IPCX_DESCRIPTOR *list, int room)
{
    struct ready_item *items;
    struct library *library = library_enter();
    const int n_items = (int)wait_list(library, &items);
    for (int i = 0; i < n_items && i < room && list != NULL; i++) {
        list[i].fd = items[i].fd;
        list[i].events = (items[i].wanted & READY_READ ? IPCX_READ : 0) |
                         (items[i].wanted & READY_WRITE ? IPCX_WRITE : 0);
    }
    library_leave(library);
    free(items);
    return n_items;
}

long IPCx_nextTimeout(void)
{
    struct library *library = library_enter();
    const bool waiting = event_set_is_waiting(library);
    const uint64_t due = library->next_timer_ns;
    library_leave(library);
    const uint64_t now = clock_ns();
    if (waiting || due <= now) {
        return 0;
    }
    return due == UINT64_MAX ? -1 : (long)((due - now + 999999u) / 1000000u);
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
    library_leave(library);
    return result == IPC_Error ? IPC_Error : first;
}

void IPCx_setGiveUp(int (*giveUp)(void))
{
    struct library *library = library_enter();
    library->give_up = giveUp;
    library_leave(library);
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

IPC_RETURN_TYPE IPCx_unmarshallN(FORMATTER_PTR formatter, BYTE_ARRAY byteArray,
                                 unsigned int length, void **dataHandle)
{
    const struct format *format = formatter_format(formatter);
    const struct format_source source = {byteArray, length, byte_order_of_host()};
    struct library *library = library_enter();
    const bool ready = library_is_ready(library);
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
    if (IPCx_killModule(taskName, NULL) == IPC_Error &&
        IPC_errno == IPC_Argument_Out_Of_Range) {
        report_warning("No task named %s was found\n", taskName);
    }
}
