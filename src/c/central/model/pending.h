/*
 * The queue of deliveries that wait for one resource.
 *
 * A delivery waits in a place, and the places of the queue are ordered: higher
 * priority first, then first come, first served.  A place belongs to a message
 * (a "subject"), not to one delivery of it: when its turn comes, the oldest
 * waiting delivery of that message leaves.  So a limit on a message costs
 * nothing: the oldest delivery goes, the new one is the newest, and the places
 * stay where they are, which keeps the message's turns.
 *
 *     places      L  M  L  M          subject L: 1 3      subject M: 2 4
 *     L5 comes, at most two of L may wait:
 *     places      L  M  L  M          subject L: 3 5      subject M: 2 4
 *
 * Places of equal priority that follow each other form a run, so that a new one
 * finds its run without passing every place.  Priorities are compared as they
 * are now; changing one moves no place.
 */
#ifndef IPC_CENTRAL_PENDING_H
#define IPC_CENTRAL_PENDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/intmap.h"
#include "base/list.h"
#include "central/model/pool.h"

enum { NO_PRIORITY = -1, NO_LIMIT = -1 };

/* What deliveries are of: the same in all queues. */
struct pending_subject {
    uint32_t number; /* unique */
    int priority;    /* NO_PRIORITY, or at least 0 */
    struct list flows;
};

/* One subject in one queue; stays once it exists, because it holds the limit. */
struct pending_flow {
    struct pending *queue;
    struct pending_subject *subject;
    struct list of_subject;
    int limit; /* deliveries that may wait, or NO_LIMIT */
    size_t count;
    struct list items;  /* of struct pending_item, oldest first */
    struct list places; /* as many, the next to leave first */
};

/* Part of each thing that can wait. */
struct pending_item {
    struct pending_flow *flow; /* NULL: it does not wait */
    struct list in_flow;
    struct list by_age;
    size_t bytes;
};

/* Places and runs, shared by many queues, and what waits in all of these. */
struct pending_pool {
    struct pool places;
    struct pool runs;
    size_t count;
    uint64_t bytes;
};

struct pending {
    struct pending_pool *pool;
    struct list runs;   /* next to leave first */
    struct list by_age; /* of struct pending_item, oldest first */
    struct intmap flows;
    size_t count;
    uint64_t bytes;
    int limit; /* of the whole queue, or NO_LIMIT */
};

void pending_pool_init(struct pending_pool *pool);
void pending_pool_fini(struct pending_pool *pool);

void pending_subject_init(struct pending_subject *subject, uint32_t number);

/* Sets the priority (below 0: none) in all queues. */
void pending_subject_set_priority(struct pending_subject *subject, int priority);

void pending_init(struct pending *queue, struct pending_pool *pool);

/* The queue has to be empty. */
void pending_fini(struct pending *queue);

static inline bool pending_is_empty(const struct pending *queue)
{
    return queue->count == 0;
}

void pending_item_init(struct pending_item *item);

/*
 * Adds an item.  Returns the item that had to leave for it because of a limit,
 * NULL if none had to, or the new item itself where nothing may wait at all.
 */
struct pending_item *pending_add(struct pending *queue, struct pending_subject *subject,
                                 struct pending_item *item, size_t bytes);

/* Takes the item whose turn it is; NULL when the queue is empty. */
struct pending_item *pending_take(struct pending *queue);

/* Takes the item that has waited longest; NULL when the queue is empty. */
struct pending_item *pending_take_oldest(struct pending *queue);

/* Takes an item that waits out of its queue. */
void pending_remove(struct pending_item *item);

/* Sets how many of a subject may wait (below 0: no limit) and returns the limit before. */
int pending_set_limit(struct pending *queue, struct pending_subject *subject, int limit);

/* How many of a subject wait. */
size_t pending_count_of(const struct pending *queue, const struct pending_subject *subject);

#endif
