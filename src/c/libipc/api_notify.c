/*
 * API: notifications and queue control [manual 4.39 to 4.48].
 */
#include "libipc/api.h"
#include "libipc/exchange.h"
#include "libipc/notify.h"
#include "libipc/queue.h"

/* -------------------------------------------------------------------- modules */

static IPC_RETURN_TYPE subscribe(enum module_event event, CONNECT_HANDLE_TYPE handler,
                                 void *clientData)
{
    struct api api;
    if (handler == NULL) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = notify_add(api.context, event, handler, clientData);
    }
    return api_leave(&api, error);
}

static IPC_RETURN_TYPE unsubscribe(enum module_event event, CONNECT_HANDLE_TYPE handler)
{
    struct api api;
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = notify_remove(api.context, event, handler);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_subscribeConnect(CONNECT_HANDLE_TYPE handler, void *clientData)
{
    return subscribe(MODULE_CONNECTS, handler, clientData);
}

IPC_RETURN_TYPE IPC_subscribeDisconnect(CONNECT_HANDLE_TYPE handler, void *clientData)
{
    return subscribe(MODULE_DISCONNECTS, handler, clientData);
}

IPC_RETURN_TYPE IPC_unsubscribeConnect(CONNECT_HANDLE_TYPE handler)
{
    return unsubscribe(MODULE_CONNECTS, handler);
}

IPC_RETURN_TYPE IPC_unsubscribeDisconnect(CONNECT_HANDLE_TYPE handler)
{
    return unsubscribe(MODULE_DISCONNECTS, handler);
}

/* -------------------------------------------------------------- subscriptions */

IPC_RETURN_TYPE IPC_subscribeHandlerChange(const char *msgName, CHANGE_HANDLE_TYPE handler,
                                           void *clientData)
{
    struct api api;
    if (api_is_missing(msgName) || handler == NULL) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = notify_add_change(api.context, msgName, handler, clientData);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_unsubscribeHandlerChange(const char *msgName, CHANGE_HANDLE_TYPE handler)
{
    struct api api;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = notify_remove_change(api.context, msgName, handler);
    }
    return api_leave(&api, error);
}

int IPC_numHandlers(const char *msgName)
{
    struct api api;
    struct handler_list list = {0, NULL};
    if (api_is_missing(msgName)) {
        (void)report(IPC_Null_Argument);
        return -1;
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = exchange_ask(api.context, LM_HANDLERS, &msgName, &list);
    }
    const int count = list.count;
    if (error == IPC_No_Error) {
        (void)format_release(api.library->catalogue.reply[LM_HANDLERS], &list);
    }
    return api_leave(&api, error) == IPC_OK ? count : -1;
}

/* -------------------------------------------------------------- queue control */

IPC_RETURN_TYPE IPC_setCapacity(int capacity)
{
    struct api api;
    if (capacity < 1) {
        return report(IPC_Argument_Out_Of_Range);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = queue_set_capacity(api.context, capacity);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_setMsgQueueLength(const char *msgName, int queueLength)
{
    struct api api;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    if (queueLength < 1) {
        return report(IPC_Argument_Out_Of_Range);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = queue_set_limit(api.context, msgName, queueLength);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_setMsgPriority(const char *msgName, int priority)
{
    struct api api;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    if (priority < 0) {
        return report(IPC_Argument_Out_Of_Range);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = queue_set_priority(api.context, msgName, priority);
    }
    return api_leave(&api, error);
}
