/*
 * Requests to tap messages.  Taps on single deliveries are accepted and never
 * fire.
 */
#include "central/service/request.h"

#include "central/service/services.h"
#include "central/routing/tap.h"

void service_tap_message(struct request *request)
{
    const struct tap *tap = &request->payload->tap;
    struct message *tapped = request_get_message(request, tap->tapped);
    struct message *listening = request_get_message(request, tap->listening);
    if (tapped == NULL || listening == NULL) {
        return;
    }
    if (tap->condition < TAP_WHEN_SENT || tap->condition > TAP_LAST_CONDITION) {
        request_ignore(request, "%d is no condition", tap->condition);
    } else if (message_is_internal(tapped) || message_is_internal(listening)) {
        request_ignore(request, "%s or %s belongs to the server", tapped->name, listening->name);
    } else if (tap_add(request->server, tapped, listening, tap->condition) != 0) {
        request_ignore(request, "%s has too many taps", tapped->name);
    }
}

void service_remove_tap(struct request *request)
{
    const struct tap *tap = &request->payload->tap;
    const struct message_registry *messages = &request->server->messages;
    if (!request_names(request, tap->tapped) || !request_names(request, tap->listening)) {
        return;
    }
    struct message *tapped = message_find(messages, tap->tapped);
    const struct message *listening = message_find(messages, tap->listening);
    if (tapped == NULL || listening == NULL ||
        tap_remove(request->server, tapped, listening, tap->condition) != 0) {
        request_ignore(request, "%s does not tap %s", tap->listening, tap->tapped);
    }
}

void service_tap_reference(struct request *request)
{
    request_ignore(request, "single deliveries cannot be tapped");
}

void service_find_tapped(struct request *request)
{
    request_answer(request, NULL);
}
