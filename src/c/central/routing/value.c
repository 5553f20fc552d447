/*
 * Values of variables.
 */
#include "central/routing/value.h"

#include "base/error.h"
#include "central/routing/own_request.h"
#include "central/routing/watch.h"

int value_set(struct server *server, struct variable *variable, const uint8_t *bytes, size_t length,
              enum byte_order order)
{
    struct block *value = block_copy(bytes, length);
    if (value == NULL) {
        return ERR_MEMORY;
    }
    block_unref(variable->value);
    variable->value = value;
    variable->order = (uint8_t)order;
    watch_changed(server, variable);
    return 0;
}

void value_set_own(struct server *server, struct variable *variable, const void *value)
{
    struct buffer data;
    buffer_init(&data);
    if (payload_encode(variable->format, value, &data) == 0) {
        struct dispatch *request =
            own_request_begin(server, variable_message(variable, MESSAGE_SET), &data);
        /* Without memory the old value stays, and those who watch are told of the next one. */
        (void)value_set(server, variable, data.bytes, data.length, byte_order_of_host());
        own_request_end(server, request);
    }
    buffer_fini(&data);
}
