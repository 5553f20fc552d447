/*
 * Modules: one record per connection.
 */
#include "central/model/module.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

struct module *module_new(int fd, uint64_t now_ns)
{
    struct module *module = mem_new(sizeof *module);
    module->references = 1;
    module->state = MODULE_GREETED;
    module->name = mem_copy_string(MODULE_UNNAMED);
    module->host = mem_copy_string(MODULE_UNKNOWN_HOST);
    module->shown_fd = fd;
    module->accepted_ns = now_ns;
    module->direct_port = NO_PORT;
    link_init(&module->link, fd, FROM_MODULE);
    list_init(&module->in_server);
    list_init(&module->in_state);
    list_init(&module->same_name);
    list_init(&module->in_condemned);
    list_init(&module->in_input);
    list_init(&module->in_waiting_for);
    list_init(&module->in_flush);
    list_init(&module->resources);
    list_init(&module->due);
    list_init(&module->in_due);
    list_init(&module->held);
    table_init(&module->handlers, TABLE_FOLDING);
    table_init(&module->provides, TABLE_FOLDING);
    table_init(&module->needs, TABLE_FOLDING);
    return module;
}

void module_enter(struct module *module, enum module_state state)
{
    assert(state > module->state); /* it only goes forward */
    module->state = state;
}

void module_introduce(struct module *module, const char *name, const char *host,
                      struct pending_pool *pool)
{
    free(module->name);
    free(module->host);
    module->name = mem_copy_string(name);
    module->host = mem_copy_string(host);
    module->own = resource_new(name, module, 1, pool);
    list_append(&module->resources, &module->own->in_owner);
    module->n_resources = 1;
    module_enter(module, MODULE_INTRODUCED);
}

void module_drop_later(struct module *module)
{
    if (module->later != NULL) {
        link_fini(module->later);
        free(module->later);
        module->later = NULL;
    }
}

struct module *module_ref(struct module *module)
{
    module->references++;
    return module;
}

void module_unref(struct module *module)
{
    if (module == NULL || --module->references > 0) {
        return;
    }
    assert(module->state == MODULE_ENDED);
    free(module->name);
    free(module->host);
    free(module);
}

struct resource *module_find_resource(const struct module *module, const char *name)
{
    struct list *at, *following;
    LIST_EACH (at, following, &module->resources) {
        struct resource *resource = LIST_OWNER(at, struct resource, in_owner);
        if (table_same_name(TABLE_FOLDING, resource->name, name)) {
            return resource;
        }
    }
    return NULL;
}
