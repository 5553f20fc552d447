/*
 * The queue of deliveries that wait for one resource: runs of places, and per
 * subject the deliveries that stand in them.
 */
#include "central/model/pending.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct run {
    struct list in_queue;
    int priority;
    struct list places;
};

struct place {
    struct list in_run;
    struct list in_flow;
    struct pending_flow *flow;
    struct run *run;
};

/* --------------------------------------------------------------------- pool */

void pending_pool_init(struct pending_pool *pool)
{
    pool->count = 0;
    pool->bytes = 0;
    pool_init(&pool->places, sizeof(struct place));
    pool_init(&pool->runs, sizeof(struct run));
}

void pending_pool_fini(struct pending_pool *pool)
{
    pool_fini(&pool->places);
    pool_fini(&pool->runs);
}

static struct run *run_new(struct pending_pool *pool, int priority)
{
    struct run *run = pool_take(&pool->runs);
    list_init(&run->in_queue);
    list_init(&run->places);
    run->priority = priority;
    return run;
}

static void run_free(struct pending_pool *pool, struct run *run)
{
    list_remove(&run->in_queue);
    pool_give(&pool->runs, run);
}

static void place_free(struct pending_pool *pool, struct place *place)
{
    struct run *run = place->run;
    list_remove(&place->in_run);
    list_remove(&place->in_flow);
    pool_give(&pool->places, place);
    if (list_is_empty(&run->places)) {
        run_free(pool, run);
    }
}

/* -------------------------------------------------------------------- places */

/* The link of the first run of lower priority, or the head of the list: there a new place goes. */
static struct list *find_lower(struct pending *queue, int priority)
{
    struct list *at = &queue->runs;
    if (priority > NO_PRIORITY) {
        for (at = queue->runs.next; at != &queue->runs; at = at->next) {
            if (LIST_OWNER(at, struct run, in_queue)->priority < priority) {
                break;
            }
        }
    }
    return at;
}

/* The run of that priority that ends right before a link, made if there is none. */
static struct run *run_before(struct pending *queue, struct list *link, int priority)
{
    if (link->previous != &queue->runs) {
        struct run *run = LIST_OWNER(link->previous, struct run, in_queue);
        if (run->priority == priority) {
            return run;
        }
    }
    struct run *run = run_new(queue->pool, priority);
    list_insert(link, &run->in_queue);
    return run;
}

static void join_run(struct place *place, struct run *run)
{
    place->run = run;
    list_append(&run->places, &place->in_run);
}

static struct place *last_place(const struct pending_flow *flow)
{
    return LIST_OWNER(flow->places.previous, struct place, in_flow);
}

/* The link before which a place at the end of that run belongs in its flow: places of the flow
 * stand behind the run only if its priority has been raised since they were added. */
static struct list *position_in_flow(struct pending_flow *flow, const struct run *run)
{
    struct list *at, *inner;
    if (list_is_empty(&flow->places) || last_place(flow)->run == run) {
        return &flow->places;
    }
    for (at = run->in_queue.next; at != &flow->queue->runs; at = at->next) {
        struct run *behind = LIST_OWNER(at, struct run, in_queue);
        for (inner = behind->places.next; inner != &behind->places; inner = inner->next) {
            struct place *place = LIST_OWNER(inner, struct place, in_run);
            if (place->flow == flow) {
                return &place->in_flow;
            }
        }
    }
    return &flow->places;
}

static void add_place(struct pending_flow *flow)
{
    struct pending *queue = flow->queue;
    struct place *place = pool_take(&queue->pool->places);
    const int priority = flow->subject->priority;
    place->flow = flow;
    struct run *run = run_before(queue, find_lower(queue, priority), priority);
    list_insert(position_in_flow(flow, run), &place->in_flow);
    join_run(place, run);
}

/* ------------------------------------------------------------------ subjects */

void pending_subject_init(struct pending_subject *subject, uint32_t number)
{
    subject->number = number;
    subject->priority = NO_PRIORITY;
    list_init(&subject->flows);
}

/* Builds the runs anew over the same places in the same order. */
static void rebuild_runs(struct pending *queue)
{
    struct list old;
    struct list *at, *following, *inner, *after;
    list_init(&old);
    LIST_EACH (at, following, &queue->runs) {
        list_remove(at);
        list_append(&old, at);
    }
    LIST_EACH (at, following, &old) {
        struct run *run = LIST_OWNER(at, struct run, in_queue);
        LIST_EACH (inner, after, &run->places) {
            struct place *place = LIST_OWNER(inner, struct place, in_run);
            list_remove(inner);
            join_run(place, run_before(queue, &queue->runs, place->flow->subject->priority));
        }
        run_free(queue->pool, run);
    }
}

void pending_subject_set_priority(struct pending_subject *subject, int priority)
{
    struct list *at, *following;
    subject->priority = priority < 0 ? NO_PRIORITY : priority;
    LIST_EACH (at, following, &subject->flows) {
        struct pending_flow *flow = LIST_OWNER(at, struct pending_flow, of_subject);
        if (flow->count > 0) {
            rebuild_runs(flow->queue);
        }
    }
}

/* --------------------------------------------------------------------- flows */

static struct pending_flow *find_flow(const struct pending *queue,
                                      const struct pending_subject *subject)
{
    return intmap_find(&queue->flows, subject->number);
}

static struct pending_flow *get_flow(struct pending *queue, struct pending_subject *subject)
{
    struct pending_flow *flow = find_flow(queue, subject);
    if (flow != NULL) {
        return flow;
    }
    flow = mem_new(sizeof *flow);
    flow->queue = queue;
    flow->subject = subject;
    flow->limit = NO_LIMIT;
    list_init(&flow->items);
    list_init(&flow->places);
    list_append(&subject->flows, &flow->of_subject);
    (void)intmap_put(&queue->flows, subject->number, flow); /* replaces nothing */
    return flow;
}

int pending_set_limit(struct pending *queue, struct pending_subject *subject, int limit)
{
    struct pending_flow *flow = get_flow(queue, subject);
    const int before = flow->limit;
    flow->limit = limit < 0 ? NO_LIMIT : limit;
    return before;
}

size_t pending_count_of(const struct pending *queue, const struct pending_subject *subject)
{
    const struct pending_flow *flow = find_flow(queue, subject);
    return flow == NULL ? 0 : flow->count;
}

/* --------------------------------------------------------------------- queue */

void pending_init(struct pending *queue, struct pending_pool *pool)
{
    memset(queue, 0, sizeof *queue);
    queue->pool = pool;
    queue->limit = NO_LIMIT;
    list_init(&queue->runs);
    list_init(&queue->by_age);
    intmap_init(&queue->flows);
}

void pending_fini(struct pending *queue)
{
    for (size_t i = 0; i < queue->flows.n_slots; i++) {
        struct pending_flow *flow = queue->flows.slots[i].value;
        if (flow != NULL) {
            list_remove(&flow->of_subject);
            free(flow);
        }
    }
    intmap_fini(&queue->flows);
}

void pending_item_init(struct pending_item *item)
{
    item->flow = NULL;
    list_init(&item->in_flow);
    list_init(&item->by_age);
    item->bytes = 0;
}

static void item_enter(struct pending_flow *flow, struct pending_item *item, size_t bytes)
{
    item->flow = flow;
    item->bytes = bytes;
    list_append(&flow->items, &item->in_flow);
    list_append(&flow->queue->by_age, &item->by_age);
    flow->count++;
    flow->queue->count++;
    flow->queue->bytes += bytes;
    flow->queue->pool->count++;
    flow->queue->pool->bytes += bytes;
}

static void item_leave(struct pending_item *item)
{
    struct pending_flow *flow = item->flow;
    list_remove(&item->in_flow);
    list_remove(&item->by_age);
    flow->count--;
    flow->queue->count--;
    flow->queue->bytes -= item->bytes;
    flow->queue->pool->count--;
    flow->queue->pool->bytes -= item->bytes;
    item->flow = NULL;
}

static struct pending_item *oldest_of(const struct pending_flow *flow)
{
    return LIST_OWNER(flow->items.next, struct pending_item, in_flow);
}

/* The new item takes the oldest one's turn, so to speak: all of the flow move up one place. */
static struct pending_item *replace_oldest(struct pending_flow *flow, struct pending_item *item,
                                           size_t bytes)
{
    struct pending_item *oldest = oldest_of(flow);
    item_leave(oldest);
    item_enter(flow, item, bytes);
    return oldest;
}

struct pending_item *pending_add(struct pending *queue, struct pending_subject *subject,
                                 struct pending_item *item, size_t bytes)
{
    struct pending_flow *flow = get_flow(queue, subject);
    if (flow->limit == 0 || queue->limit == 0) {
        return item;
    }
    if (flow->limit > 0 && flow->count >= (size_t)flow->limit) {
        return replace_oldest(flow, item, bytes);
    }
    struct pending_item *dropped = NULL;
    if (queue->limit > 0 && queue->count >= (size_t)queue->limit) {
        dropped = pending_take_oldest(queue);
    }
    item_enter(flow, item, bytes);
    add_place(flow);
    return dropped;
}

struct pending_item *pending_take(struct pending *queue)
{
    if (queue->count == 0) {
        return NULL;
    }
    struct run *run = LIST_OWNER(queue->runs.next, struct run, in_queue);
    struct place *place = LIST_OWNER(run->places.next, struct place, in_run);
    struct pending_item *item = oldest_of(place->flow);
    place_free(queue->pool, place);
    item_leave(item);
    return item;
}

struct pending_item *pending_take_oldest(struct pending *queue)
{
    if (queue->count == 0) {
        return NULL;
    }
    struct pending_item *item = LIST_OWNER(queue->by_age.next, struct pending_item, by_age);
    pending_remove(item);
    return item;
}

void pending_remove(struct pending_item *item)
{
    struct pending_flow *flow = item->flow;
    /* The oldest stood in the first place.  Of the others it does not matter: those behind move up.
     */
    struct list *link = item == oldest_of(flow) ? flow->places.next : flow->places.previous;
    place_free(flow->queue->pool, LIST_OWNER(link, struct place, in_flow));
    item_leave(item);
}
