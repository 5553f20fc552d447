/*
 * Notices of modules that come and go: ordinary publications of the server.
 */
#include "central/routing/notify.h"

#include "central/routing/route.h"

void notify(struct server *server, enum library_message which, const struct module *module)
{
    struct message *message = server->library[which];
    struct buffer data;
    struct frame frame;
    if (message->n_subscriptions == 0) {
        return;
    }
    buffer_init(&data);
    if (payload_encode(message->wire, &module->name, &data) == 0) {
        frame_init(&frame, CLASS_BROADCAST);
        frame.data = data.bytes;
        frame.data_length = (uint32_t)data.length;
        route_broadcast(server, NULL, &frame, message);
    }
    buffer_fini(&data);
}
