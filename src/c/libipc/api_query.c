/*
 * API: queries and responses [manual 5].
 */
#include <stdlib.h>

#include "libipc/api.h"
#include "libipc/compat.h"
#include "libipc/formatter.h"
#include "libipc/known_arrays.h"
#include "libipc/publish.h"
#include "libipc/query.h"
#include "libipc/registry.h"

/* ------------------------------------------------------------------ answering */

IPC_RETURN_TYPE IPC_respond(MSG_INSTANCE msgInstance, const char *msgName, unsigned int length,
                            BYTE_ARRAY content)
{
    struct api api;
    if (api_is_missing(msgName) || msgInstance == NULL) {
        return report(IPC_Null_Argument);
    }
    (void)api_enter_live(&api); /* the instance's context counts, not the current one */
    IPC_ERROR_TYPE error = context_any_live(api.library) ? IPC_No_Error : IPC_Not_Connected;
    if (error == IPC_No_Error) {
        error = query_respond(api.library, msgInstance, msgName, length, content);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_respondVC(MSG_INSTANCE msgInstance, const char *msgName,
                              IPC_VARCONTENT_PTR varcontent)
{
    if (varcontent == NULL) {
        return report(IPC_Null_Argument);
    }
    return IPC_respond(msgInstance, msgName, varcontent->length, varcontent->content);
}

static IPC_ERROR_TYPE respond_data(struct api *api, MSG_INSTANCE handle, const char *name,
                                   const void *data)
{
    struct message *message;
    struct encoded encoded;
    const struct instance *instance = instance_find(api->library, handle);
    if (instance == NULL) {
        return IPC_Argument_Out_Of_Range;
    }
    IPC_ERROR_TYPE error = registry_find(instance->context, name, true, &message);
    if (error != IPC_No_Error) {
        return error;
    }
    error = publish_encode(api->library, message->content, data, &encoded);
    if (error == IPC_No_Error) {
        error = query_respond(api->library, handle, name, (unsigned int)encoded.length,
                              encoded.content);
    }
    publish_release(api->library, &encoded);
    return error;
}

IPC_RETURN_TYPE IPC_respondData(MSG_INSTANCE msgInstance, const char *msgName, void *dataptr)
{
    struct api api;
    if (api_is_missing(msgName) || msgInstance == NULL) {
        return report(IPC_Null_Argument);
    }
    (void)api_enter_live(&api); /* the instance's context counts, not the current one */
    IPC_ERROR_TYPE error = context_any_live(api.library) ? IPC_No_Error : IPC_Not_Connected;
    if (error == IPC_No_Error) {
        error = respond_data(&api, msgInstance, msgName, dataptr);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_delayResponse(MSG_INSTANCE msgInstance)
{
    if (msgInstance == NULL) {
        return report(IPC_Null_Argument);
    }
    struct library *library = library_enter();
    const IPC_ERROR_TYPE error = query_delay(library, msgInstance);
    library_leave(library);
    return report(error);
}

/* ------------------------------------------------------- asking without waiting */

IPC_RETURN_TYPE IPC_queryNotify(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                HANDLER_TYPE handler, void *clientData)
{
    struct api api;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = query_notify(api.context, msgName, length, content, handler, clientData);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_queryNotifyVC(const char *msgName, IPC_VARCONTENT_PTR varcontent,
                                  HANDLER_TYPE handler, void *clientData)
{
    if (varcontent == NULL) {
        return report(IPC_Null_Argument);
    }
    return IPC_queryNotify(msgName, varcontent->length, varcontent->content, handler, clientData);
}

/* The message's data in its wire form, to be given back with publish_release. */
static IPC_ERROR_TYPE encode_for(struct api *api, const char *name, const void *data,
                                 struct encoded *encoded)
{
    struct message *message;
    IPC_ERROR_TYPE error = registry_find(api->context, name, true, &message);
    if (error != IPC_No_Error) {
        encoded->buffer.bytes = NULL;
        return error;
    }
    error = publish_encode(api->library, message->content, data, encoded);
    return error == IPC_No_Error && !context_is_live(api->context) ? IPC_Not_Connected : error;
}

IPC_RETURN_TYPE IPC_queryNotifyData(const char *msgName, void *dataptr, HANDLER_TYPE handler,
                                    void *clientData)
{
    struct api api;
    struct encoded encoded;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter_to_marshall(&api);
    if (error != IPC_No_Error) {
        return api_leave(&api, error);
    }
    error = encode_for(&api, msgName, dataptr, &encoded);
    if (error == IPC_No_Error) {
        error = query_notify(api.context, msgName, (unsigned int)encoded.length, encoded.content,
                             handler, clientData);
    }
    publish_release(api.library, &encoded);
    return api_leave(&api, error);
}

/* ---------------------------------------------------------- asking and waiting */

IPC_RETURN_TYPE _IPC_queryResponse(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                   BYTE_ARRAY *replyHandle, FORMATTER_PTR *replyFormatter,
                                   unsigned int timeoutMsecs)
{
    struct api api;
    struct response response = {NULL, 0, ORDER_LITTLE, NULL};
    bool timed_out = false;
    if (replyHandle != NULL) {
        *replyHandle = NULL;
    }
    if (api_is_missing(msgName) || replyHandle == NULL) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = query_response(api.context, msgName, length, content, timeoutMsecs, &response,
                               &timed_out);
    }
    if (error == IPC_No_Error && !timed_out) {
        *replyHandle = response.content;
        if (response.content != NULL) {
            const struct array_mark mark =
                known_arrays_mark(response.content, response.length, response.order);
            known_arrays_add(api.library, &mark);
        }
        if (replyFormatter != NULL) {
            *replyFormatter = formatter_of(response.message->content);
        }
    }
    const IPC_RETURN_TYPE result = api_leave(&api, error);
    return result == IPC_OK && timed_out ? IPC_Timeout : result;
}

IPC_RETURN_TYPE IPC_queryResponse(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                  BYTE_ARRAY *replyHandle, unsigned int timeoutMsecs)
{
    return _IPC_queryResponse(msgName, length, content, replyHandle, NULL, timeoutMsecs);
}

IPC_RETURN_TYPE IPC_queryResponseVC(const char *msgName, IPC_VARCONTENT_PTR varcontent,
                                    BYTE_ARRAY *replyHandle, unsigned int timeoutMsecs)
{
    if (varcontent == NULL) {
        return report(IPC_Null_Argument);
    }
    return IPC_queryResponse(msgName, varcontent->length, varcontent->content, replyHandle,
                             timeoutMsecs);
}

/* Turns the response's bytes into data, or leaves them as they are where there is no format. */
static IPC_ERROR_TYPE decode_response(struct response *response, void **data)
{
    const struct format *format = response->message->content;
    const struct format_source source = {response->content, response->length, response->order};
    if (response->content == NULL) {
        return IPC_No_Error;
    }
    if (format == NULL) {
        *data = response->content;
        response->content = NULL;
        return IPC_No_Error;
    }
    if (format_is_bad(format)) {
        return IPC_Illegal_Formatter;
    }
    return format_decode_new(format, &source, data, NULL) == 0 ? IPC_No_Error
                                                               : IPC_Wrong_Buffer_Length;
}

static IPC_ERROR_TYPE query_data(struct api *api, const char *name, const void *data,
                                 unsigned int timeout_ms, void **reply, bool *timed_out)
{
    struct encoded encoded;
    struct response response = {NULL, 0, ORDER_LITTLE, NULL};
    IPC_ERROR_TYPE error = encode_for(api, name, data, &encoded);
    if (error == IPC_No_Error) {
        error = query_response(api->context, name, (unsigned int)encoded.length, encoded.content,
                               timeout_ms, &response, timed_out);
    }
    publish_release(api->library, &encoded);
    if (error == IPC_No_Error && !*timed_out) {
        error = decode_response(&response, reply);
    }
    free(response.content);
    return error;
}

IPC_RETURN_TYPE IPC_queryResponseData(const char *msgName, void *dataptr, void **replyData,
                                      unsigned int timeoutMsecs)
{
    struct api api;
    bool timed_out = false;
    if (replyData != NULL) {
        *replyData = NULL;
    }
    if (api_is_missing(msgName) || replyData == NULL) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter_to_marshall(&api);
    if (error == IPC_No_Error) {
        error = query_data(&api, msgName, dataptr, timeoutMsecs, replyData, &timed_out);
    }
    const IPC_RETURN_TYPE result = api_leave(&api, error);
    return result == IPC_OK && timed_out ? IPC_Timeout : result;
}
