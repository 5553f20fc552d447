/*
 * Requests and notices of modules to the server: the table, and the way of each
 * from the frame to its end.
 */
#include "central/service/service.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "central/routing/answer.h"
#include "central/routing/ending.h"
#include "central/service/request.h"
#include "central/service/services.h"
#include "central/service/variable_service.h"
#include "central/settings/version.h"

struct service_entry {
    bool early; /* before the introduction, too */
    void (*carry_out)(struct request *request);
};

static const struct service_entry services[LM_COUNT] = {
    [LM_MESSAGE_INFO] = {true, service_message_info},
    [LM_CLASS_INFO] = {true, service_class_info},
    [LM_INTRODUCTION] = {true, service_introduction},
    [LM_READY] = {false, service_ready},
    [LM_CLOSE] = {true, service_close},
    [LM_DEFINE_MESSAGE] = {false, service_define_message},
    [LM_SUBSCRIBE] = {false, service_subscribe},
    [LM_UNSUBSCRIBE] = {false, service_unsubscribe},
    [LM_DEFINE_FORMAT] = {false, service_define_format},
    [LM_GET_FORMAT] = {false, service_get_format},
    [LM_RESOURCE] = {false, service_resource},
    [LM_LIMIT_PENDING] = {false, service_limit_pending},
    [LM_PRIORITY] = {false, service_priority},
    [LM_IS_CONNECTED] = {false, service_is_connected},
    [LM_PROCESSES] = {false, service_processes},
    [LM_HANDLERS] = {false, service_handlers},
    [LM_WATCH_HANDLERS] = {false, service_watch_handlers},
    [LM_CONNECTED] = {false, NULL}, /* these two are the server's to publish */
    [LM_DISCONNECTED] = {false, NULL},
    [LM_DIRECT_PORT] = {false, service_direct_port},
    [LM_HANDLER_INFO] = {false, service_handler_info},
    [LM_MESSAGES] = {false, service_messages},
    [LM_MESSAGE_DETAILS] = {false, service_message_details},
    [LM_DIRECT_INFO] = {false, service_direct_info},
    [LM_PROVIDES] = {false, service_provides},
    [LM_REQUIRES] = {false, service_requires},
    [LM_AVAILABLE] = {false, service_available},
    [LM_IGNORE_LOGGING] = {false, service_ignore_logging},
    [LM_RESUME_LOGGING] = {false, service_resume_logging},
    [LM_ADD_TO_RESOURCE] = {false, service_add_to_resource},
    [LM_RESERVE] = {false, service_claim},
    [LM_RESERVE_OF_MODULE] = {false, service_claim_of_module},
    [LM_CANCEL_RESERVATION] = {false, service_give_back},
    [LM_LOCK] = {false, service_claim},
    [LM_LOCK_OF_MODULE] = {false, service_claim_of_module},
    [LM_UNLOCK] = {false, service_give_back},
    [LM_TAP_MESSAGE] = {false, service_tap_message},
    [LM_REMOVE_TAP] = {false, service_remove_tap},
    [LM_TAP_REFERENCE] = {false, service_tap_reference},
    [LM_FIND_TAPPED] = {false, service_find_tapped},
    [LM_REGISTER_VARIABLE] = {false, service_register_variable},
};

static bool is_early(const struct message *message)
{
    return message->kind == MESSAGE_SERVICE && services[message->service].early;
}

static void carry_out(struct request *request, const struct frame *frame)
{
    const struct message *message = request->dispatch->message;
    if (message->kind == MESSAGE_SERVICE) {
        services[message->service].carry_out(request);
    } else {
        variable_service(request, frame);
    }
}

/* With the payload decoded: the request as a dispatch, from its first log line to its last. */
static void perform(struct server *server, struct module *module, const struct frame *frame,
                    struct message *message, union payload *payload)
{
    struct dispatch *dispatch = dispatch_new(&server->dispatches, message, module, frame);
    struct request request = {server, module, dispatch, payload, false};
    dispatch->state = DISPATCH_SERVED;
    log_sent(&server->log, dispatch, SERVER_NAME);
    dispatch->data = NULL; /* the frame does not last as long as the dispatch may */
    dispatch->data_length = 0;
    carry_out(&request, frame);
    if (!request.settled) {
        answer_nothing(server, dispatch);
    }
}

/* Decodes the payload, performs, and releases the payload. */
static void decode_and_perform(struct server *server, struct module *module,
                               const struct frame *frame, struct message *message)
{
    union payload payload;
    const struct format *format = message->wire;
    char reason[160];
    assert(format_size(format) <= sizeof payload);
    memset(&payload, 0, sizeof payload);
    if (payload_decode(format, frame->data, frame->data_length, (enum byte_order)frame->data_order,
                       &payload) != 0) {
        (void)snprintf(reason, sizeof reason, "the data of %s do not fit its format",
                       message->name);
        ending_for_violation(server, module, reason);
        return;
    }
    perform(server, module, frame, message, &payload);
    if (format != NULL) {
        (void)format_release(format, &payload); /* fails for illegal formats only */
    }
}

void service(struct server *server, struct module *module, const struct frame *frame,
             struct message *message)
{
    if (module->state == MODULE_GREETED && !is_early(message)) {
        ending_for_violation(server, module, "a request comes before the introduction");
    } else if (message->kind == MESSAGE_SERVICE) {
        decode_and_perform(server, module, frame, message);
    } else {
        perform(server, module, frame, message, NULL); /* the value of a variable stays encoded */
    }
}
