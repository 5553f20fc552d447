/*
 * The simplest routing there is.
 */
#include "routing_model.h"

#include "unit.h"

#include <string.h>

/* ---------------------------------------------------------------------- lists */

static void append(struct model_list *list, const struct model_item *item)
{
    assert_true(list->count < MODEL_ROOM);
    list->items[list->count++] = *item;
}

static struct model_item take_at(struct model_list *list, size_t i)
{
    const struct model_item item = list->items[i];
    list->count--;
    memmove(list->items + i, list->items + i + 1, (list->count - i) * sizeof *list->items);
    return item;
}

static size_t oldest_of(const struct model_list *list, int message)
{
    size_t i = 0;
    while (list->items[i].message != message) {
        i++;
    }
    return i;
}

static size_t count_of(const struct model_list *list, int message)
{
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        count += list->items[i].message == message;
    }
    return count;
}

/* --------------------------------------------------------------------- queues */

/* A turn of that message goes: its first one. */
static void remove_turn(struct model_module *module, int message)
{
    size_t i = 0;
    while (module->turns[i] != message) {
        i++;
    }
    memmove(module->turns + i, module->turns + i + 1,
            (module->waiting.count - i) * sizeof *module->turns);
}

static void insert_turn(const struct model *model, struct model_module *module, int message)
{
    const int priority = model->priorities[message];
    const size_t n_turns = module->waiting.count - 1; /* the new item is in the list already */
    size_t i = priority < 0 ? n_turns : 0;
    while (i < n_turns && model->priorities[module->turns[i]] >= priority) {
        i++;
    }
    memmove(module->turns + i + 1, module->turns + i, (n_turns - i) * sizeof *module->turns);
    module->turns[i] = message;
}

static void drop_oldest(struct model *model, struct model_module *module)
{
    remove_turn(module, take_at(&module->waiting, 0).message);
    model->n_dropped++;
}

static void put_in_queue(struct model *model, struct model_module *module,
                         const struct model_item *item)
{
    const int limit = module->limits[item->message];
    const bool keeps_oldest =
        model->policy == WHEN_FULL_OLDEST || model->policy == WHEN_FULL_DISCONNECT;
    if (keeps_oldest && module->waiting.count == model->most_waiting) {
        module->condemned = model->policy == WHEN_FULL_DISCONNECT;
        model->n_dropped++;
        return;
    }
    if (limit == 0 || module->limit == 0) {
        model->n_dropped++;
        return;
    }
    if (limit > 0 && count_of(&module->waiting, item->message) >= (size_t)limit) {
        (void)take_at(&module->waiting, oldest_of(&module->waiting, item->message));
        append(&module->waiting, item);
        model->n_dropped++;
        return;
    }
    if (module->limit > 0 && module->waiting.count >= (size_t)module->limit) {
        drop_oldest(model, module);
    }
    append(&module->waiting, item);
    insert_turn(model, module, item->message);
    while (module->waiting.count > model->most_waiting) {
        drop_oldest(model, module);
    }
}

static void deliver(struct model_module *module, const struct model_item *item)
{
    append(&module->active, item);
    append(&module->sent, item);
}

static bool has_room(const struct model_module *module)
{
    return module->active.count < (size_t)module->capacity;
}

static bool is_free(const struct model_module *module)
{
    return has_room(module) && module->waiting.count == 0;
}

static void release(struct model_module *module)
{
    while (has_room(module) && module->waiting.count > 0) {
        const int message = module->turns[0];
        const struct model_item item =
            take_at(&module->waiting, oldest_of(&module->waiting, message));
        memmove(module->turns, module->turns + 1, module->waiting.count * sizeof *module->turns);
        deliver(module, &item);
    }
}

static void enter(struct model *model, int to, const struct model_item *item)
{
    struct model_module *module = &model->modules[to];
    if (is_free(module)) {
        deliver(module, item);
    } else {
        put_in_queue(model, module, item);
    }
}

/* --------------------------------------------------------------------- events */

void model_init(struct model *model, enum when_full policy, size_t most_waiting)
{
    memset(model, 0, sizeof *model);
    model->policy = policy;
    model->most_waiting = most_waiting;
    for (int message = 0; message < MODEL_MESSAGES; message++) {
        model->priorities[message] = -1;
    }
}

void model_connect(struct model *model, int module)
{
    struct model_module *new = &model->modules[module];
    memset(new, 0, sizeof *new);
    new->connection = ++model->n_connections;
    new->capacity = 1;
    new->limit = -1;
    for (int message = 0; message < MODEL_MESSAGES; message++) {
        new->limits[message] = -1;
    }
}

static size_t find_subscription(const struct model *model, int module, int message, int handler)
{
    const struct model_subscription *subscriptions = model->subscriptions[message];
    size_t i = 0;
    while (i < model->n_subscriptions[message] &&
           (subscriptions[i].module != module || subscriptions[i].handler != handler)) {
        i++;
    }
    return i;
}

static void remove_subscription(struct model *model, int message, size_t i)
{
    struct model_subscription *subscriptions = model->subscriptions[message];
    const size_t left = --model->n_subscriptions[message] - i;
    memmove(subscriptions + i, subscriptions + i + 1, left * sizeof *subscriptions);
}

void model_disconnect(struct model *model, int module)
{
    for (int message = 0; message < MODEL_MESSAGES; message++) {
        for (size_t i = model->n_subscriptions[message]; i > 0; i--) {
            if (model->subscriptions[message][i - 1].module == module) {
                remove_subscription(model, message, i - 1);
            }
        }
    }
    model->modules[module].connection = 0;
    model->modules[module].condemned = false;
}

bool model_is_subscribed(const struct model *model, int module, int message, int handler)
{
    return find_subscription(model, module, message, handler) < model->n_subscriptions[message];
}

void model_subscribe(struct model *model, int module, int message, int handler)
{
    struct model_list *unhandled = &model->unhandled[message];
    struct model_subscription *new =
        &model->subscriptions[message][model->n_subscriptions[message]++];
    new->module = module;
    new->handler = handler;
    while (unhandled->count > 0) {
        struct model_item item = take_at(unhandled, 0);
        item.handler = handler;
        put_in_queue(model, &model->modules[module], &item);
    }
    release(&model->modules[module]);
}

void model_unsubscribe(struct model *model, int module, int message, int handler)
{
    remove_subscription(model, message, find_subscription(model, module, message, handler));
}

void model_set_capacity(struct model *model, int module, int capacity)
{
    model->modules[module].capacity = capacity < 1 ? 1 : capacity;
    release(&model->modules[module]);
}

void model_set_limit(struct model *model, int module, int message, int limit)
{
    model->modules[module].limits[message] = limit;
}

void model_set_limit_of_all(struct model *model, int module, int limit)
{
    model->modules[module].limit = limit;
}

void model_set_priority(struct model *model, int message, int priority)
{
    model->priorities[message] = priority;
}

void model_publish(struct model *model, int message, int number)
{
    for (size_t i = 0; i < model->n_subscriptions[message]; i++) {
        const struct model_subscription *to = &model->subscriptions[message][i];
        const struct model_item item = {
            .message = message, .number = number, .handler = to->handler};
        enter(model, to->module, &item);
    }
}

/* Of all handlers of a message the oldest that is free, else the oldest with the shortest queue. */
static const struct model_subscription *choose(const struct model *model, int message)
{
    const struct model_subscription *best = NULL;
    for (size_t i = 0; i < model->n_subscriptions[message]; i++) {
        const struct model_subscription *at = &model->subscriptions[message][i];
        const struct model_module *module = &model->modules[at->module];
        if (is_free(module)) {
            return at;
        }
        if (best == NULL || module->waiting.count < model->modules[best->module].waiting.count) {
            best = at;
        }
    }
    return best;
}

void model_query(struct model *model, int module, int message, int number, int reference)
{
    const struct model_subscription *to = choose(model, message);
    const struct model_item item = {.message = message,
                                    .number = number,
                                    .handler = to == NULL ? 0 : to->handler,
                                    .is_query = true,
                                    .asker = model->modules[module].connection,
                                    .reference = reference};
    if (to == NULL) {
        append(&model->unhandled[message], &item);
    } else {
        enter(model, to->module, &item);
    }
}

void model_finish(struct model *model, int module, size_t which)
{
    (void)take_at(&model->modules[module].active, which);
    release(&model->modules[module]);
}

void model_respond(struct model *model, int module, size_t which, int number)
{
    struct model_item reply = model->modules[module].active.items[which];
    reply.number = number;
    for (int i = 0; i < MODEL_MODULES; i++) {
        struct model_module *asker = &model->modules[i];
        if (reply.is_query && asker->connection == reply.asker && reply.asker != 0) {
            append(&asker->replies, &reply);
        }
    }
    model_finish(model, module, which);
}

void model_settle(struct model *model)
{
    for (int module = 0; module < MODEL_MODULES; module++) {
        if (model->modules[module].condemned) {
            model_disconnect(model, module);
        }
    }
}
