/*
 * What those who carry out requests of modules have in common.
 */
#include "central/service/request.h"

#include <string.h>

#include "central/routing/answer.h"

void request_answer(struct request *request, const void *value)
{
    request->settled = true;
    answer(request->server, request->dispatch, value);
}

struct dispatch *request_keep(struct request *request)
{
    request->settled = true;
    return request->dispatch;
}

void request_ignore(const struct request *request, const char *format, ...)
{
    struct buffer reason;
    va_list arguments;
    buffer_init(&reason);
    va_start(arguments, format);
    text_append_list(&reason, format, arguments);
    va_end(arguments);
    log_warning(&request->server->log, request->module, "%s ignored: %.*s",
                request->dispatch->message->name, (int)reason.length, (const char *)reason.bytes);
    buffer_fini(&reason);
}

bool request_names(const struct request *request, const char *name)
{
    if (name == NULL || name[0] == '\0') {
        request_ignore(request, "a name is missing");
        return false;
    }
    if (strlen(name) > LIMIT_NAME) {
        request_ignore(request, "a name is longer than %u bytes", LIMIT_NAME);
        return false;
    }
    return true;
}

struct message *request_get_message(const struct request *request, const char *name)
{
    struct message *message = NULL;
    if (request_names(request, name)) {
        message = message_get(&request->server->messages, name);
        if (message == NULL) {
            request_ignore(request, "there are too many messages");
        }
    }
    return message;
}
