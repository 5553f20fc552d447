/*
 * Symbols beyond ipc.h, as thin forwards.
 */
#include "libipc/compat.h"

#include <stdlib.h>

#include "libipc/api.h"
#include "libipc/closing.h"
#include "libipc/connect.h"
#include "libipc/formatter.h"
#include "libipc/timer.h"

void x_ipcRegisterExitProc(void (*procedure)(void))
{
    struct library *library = library_enter();
    library_initialise(library);
    library->exit_procedure = procedure;
    library_leave(library);
}

fd_set *x_ipcGetConnections(void)
{
    static fd_set connections; /* the interface hands out one set for all */
    connections = IPC_getConnections();
    return &connections;
}

int x_ipcGetMaxConnection(void)
{
    (void)IPC_getConnections(); /* brings the largest one up to date */
    struct library *library = library_enter();
    const int max_fd = library->max_fd;
    library_leave(library);
    return max_fd;
}

int x_ipcGetServer(void)
{
    struct library *library = library_enter();
    const struct _X_IPC_CONTEXT *context = context_current_connected(library);
    const int fd = context != NULL ? context->link.fd : -1;
    library_leave(library);
    return fd;
}

unsigned long x_ipc_timeInMsecs(void)
{
    return timer_milliseconds(clock_ns());
}

void x_ipcCloseInternal(int informServer)
{
    struct library *library = library_enter();
    struct _X_IPC_CONTEXT *context = context_current(library);
    if (context != NULL) {
        closing_disconnect(context, informServer != 0);
    }
    library_leave(library);
}

void x_ipcClose(void)
{
    x_ipcCloseInternal(1);
}

void *x_ipcMalloc(size_t size)
{
    return malloc(size);
}

void x_ipcFree(void *block)
{
    free(block);
}

IPC_RETURN_TYPE _IPC_connect(const char *taskName, const char *serverName, int willListen,
                             int isLispModule)
{
    (void)isLispModule;
    return connect_module(taskName, serverName, willListen != 0);
}

IPC_RETURN_TYPE _IPC_initialize(int isLispModule)
{
    (void)isLispModule;
    return IPC_initialize();
}

void ipcSetError(IPC_ERROR_TYPE error)
{
    (void)report(error); /* its result is for the caller of an API function */
}

unsigned int maxTriggers(TIMER_REF timerRef)
{
    struct library *library = library_enter();
    const long left = timer_count(library, timerRef);
    library_leave(library);
    return (unsigned int)left;
}

FORMATTER_PTR ParseFormatString(const char *formatString)
{
    struct format *format = NULL;
    if (api_is_missing(formatString)) {
        return NULL;
    }
    struct library *library = library_enter();
    if (formatter_parse(library, formatString, &format) != FORMATTER_OK) {
        format = format_bad();
    }
    library_leave(library);
    return formatter_of(format);
}

int x_ipc_dataStructureSize(FORMATTER_PTR formatter)
{
    return (int)format_size(formatter_format(formatter));
}

int x_ipc_bufferSize(FORMATTER_PTR formatter, const void *data)
{
    const struct format *format = formatter_format(formatter);
    size_t length = 0;
    void *any = NULL;
    if (format == NULL) {
        return 0;
    }
    if (data == NULL && format_is_flat(format)) {
        any = calloc(1, format_size(format) + 1); /* every value of a flat format is as long */
    }
    if (format_measure(format, data != NULL ? data : any, &length) != 0) {
        length = 0;
    }
    free(any);
    return (int)length;
}

int formatsEqual(FORMATTER_PTR first, FORMATTER_PTR second)
{
    return format_equal(formatter_format(first), formatter_format(second));
}

int x_ipc_sameFixedSizeDataBuffer(FORMATTER_PTR formatter)
{
    return formatter != NULL && format_is_simple(formatter_format(formatter));
}

int formatContainsPointers(FORMATTER_PTR formatter)
{
    return formatter != NULL && !format_is_flat(formatter_format(formatter));
}
