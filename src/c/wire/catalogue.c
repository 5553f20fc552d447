/*
 * The table of the messages between library and central, and their codec.
 */
#include "wire/catalogue.h"

#include <string.h>

#include "base/error.h"
#include "base/table.h"

#define TWO_NAMES "{string, string}"
#define MESSAGE_INFO "*{int, string, int, format, format}"

const struct library_message_entry library_messages[LM_COUNT] = {
    [LM_MESSAGE_INFO] = {"x_ipc_msgInfoMsg", "msgInfoMsg", CLASS_QUERY, TWO_NAMES, MESSAGE_INFO,
                         false},
    [LM_CLASS_INFO] = {"x_ipc_classInfoMsg", "classInfoMsg", CLASS_QUERY, "int", "*{int, format}",
                       false},
    [LM_INTRODUCTION] = {"x_ipc_newModuleConnectMsg", "newModuleConnectMsg", CLASS_QUERY, TWO_NAMES,
                         "{{int, int}, boolean}", false},
    [LM_READY] = {"x_ipc_waitMsg", "waitMsg", CLASS_QUERY, NULL, "int", false},
    [LM_CLOSE] = {"x_ipc_CloseMsg", "x_ipcCloseMsg", CLASS_INFORM, NULL, NULL, false},
    [LM_DEFINE_MESSAGE] = {"x_ipc_registerMessageMsg", "registerMessageMsg", CLASS_INFORM,
                           "{string, int, string, string}", NULL, false},
    [LM_SUBSCRIBE] = {"x_ipc_registerHandlerMsg", "registerHandlerMsg", CLASS_INFORM,
                      "{int, string, string}", NULL, false},
    [LM_UNSUBSCRIBE] = {"x_ipc_deregisterHandlerMsg", "deregisterHandlerMsg", CLASS_INFORM,
                        "{int, string, string}", NULL, false},
    [LM_DEFINE_FORMAT] = {"x_ipc_registerNamedFormMsg", "registerNamedFormMsg", CLASS_INFORM,
                          TWO_NAMES, NULL, false},
    [LM_GET_FORMAT] = {"x_ipc_getNamedFormMsg", NULL, CLASS_QUERY, "string", "format", false},
    [LM_RESOURCE] = {"x_ipc_registerResourceMsg", "registerResourceMsg", CLASS_INFORM,
                     "{int, string}", NULL, false},
    [LM_LIMIT_PENDING] = {"x_ipc_limitPendingMsg", "limitPendingMsg", CLASS_INFORM,
                          "{string, string, int}", NULL, false},
    [LM_PRIORITY] = {"ipc_setMsgPriority", NULL, CLASS_INFORM, "{string, int}", NULL, true},
    [LM_IS_CONNECTED] = {"x_ipc_moduleConnectedQ", NULL, CLASS_QUERY, "string", "int", false},
    [LM_HANDLERS] = {"x_ipc_directMsgQuery", NULL, CLASS_QUERY, "string", FORMAT_HANDLER_LIST,
                     false},
    [LM_WATCH_HANDLERS] = {"x_ipc_notifyHandlerChange", NULL, CLASS_INFORM, "string", NULL, false},
    [LM_CONNECTED] = {"x_ipc_connectNotify", NULL, CLASS_BROADCAST, "string", NULL, false},
    [LM_DISCONNECTED] = {"x_ipc_disconnectNotify", NULL, CLASS_BROADCAST, "string", NULL, false},
    [LM_DIRECT_PORT] = {"x_ipc_directResMsg", "directResMsg", CLASS_INFORM, "{int, string}", NULL,
                        false},
    [LM_HANDLER_INFO] = {"x_ipc_hndInfoMsg", "hndInfoMsg", CLASS_QUERY, TWO_NAMES, TWO_NAMES,
                         false},
    [LM_MESSAGES] = {"x_ipc_getMessages", NULL, CLASS_QUERY, NULL, FORMAT_NAME_LIST, false},
    [LM_MESSAGE_DETAILS] = {"x_ipc_getMessageInfo", NULL, CLASS_QUERY, "{string}",
                            "{string, string, string, int, string, int}", true},
    [LM_DIRECT_INFO] = {"x_ipc_directInfoMsg", "directInfoMsg", CLASS_QUERY, "string",
                        "{int, int, int, int, string, string}", false},
    [LM_PROVIDES] = {"x_ipc_moduleProvides", NULL, CLASS_INFORM, FORMAT_NAME_LIST, NULL, false},
    [LM_REQUIRES] = {"x_ipc_moduleRequires", NULL, CLASS_INFORM, FORMAT_NAME_LIST, NULL, false},
    [LM_AVAILABLE] = {"x_ipc_available", NULL, CLASS_QUERY, NULL, FORMAT_NAME_LIST, false},
    [LM_IGNORE_LOGGING] = {"x_ipc_ignoreLogging", "ignoreLogging", CLASS_INFORM, "string", NULL,
                           false},
    [LM_RESUME_LOGGING] = {"x_ipc_resumeLogging", "resumeLogging", CLASS_INFORM, "string", NULL,
                           false},
    [LM_ADD_TO_RESOURCE] = {"x_ipc_addHndToResourceMsg", "addHndToResourceMsg", CLASS_INFORM,
                            TWO_NAMES, NULL, false},
    [LM_RESERVE] = {"x_ipc_reserveResourceMsg", NULL, CLASS_QUERY, "string", "int", true},
    [LM_RESERVE_OF_MODULE] = {"x_ipc_reserveModResourceMsg", "reserveModResourceMsg", CLASS_QUERY,
                              TWO_NAMES, "int", true},
    [LM_CANCEL_RESERVATION] = {"x_ipc_cancelReservationMsg", "cancelReservationMsg", CLASS_INFORM,
                               "int", NULL, true},
    [LM_LOCK] = {"x_ipc_lockResourceMsg", "lockResourceMsg", CLASS_QUERY, "string", "int", true},
    [LM_LOCK_OF_MODULE] = {"x_ipc_lockModResourceMsg", "lockModResourceMsg", CLASS_QUERY, TWO_NAMES,
                           "int", true},
    [LM_UNLOCK] = {"x_ipc_unlockResourceMsg", "unlockResourceMsg", CLASS_INFORM, "int", NULL, true},
    [LM_TAP_MESSAGE] = {"x_ipc_tapMessage", "tapMessage", CLASS_INFORM, "{int, string, string}",
                        NULL, false},
    [LM_REMOVE_TAP] = {"x_ipc_removeTap", "removeTap", CLASS_INFORM, "{int, string, string}", NULL,
                       false},
    [LM_TAP_REFERENCE] = {"x_ipc_tapReference", "tapReference", CLASS_INFORM,
                          "{int, X_IPC_REF_PTR, string}", NULL, false},
    [LM_FIND_TAPPED] = {"x_ipc_findTappedReference", "findTappedReference", CLASS_QUERY, "int",
                        "X_IPC_REF_PTR", false},
    [LM_REGISTER_VARIABLE] = {"x_ipc_registerGlobalVar", "registerGlobalVar", CLASS_INFORM,
                              TWO_NAMES, NULL, false},
    [LM_PROCESSES] = {"ipc_x_processes", NULL, CLASS_QUERY, "string", "{int, <{int, int}:1>}",
                      false},
};

static int compile(const char *text, struct format **format)
{
    *format = NULL;
    return text == NULL ? 0 : format_parse(text, NULL, format, NULL);
}

int catalogue_init(struct catalogue *catalogue)
{
    int error = 0;
    memset(catalogue, 0, sizeof *catalogue);
    for (int i = 0; i < LM_COUNT && error == 0; i++) {
        error = compile(library_messages[i].request, &catalogue->request[i]);
        if (error == 0) {
            error = compile(library_messages[i].reply, &catalogue->reply[i]);
        }
    }
    if (error == 0) {
        error = compile(FORMAT_NAME_LIST, &catalogue->name_list);
    }
    if (error == 0) {
        error = compile(FORMAT_HANDLER_LIST, &catalogue->handler_list);
    }
    if (error == 0) {
        error = compile(FORMAT_LOG_OPTIONS, &catalogue->log_options);
    }
    if (error != 0) {
        catalogue_fini(catalogue);
    }
    return error;
}

void catalogue_fini(struct catalogue *catalogue)
{
    for (int i = 0; i < LM_COUNT; i++) {
        format_unref(catalogue->request[i]);
        format_unref(catalogue->reply[i]);
    }
    format_unref(catalogue->name_list);
    format_unref(catalogue->handler_list);
    format_unref(catalogue->log_options);
    memset(catalogue, 0, sizeof *catalogue);
}

enum library_message catalogue_find(const char *name)
{
    for (int i = 0; i < LM_COUNT; i++) {
        const struct library_message_entry *entry = &library_messages[i];
        if (table_same_name(TABLE_FOLDING, name, entry->name) ||
            (entry->alias != NULL && table_same_name(TABLE_FOLDING, name, entry->alias))) {
            return (enum library_message)i;
        }
    }
    return LM_COUNT;
}

int payload_decode(const struct format *format, const uint8_t *bytes, size_t length,
                   enum byte_order order, void *value)
{
    const struct format_source source = {bytes, length, order};
    size_t used = 0;
    if (format == NULL) {
        return length == 0 ? 0 : ERR_CONTENT;
    }
    const int error = format_decode(format, &source, value, &used);
    if (error != 0) {
        return error;
    }
    if (used != length) {
        (void)format_release(format, value); /* the answer is ERR_CONTENT either way */
        return ERR_CONTENT;
    }
    return 0;
}

int payload_encode(const struct format *format, const void *value, struct buffer *out)
{
    return format == NULL ? 0 : format_encode(format, value, byte_order_of_host(), out);
}
