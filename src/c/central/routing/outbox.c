/*
 * The way out.
 */
#include "central/routing/outbox.h"

#include "base/memory.h"

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

/* Where frames wait while they are held. */
static struct link *later_link(struct module *module)
{
    if (module->later == NULL) {
        module->later = mem_new(sizeof *module->later);
        link_init(module->later, -1, FROM_MODULE);
    }
    return module->later;
}

void outbox_queue(struct server *server, struct module *module, const struct frame *frame,
                  enum outbox_urgency urgency)
{
    if (is_reachable(module)) {
        const bool is_held = server->holding && urgency == OUTBOX_NORMAL;
        link_queue(is_held ? later_link(module) : &module->link, frame);
        remember(server, module, urgency);
    }
}

static void let_go_of(const struct list *modules)
{
    for (const struct list *at = modules->next; at != modules; at = at->next) {
        struct module *module = LIST_OWNER(at, struct module, in_flush);
        if (module->later != NULL) {
            link_take_over(&module->link, module->later);
            module_drop_later(module);
        }
    }
}

void outbox_let_go(struct server *server)
{
    if (server->holding) {
        server->holding = false;
        let_go_of(&server->urgent);
        let_go_of(&server->flush);
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
    const uint64_t held = module->later == NULL ? 0 : link_waiting(module->later);
    if (link_waiting(&module->link) + held < server->options->limits.out_queue) {
        return true;
    }
    module->wants_room = true;
    return false;
}
