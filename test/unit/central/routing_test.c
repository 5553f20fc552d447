/*
 * Routing as a whole: random events to a server in memory and to the simplest
 * model of one, which have to send the same to the same modules in the same order.
 *
 * IPC_TEST_SEED sets another seed than that of every day.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "routing_model.h"

enum {
    STEPS = 40000,   /* of each of the situations */
    MANY_WAIT = 500, /* from here on only what takes messages away happens */
    DEFAULT_SEED = 20260102
};

/* What may happen in a run. */
struct situation {
    const char *arguments[4];
    enum when_full policy;
    size_t most_waiting;
    bool limits_and_priorities;
    bool ahead; /* modules keep to their capacity themselves, so deliveries may come early */
};

/* A delivery or a reply as it has arrived. */
struct arrival {
    int32_t dispatch; /* the number of a delivery, the reference of a reply */
    int handler;
    int number;
    char name[8];
};

struct arrivals {
    struct arrival items[MODEL_ROOM];
    size_t count;
};

struct slot {
    struct peer *peer;     /* owned; NULL: not connected */
    struct arrivals early; /* deliveries that the model does not expect yet */
    struct arrivals replies;
    int32_t active[MODEL_ROOM]; /* numbers of the deliveries that are active in the model */
};

struct run {
    const struct situation *situation;
    struct station station;
    struct peer definer;
    struct slot slots[MODEL_MODULES];
    struct model model;
    uint32_t seed;
    uint32_t random;
    int step;
    const char *event; /* what has happened last */
};

/* --------------------------------------------------------------------- chance */

static uint32_t chance(struct run *run, uint32_t below)
{
    run->random = run->random * 1664525u + 1013904223u;
    return (run->random >> 8) % below;
}

static int one_message(struct run *run)
{
    return (int)chance(run, MODEL_MESSAGES);
}

/* A module that is connected, or not; -1 if the first try finds none. */
static int one_module(struct run *run, bool connected)
{
    const int module = (int)chance(run, MODEL_MODULES);
    return (run->slots[module].peer != NULL) == connected ? module : -1;
}

static const char *name_of(int message)
{
    static const char *const names[MODEL_MESSAGES] = {"M0", "M1", "M2", "M3", "M4"};
    return names[message];
}

static void require(const struct run *run, bool holds, const char *what)
{
    if (!holds) {
        fail_msg("%s differs after step %d (%s) with IPC_TEST_SEED=%lu", what, run->step,
                 run->event, (unsigned long)run->seed);
    }
}

/* --------------------------------------------------------------------- modules */

static void let_in(struct run *run, int module)
{
    /* Modules of the same name have to be kept apart. */
    static const char *const names[MODEL_MODULES] = {"A", "B", "C", "A", "B", "A"};
    struct slot *slot = &run->slots[module];
    slot->peer = mem_new(sizeof *slot->peer);
    slot->early.count = slot->replies.count = 0;
    peer_connect(&run->station, slot->peer, names[module]);
    if (run->situation->ahead) {
        (void)peer_id_of(slot->peer, ABILITY_AHEAD);
    }
    model_connect(&run->model, module);
}

static void let_go(struct run *run, int module)
{
    struct slot *slot = &run->slots[module];
    peer_leave(slot->peer);
    free(slot->peer);
    slot->peer = NULL;
}

static void open_run(struct run *run, const struct situation *situation, uint32_t seed)
{
    memset(run, 0, sizeof *run);
    run->situation = situation;
    run->seed = run->random = seed;
    run->event = "the beginning";
    station_open(&run->station, situation->arguments);
    peer_connect(&run->station, &run->definer, "Definer");
    for (int message = 0; message < MODEL_MESSAGES; message++) {
        peer_define(&run->definer, name_of(message), "int");
    }
    station_run(&run->station);
    model_init(&run->model, situation->policy, situation->most_waiting);
}

static void close_run(struct run *run)
{
    for (int module = 0; module < MODEL_MODULES; module++) {
        if (run->slots[module].peer != NULL) {
            let_go(run, module);
        }
    }
    (void)station_log(&run->station);
    station_close(&run->station);
    const struct dispatch_pool *dispatches = &run->station.server.dispatches;
    assert_int_equal(dispatches->n_begun, dispatches->n_ended);
}

/* --------------------------------------------------------------------- events */

static void publish(struct run *run)
{
    const int sender = one_module(run, true);
    const int message = one_message(run);
    if (sender >= 0) {
        run->event = "a publication";
        peer_publish(run->slots[sender].peer, name_of(message), run->step);
        model_publish(&run->model, message, run->step);
    }
}

static void query(struct run *run)
{
    const int sender = one_module(run, true);
    const int message = one_message(run);
    if (sender >= 0 && run->model.unhandled[message].count < MANY_WAIT) {
        run->event = "a query";
        const int reference = peer_query(run->slots[sender].peer, name_of(message), run->step);
        model_query(&run->model, sender, message, run->step, reference);
    }
}

static void finish(struct run *run)
{
    const int module = one_module(run, true);
    if (module < 0 || run->model.modules[module].active.count == 0) {
        return;
    }
    struct slot *slot = &run->slots[module];
    const size_t count = run->model.modules[module].active.count;
    const size_t which = chance(run, (uint32_t)count);
    const bool responds = chance(run, 2) == 0;
    struct frame delivery;
    frame_init(&delivery, CLASS_DELIVERY);
    delivery.reference = slot->active[which];
    memmove(slot->active + which, slot->active + which + 1,
            (count - 1 - which) * sizeof *slot->active);
    if (responds) {
        run->event = "a response";
        peer_respond(slot->peer, &delivery, "M0", run->step);
        model_respond(&run->model, module, which, run->step);
    } else {
        run->event = "an acknowledgement";
        peer_acknowledge(slot->peer, &delivery);
        model_finish(&run->model, module, which);
    }
}

static void change_subscription(struct run *run)
{
    const int module = one_module(run, true);
    const int message = one_message(run);
    const int handler = message * 10 + (int)chance(run, MODEL_HANDLERS);
    if (module < 0) {
        return;
    }
    struct peer *peer = run->slots[module].peer;
    if (model_is_subscribed(&run->model, module, message, handler)) {
        run->event = "an unsubscription";
        peer_unsubscribe(peer, name_of(message), handler);
        model_unsubscribe(&run->model, module, message, handler);
    } else {
        run->event = "a subscription";
        peer_subscribe(peer, name_of(message), handler);
        model_subscribe(&run->model, module, message, handler);
    }
}

static void set_capacity(struct run *run)
{
    const int module = one_module(run, true);
    const int capacity = (int)chance(run, 5);
    if (module >= 0) {
        run->event = "a new capacity";
        peer_set_capacity(run->slots[module].peer, capacity);
        model_set_capacity(&run->model, module, capacity);
    }
}

static void set_limit(struct run *run)
{
    const int module = one_module(run, true);
    const int limit = (int)chance(run, 8);
    const int message = one_message(run);
    if (module < 0) {
        return;
    }
    if (chance(run, 4) == 0) {
        run->event = "a new limit of all messages";
        peer_set_limit(run->slots[module].peer, NULL, limit);
        model_set_limit_of_all(&run->model, module, limit);
    } else {
        run->event = "a new limit";
        peer_set_limit(run->slots[module].peer, name_of(message), limit);
        model_set_limit(&run->model, module, message, limit);
    }
}

static void set_priority(struct run *run)
{
    const int message = one_message(run);
    const int priority = (int)chance(run, 4);
    run->event = "a new priority";
    peer_set_priority(&run->definer, name_of(message), priority);
    model_set_priority(&run->model, message, priority);
}

static void connect_or_disconnect(struct run *run)
{
    const int newcomer = one_module(run, false);
    const int leaver = one_module(run, true);
    if (newcomer >= 0) {
        run->event = "a connection";
        let_in(run, newcomer);
    } else if (leaver >= 0 && chance(run, 4) == 0) {
        run->event = "an end";
        let_go(run, leaver);
        model_disconnect(&run->model, leaver);
    }
}

/* Reports of deliveries that nobody has, or somebody else. */
static void report_nonsense(struct run *run)
{
    const int module = one_module(run, true);
    const int other = one_module(run, true);
    struct frame delivery;
    if (module < 0) {
        return;
    }
    run->event = "a wrong report";
    frame_init(&delivery, CLASS_DELIVERY);
    delivery.reference = other >= 0 && other != module && run->model.modules[other].active.count > 0
                             ? run->slots[other].active[0]
                             : 1000000;
    peer_acknowledge(run->slots[module].peer, &delivery);
}

static bool too_many_wait(const struct run *run)
{
    for (int module = 0; module < MODEL_MODULES; module++) {
        if (run->model.modules[module].waiting.count > MANY_WAIT) {
            return true;
        }
    }
    return false;
}

static void happen(struct run *run)
{
    const uint32_t what = chance(run, 100);
    const bool rare = run->situation->limits_and_priorities;
    if (what >= 62 || too_many_wait(run)) {
        finish(run);
    } else if (what < 30) {
        publish(run);
    } else if (what < 44) {
        query(run);
    } else if (what < 52) {
        change_subscription(run);
    } else if (what < 54) {
        set_capacity(run);
    } else if (what < 57 && rare) {
        set_limit(run);
    } else if (what < 58 && rare) {
        set_priority(run);
    } else if (what < 61) {
        connect_or_disconnect(run);
    } else {
        report_nonsense(run);
    }
}

/* ------------------------------------------------------------------ comparison */

static void note_arrival(struct slot *slot, const struct frame *frame)
{
    const bool is_reply = frame->intent == INTENT_REPLY;
    struct arrivals *arrivals = is_reply ? &slot->replies : &slot->early;
    struct arrival *arrival = &arrivals->items[arrivals->count++];
    assert_true(arrivals->count < MODEL_ROOM);
    arrival->dispatch = frame->reference;
    arrival->handler = frame->intent;
    arrival->number = (int)load_32(frame->data + 8, (enum byte_order)frame->data_order);
    (void)snprintf(arrival->name, sizeof arrival->name, "%.*s", (int)frame->class_length - 4,
                   (const char *)frame->class_data + 4);
}

/* Takes the first so many off. */
static void shorten(struct arrivals *arrivals, size_t count)
{
    arrivals->count -= count;
    memmove(arrivals->items, arrivals->items + count, arrivals->count * sizeof *arrivals->items);
}

static void compare_deliveries(struct run *run, struct slot *slot, struct model_module *expected)
{
    const size_t n_sent = expected->sent.count;
    const size_t n_before = expected->active.count - n_sent;
    require(run, slot->early.count >= n_sent, "the number of deliveries");
    for (size_t i = 0; i < n_sent; i++) {
        const struct model_item *item = &expected->sent.items[i];
        const struct arrival *arrival = &slot->early.items[i];
        require(run, strcmp(arrival->name, name_of(item->message)) == 0, "a message");
        require(run, arrival->number == item->number, "a content");
        require(run, arrival->handler == item->handler, "a handler");
        slot->active[n_before + i] = arrival->dispatch;
    }
    shorten(&slot->early, n_sent);
    expected->sent.count = 0;
    require(run, slot->early.count == 0 || run->situation->ahead, "the number of deliveries");
}

static void compare_replies(struct run *run, struct slot *slot, struct model_module *expected)
{
    require(run, slot->replies.count == expected->replies.count, "the number of replies");
    for (size_t i = 0; i < slot->replies.count; i++) {
        const struct model_item *item = &expected->replies.items[i];
        const struct arrival *arrival = &slot->replies.items[i];
        require(run, arrival->dispatch == item->reference, "the reference of a reply");
        require(run, arrival->number == item->number, "the content of a reply");
    }
    slot->replies.count = expected->replies.count = 0;
}

static void compare_module(struct run *run, int module)
{
    struct slot *slot = &run->slots[module];
    struct model_module *expected = &run->model.modules[module];
    struct frame frame;
    while (peer_receive(slot->peer, &frame)) {
        note_arrival(slot, &frame);
    }
    compare_deliveries(run, slot, expected);
    compare_replies(run, slot, expected);
    const struct resource *resource = slot->peer->module->own;
    require(run, resource->attending == expected->active.count, "the number of active ones");
    require(run, resource_count_waiting(resource) == expected->waiting.count,
            "the number that wait");
}

static void compare(struct run *run)
{
    model_settle(&run->model);
    station_run(&run->station);
    for (int module = 0; module < MODEL_MODULES; module++) {
        struct slot *slot = &run->slots[module];
        const bool connected = slot->peer != NULL && !peer_is_closed(slot->peer);
        require(run, connected == (run->model.modules[module].connection != 0), "a connection");
        if (connected) {
            compare_module(run, module);
        } else if (slot->peer != NULL) {
            let_go(run, module);
        }
    }
    require(run, run->station.server.statistics.n_dropped == run->model.n_dropped,
            "the number of dropped ones");
    (void)station_log(&run->station);
}

static void run_situation(const struct situation *situation)
{
    static struct run run; /* large */
    const char *seed = getenv("IPC_TEST_SEED");
    open_run(&run, situation, seed == NULL ? DEFAULT_SEED : (uint32_t)strtoul(seed, NULL, 10));
    for (run.step = 0; run.step < STEPS; run.step++) {
        happen(&run);
        compare(&run);
    }
    /* It was not all about nothing. */
    assert_true(run.station.server.dispatches.n_begun > STEPS / 4);
    assert_true(run.model.n_dropped > STEPS / 10 || !situation->limits_and_priorities);
    close_run(&run);
}

static void with_limits_and_priorities(void **state)
{
    static const struct situation situation = {
        {"-lx", NULL}, WHEN_FULL_WAIT, SIZE_MAX, true, false};
    (void)state;
    run_situation(&situation);
}

static void when_full_queues_keep_the_newest(void **state)
{
    static const struct situation situation = {
        {"-lx", "--when-full=newest", "--limit-queue-messages=7", NULL},
        WHEN_FULL_NEWEST,
        7,
        true,
        false};
    (void)state;
    run_situation(&situation);
}

static void when_full_queues_keep_the_oldest(void **state)
{
    static const struct situation situation = {
        {"-lx", "--when-full=oldest", "--limit-queue-messages=7", NULL},
        WHEN_FULL_OLDEST,
        7,
        true,
        false};
    (void)state;
    run_situation(&situation);
}

static void when_full_queues_end_connections(void **state)
{
    static const struct situation situation = {
        {"-lx", "--when-full=disconnect", "--limit-queue-messages=7", NULL},
        WHEN_FULL_DISCONNECT,
        7,
        true,
        false};
    (void)state;
    run_situation(&situation);
}

static void when_deliveries_are_sent_ahead(void **state)
{
    static const struct situation situation = {
        {"-lx", NULL}, WHEN_FULL_WAIT, SIZE_MAX, false, true};
    (void)state;
    run_situation(&situation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_limits_and_priorities),
        cmocka_unit_test(when_full_queues_keep_the_newest),
        cmocka_unit_test(when_full_queues_keep_the_oldest),
        cmocka_unit_test(when_full_queues_end_connections),
        cmocka_unit_test(when_deliveries_are_sent_ahead),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
