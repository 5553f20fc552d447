/*
 * API: defining, publishing and subscribing; message instances [manual 4.20 to 4.31].
 */
#include <stdlib.h>
#include <string.h>

#include "base/limits.h"
#include "libipc/api.h"
#include "libipc/compat.h"
#include "libipc/define.h"
#include "libipc/formatter.h"
#include "libipc/instance.h"
#include "libipc/publish.h"
#include "libipc/registry.h"
#include "libipc/subscription.h"

static IPC_ERROR_TYPE check_name(const char *name)
{
    if (api_is_missing(name)) {
        return IPC_Null_Argument;
    }
    return strlen(name) <= LIMIT_NAME ? IPC_No_Error : IPC_Argument_Out_Of_Range;
}

/* ------------------------------------------------------------------- messages */

IPC_RETURN_TYPE IPC_defineMsg(const char *msgName, unsigned int length, const char *formatString)
{
    struct api api;
    IPC_ERROR_TYPE error = check_name(msgName);
    if (error != IPC_No_Error) {
        return report(error);
    }
    error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = define_message(api.context, msgName, length, formatString);
    }
    return api_leave(&api, error);
}

int IPC_isMsgDefined(const char *msgName)
{
    struct api api;
    struct message *message;
    if (api_is_missing(msgName)) {
        (void)report(IPC_Null_Argument);
        return 0;
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = registry_find(api.context, msgName, false, &message);
    }
    if (error == IPC_Message_Not_Defined) {
        (void)api_leave(&api, IPC_No_Error); /* an answer, not an error */
        return 0;
    }
    return api_leave(&api, error) == IPC_OK;
}

/* ----------------------------------------------------------------- publishing */

IPC_RETURN_TYPE IPC_publish(const char *msgName, unsigned int length, BYTE_ARRAY content)
{
    struct api api;
    struct message *message;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = registry_find(api.context, msgName, true, &message);
    }
    if (error == IPC_No_Error) {
        error = publish(api.context, message, length, content);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_publishVC(const char *msgName, IPC_VARCONTENT_PTR varcontent)
{
    if (api_is_missing(msgName) || varcontent == NULL) {
        return report(IPC_Null_Argument);
    }
    return IPC_publish(msgName, varcontent->length, varcontent->content);
}

IPC_RETURN_TYPE IPC_publishFixed(const char *msgName, BYTE_ARRAY content)
{
    return IPC_publish(msgName, IPC_FIXED_LENGTH, content);
}

static IPC_ERROR_TYPE publish_data(struct api *api, const char *name, const void *data)
{
    struct message *message;
    struct encoded encoded;
    IPC_ERROR_TYPE error = registry_find(api->context, name, true, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    error = publish_encode(api->library, message->content, data, &encoded);
    if (error == IPC_No_Error && !context_is_live(api->context)) {
        error = IPC_Not_Connected; /* and the message has gone with the connection */
    }
    if (error == IPC_No_Error) {
        error = publish(api->context, message, (unsigned int)encoded.length, encoded.content);
    }
    publish_release(api->library, &encoded);
    return error;
}

IPC_RETURN_TYPE IPC_publishData(const char *msgName, void *dataptr)
{
    struct api api;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter_to_marshall(&api);
    if (error == IPC_No_Error) {
        error = publish_data(&api, msgName, dataptr);
    }
    return api_leave(&api, error);
}

/* ---------------------------------------------------------------- subscribing */

IPC_RETURN_TYPE _IPC_subscribe(const char *msgName, const char *hndName, HANDLER_TYPE handler,
                               void *clientData, int autoUnmarshall)
{
    struct api api;
    IPC_ERROR_TYPE error = check_name(msgName);
    if (error == IPC_No_Error && (handler == NULL || api_is_missing(hndName))) {
        error = IPC_Null_Argument;
    }
    if (error != IPC_No_Error) {
        return report(error);
    }
    error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = subscription_add(api.context, msgName, hndName, handler, clientData,
                                 autoUnmarshall != 0);
    }
    return api_leave(&api, error);
}

static IPC_RETURN_TYPE subscribe(const char *msgName, HANDLER_TYPE handler, void *clientData,
                                 int autoUnmarshall)
{
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    char *name = subscription_name(msgName, handler);
    const IPC_RETURN_TYPE result =
        _IPC_subscribe(msgName, name, handler, clientData, autoUnmarshall);
    free(name);
    return result;
}

IPC_RETURN_TYPE IPC_subscribe(const char *msgName, HANDLER_TYPE handler, void *clientData)
{
    return subscribe(msgName, handler, clientData, 0);
}

IPC_RETURN_TYPE IPC_subscribeData(const char *msgName, HANDLER_DATA_TYPE handler, void *clientData)
{
    return subscribe(msgName, handler, clientData, 1);
}

IPC_RETURN_TYPE _IPC_unsubscribe(const char *msgName, const char *hndName)
{
    struct api api;
    if (api_is_missing(msgName) || api_is_missing(hndName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = subscription_remove(api.context, hndName);
    }
    return api_leave(&api, error);
}

static IPC_RETURN_TYPE unsubscribe_all(const char *msgName)
{
    struct api api;
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = subscription_remove_all(api.context, msgName);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_unsubscribe(const char *msgName, HANDLER_TYPE handler)
{
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    if (handler == NULL) {
        return unsubscribe_all(msgName);
    }
    char *name = subscription_name(msgName, handler);
    const IPC_RETURN_TYPE result = _IPC_unsubscribe(msgName, name);
    free(name);
    return result;
}

/* ------------------------------------------------------------------ instances */

/* The live instance behind the handle, or NULL with the error to report.  The lock is held. */
static struct instance *find_instance(const struct library *library, MSG_INSTANCE handle,
                                      IPC_ERROR_TYPE *error)
{
    struct instance *instance = handle != NULL ? instance_find(library, handle) : NULL;
    *error = handle == NULL     ? IPC_Null_Argument
             : instance == NULL ? IPC_Argument_Out_Of_Range
                                : IPC_No_Error;
    return instance;
}

const char *IPC_msgInstanceName(MSG_INSTANCE msgInstance)
{
    IPC_ERROR_TYPE error;
    struct library *library = library_enter();
    const struct instance *instance = find_instance(library, msgInstance, &error);
    const char *name = instance != NULL ? instance->message->name : NULL;
    library_leave(library);
    if (error == IPC_Argument_Out_Of_Range) {
        report_note("ERROR: x_ipcReferenceName: invalid x_ipc reference pointer.\n\n");
    }
    (void)report(error);
    return name;
}

unsigned int IPC_dataLength(MSG_INSTANCE msgInstance)
{
    IPC_ERROR_TYPE error;
    struct library *library = library_enter();
    const struct instance *instance = find_instance(library, msgInstance, &error);
    const unsigned int length = instance != NULL ? (unsigned int)instance->length : 0;
    library_leave(library);
    (void)report(error);
    return length;
}

FORMATTER_PTR IPC_msgInstanceFormatter(MSG_INSTANCE msgInstance)
{
    IPC_ERROR_TYPE error;
    struct library *library = library_enter();
    const struct instance *instance = find_instance(library, msgInstance, &error);
    const struct format *format = instance != NULL ? instance->message->content : NULL;
    if (format != NULL && format_is_bad(format)) {
        error = IPC_Illegal_Formatter;
    }
    library_leave(library);
    return report(error) == IPC_OK ? formatter_of(format) : NULL;
}
