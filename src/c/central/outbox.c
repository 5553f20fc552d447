/*
 * The way out.
 */
#include "central/outbox.h"

static void remember(struct server *server, struct module *module, enum outbox_urgency urgency)
{
    if (urgency == OUTBOX_FIRST && !module->urgent) {
        module->urgent = true;
        list_remove(&module->in_flush);
        list_append(&server->urgent, &module->in_flush);
    } else if (list_is_empty(&module->in_flush)) {
        list_append(&server->flush, &module->in_flush);
    }
}

static bool is_reachable(const struct module *module)
{
    return module->state != MODULE_ENDED && !module->deaf;
}

void outbox_attend(struct server *server, struct module *module)
{
    remember(server, module, OUTBOX_NORMAL);
}

void outbox_queue(struct server *server, struct module *module, const struct frame *frame,
                  enum outbox_urgency urgency)
{
    if (urgency == OUTBOX_NORMAL && !list_is_empty(&server->urgent) && server->write_news != NULL) {
        server->write_news(server, server->news_context);
    }
    if (is_reachable(module)) {
        link_queue(&module->link, frame);
        remember(server, module, urgency);
    }
}

void outbox_queue_raw(struct server *server, struct module *module, const void *bytes, size_t count)
{
    if (is_reachable(module)) {
        link_queue_raw(&module->link, bytes, count);
        remember(server, module, OUTBOX_NORMAL);
    }
}

bool outbox_has_room(const struct server *server, struct module *module)
{
    if (link_waiting(&module->link) < server->options->limits.out_queue) {
        return true;
    }
    module->wants_room = true;
    return false;
}
