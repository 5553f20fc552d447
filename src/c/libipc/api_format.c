/*
 * API: formats and marshalling [manual 6].
 */
#include <stdio.h>
#include <stdlib.h>

#include "base/error.h"
#include "libipc/api.h"
#include "libipc/define.h"
#include "libipc/formatter.h"
#include "libipc/known_arrays.h"
#include "libipc/registry.h"

/* Whether the library is initialised and the formatter (may be NULL) is a legal one. */
static IPC_ERROR_TYPE check(const struct format *format)
{
    struct library *library = library_enter();
    const bool ready = library->initialised;
    library_leave(library);
    if (!ready) {
        return IPC_Not_Initialized;
    }
    return format != NULL && format_is_bad(format) ? IPC_Illegal_Formatter : IPC_No_Error;
}

/* Decoding has one complaint: the bytes are not what the format says. */
static IPC_ERROR_TYPE decoding_error(int error)
{
    return error == 0            ? IPC_No_Error
           : error == ERR_FORMAT ? IPC_Illegal_Formatter
                                 : IPC_Wrong_Buffer_Length;
}

/* ----------------------------------------------------------------- formatters */

FORMATTER_PTR IPC_parseFormat(const char *formatString)
{
    struct api api;
    struct format *format = NULL;
    IPC_ERROR_TYPE error = IPC_No_Error;
    if (api_is_missing(formatString)) {
        return NULL;
    }
    (void)api_enter(&api); /* a connection helps with unknown names, no more */
    if (!api.library->initialised) {
        error = IPC_Not_Initialized;
    } else if (formatter_parse(api.library, formatString, &format) != FORMATTER_OK) {
        error = IPC_Illegal_Formatter;
    }
    return api_leave(&api, error) == IPC_OK ? formatter_of(format) : NULL;
}

IPC_RETURN_TYPE IPC_defineFormat(const char *formatName, const char *formatString)
{
    struct api api;
    if (api_is_missing(formatName)) {
        return report(IPC_Null_Argument);
    }
    (void)api_enter(&api); /* without a connection the definition stays local */
    IPC_ERROR_TYPE error = IPC_Not_Connected;
    if (api.library->initialised) {
        error = formatString == NULL
                    ? IPC_Null_Argument
                    : define_format(api.library, api.context, formatName, formatString);
    }
    return api_leave(&api, error);
}

IPC_RETURN_TYPE IPC_checkMsgFormats(const char *msgName, const char *formatString)
{
    struct api api;
    struct message *message;
    struct format *format;
    if (api_is_missing(msgName)) {
        return report(IPC_Null_Argument);
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = registry_find(api.context, msgName, true, &message);
    }
    if (error == IPC_No_Error &&
        (formatter_parse(api.library, formatString, &format) != FORMATTER_OK ||
         !format_equal(format, message->content))) {
        error = IPC_Mismatched_Formatter;
    }
    return api_leave(&api, error);
}

FORMATTER_PTR IPC_msgFormatter(const char *msgName)
{
    struct api api;
    struct message *message = NULL;
    if (api_is_missing(msgName)) {
        (void)report(IPC_Null_Argument);
        return NULL;
    }
    IPC_ERROR_TYPE error = api_enter(&api);
    if (error == IPC_No_Error) {
        error = registry_find(api.context, msgName, true, &message);
    }
    const struct format *format = error == IPC_No_Error ? message->content : NULL;
    if (format != NULL && format_is_bad(format)) {
        error = IPC_Illegal_Formatter;
    }
    return api_leave(&api, error) == IPC_OK ? formatter_of(format) : NULL;
}

/* ----------------------------------------------------------------- marshalling */

IPC_RETURN_TYPE IPC_marshall(FORMATTER_PTR formatter, void *dataptr, IPC_VARCONTENT_PTR varcontent)
{
    const struct format *format = formatter_format(formatter);
    struct buffer bytes;
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error || varcontent == NULL) {
        return report(error != IPC_No_Error ? error : IPC_Null_Argument);
    }
    varcontent->length = 0;
    varcontent->content = NULL;
    if (format == NULL || (dataptr == NULL && format_size(format) == 0)) {
        return IPC_OK;
    }
    if (dataptr == NULL) {
        return report(IPC_Null_Argument);
    }
    buffer_init(&bytes);
    const int failure = format_encode(format, dataptr, byte_order_of_host(), &bytes);
    if (failure != 0 || bytes.length == 0) {
        buffer_fini(&bytes);
        return report(report_code(failure));
    }
    varcontent->length = (unsigned int)bytes.length;
    varcontent->content = buffer_take(&bytes, NULL);
    return IPC_OK;
}

static struct format_source source_of(BYTE_ARRAY bytes)
{
    struct library *library = library_enter();
    const struct format_source source = known_arrays_find(library, bytes);
    library_leave(library);
    return source;
}

IPC_RETURN_TYPE IPC_unmarshall(FORMATTER_PTR formatter, BYTE_ARRAY byteArray, void **dataHandle)
{
    const struct format *format = formatter_format(formatter);
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error || dataHandle == NULL) {
        return report(error != IPC_No_Error ? error : IPC_Null_Argument);
    }
    *dataHandle = NULL;
    if (format == NULL || format_size(format) == 0) {
        return IPC_OK;
    }
    if (byteArray == NULL) {
        return report(IPC_Null_Argument);
    }
    const struct format_source source = source_of(byteArray);
    return report(decoding_error(format_decode_new(format, &source, dataHandle, NULL)));
}

IPC_RETURN_TYPE IPC_unmarshallData(FORMATTER_PTR formatter, BYTE_ARRAY byteArray, void *dataHandle,
                                   int dataSize)
{
    const struct format *format = formatter_format(formatter);
    if (format == NULL) {
        return report(IPC_Null_Argument);
    }
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error) {
        return report(error);
    }
    if (dataSize < 0 || (size_t)dataSize != format_size(format)) {
        return report(IPC_Wrong_Buffer_Length);
    }
    if (dataHandle == NULL || (byteArray == NULL && dataSize > 0)) {
        return report(IPC_Null_Argument);
    }
    const struct format_source source = source_of(byteArray);
    return report(decoding_error(format_decode(format, &source, dataHandle, NULL)));
}

/* -------------------------------------------------------------------- freeing */

void IPC_freeByteArray(BYTE_ARRAY byteArray)
{
    if (byteArray != NULL) {
        struct library *library = library_enter();
        known_arrays_remove(library, byteArray);
        library_leave(library);
        free(byteArray);
    }
}

IPC_RETURN_TYPE IPC_freeDataElements(FORMATTER_PTR formatter, void *dataptr)
{
    const struct format *format = formatter_format(formatter);
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error) {
        return report(error);
    }
    if (format == NULL && dataptr == NULL) {
        return IPC_OK;
    }
    if (format == NULL || dataptr == NULL) {
        return report(IPC_Null_Argument);
    }
    return report(report_code(format_release(format, dataptr)));
}

IPC_RETURN_TYPE IPC_freeData(FORMATTER_PTR formatter, void *dataptr)
{
    const IPC_RETURN_TYPE result = IPC_freeDataElements(formatter, dataptr);
    if (result == IPC_OK) {
        free(dataptr);
    }
    return result;
}

/* ---------------------------------------------------------- printing, reading */

IPC_RETURN_TYPE IPC_printData(FORMATTER_PTR formatter, FILE *stream, void *dataptr)
{
    const struct format *format = formatter_format(formatter);
    struct buffer text;
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error) {
        return report(error);
    }
    if (stream == NULL || (format == NULL) != (dataptr == NULL)) {
        return report(IPC_Null_Argument);
    }
    if (format == NULL) {
        fputs("NULL\n", stream);
        return IPC_OK;
    }
    buffer_init(&text);
    const int failure = format_print(format, dataptr, 0, &text);
    if (failure == 0 && text.length > 0) {
        fwrite(text.bytes, 1, text.length, stream);
    }
    buffer_fini(&text);
    return report(report_code(failure));
}

static IPC_ERROR_TYPE read_value(const struct format *format, FILE *stream, void **value)
{
    const size_t size = format_size(format);
    void *block = malloc(size > 0 ? size : 1);
    if (block == NULL) {
        return IPC_Argument_Out_Of_Range;
    }
    if (format_read(format, stream, block) != 0) {
        free(block);
        return IPC_Mismatched_Formatter;
    }
    *value = block;
    return IPC_No_Error;
}

IPC_RETURN_TYPE IPC_readData(FORMATTER_PTR formatter, FILE *stream, void **dataHandle)
{
    const struct format *format = formatter_format(formatter);
    if (dataHandle != NULL) {
        *dataHandle = NULL;
    }
    const IPC_ERROR_TYPE error = check(format);
    if (error != IPC_No_Error) {
        return report(error);
    }
    if (stream == NULL || dataHandle == NULL) {
        return report(IPC_Null_Argument);
    }
    return report(format != NULL ? read_value(format, stream, dataHandle) : IPC_No_Error);
}
