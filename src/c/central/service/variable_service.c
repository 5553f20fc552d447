/*
 * Requests about variables.
 */
#include "central/service/variable_service.h"

#include <stdlib.h>

#include "central/routing/answer.h"
#include "central/routing/ending.h"
#include "central/service/services.h"
#include "central/routing/value.h"

/* Whether the frame's data are a value of that format, all of them. */
static bool is_value(const struct format *format, const struct frame *frame)
{
    const struct format_source source = {frame->data, frame->data_length,
                                         (enum byte_order)frame->data_order};
    void *value = NULL;
    size_t used = 0;
    if (format_decode_new(format, &source, &value, &used) != 0) {
        return false;
    }
    (void)format_release(format, value); /* fails for illegal formats only */
    free(value);
    return used == frame->data_length;
}

/* The request may have been answered, and so be over, before. */
static void set(const struct request *request, struct variable *variable, const struct frame *frame)
{
    if (value_set(request->server, variable, frame->data, frame->data_length,
                  (enum byte_order)frame->data_order) != 0) {
        log_warning(&request->server->log, request->module, "there is no memory to set %s",
                    variable->name);
    }
}

static void get(struct request *request, const struct variable *variable)
{
    struct dispatch *dispatch = request_keep(request);
    if (variable->value == NULL) {
        answer(request->server, dispatch, NULL);
    } else {
        answer_encoded(request->server, dispatch, variable->value->bytes, variable->value->length,
                       (enum byte_order)variable->order);
    }
}

void variable_service(struct request *request, const struct frame *frame)
{
    const struct message *message = request->dispatch->message;
    struct variable *variable = message->variable;
    const bool sets = message->kind != MESSAGE_GET;
    const bool fits = sets ? is_value(variable->format, frame) : frame->data_length == 0;
    if (!fits) {
        ending_for_violation(request->server, request->module,
                             "the data to set or get a variable do not fit its format");
        return;
    }
    if (sets && variable->of_server) {
        request_ignore(request, "the variable belongs to the server");
        return;
    }
    if (message->kind != MESSAGE_SET) {
        get(request, variable);
    }
    if (sets) {
        set(request, variable, frame);
    }
}

/* Whether a module may register that name; if not, the log says why. */
static bool may_register(const struct request *request, const char *name)
{
    const struct variable *variable = variable_find(request->server, name);
    if (variable != NULL && variable->of_server) {
        request_ignore(request, "the variable %s belongs to the server", name);
        return false;
    }
    return true;
}

void service_register_variable(struct request *request)
{
    const struct two_names *wanted = &request->payload->names;
    struct format *format = NULL;
    if (!request_names(request, wanted->first) || !may_register(request, wanted->first)) {
        return;
    }
    if (wanted->second == NULL ||
        format_parse(wanted->second, request->server->names, &format, NULL) != 0) {
        request_ignore(request, "the format of %s is bad", wanted->first);
        return;
    }
    const struct variable *before = variable_find(request->server, wanted->first);
    if (before != NULL && format_equal(before->format, format)) {
        format_unref(format); /* registered already: the value stays */
        return;
    }
    if (before != NULL) {
        log_warning(&request->server->log, request->module,
                    "the variable %s gets another format and loses its value", before->name);
    }
    if (variable_define(request->server, wanted->first, format) == NULL) {
        request_ignore(request, "%s cannot be a variable", wanted->first);
    }
    format_unref(format);
}
