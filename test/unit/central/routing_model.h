/*
 * The simplest routing there is: arrays, loops, and nothing shared.
 *
 * What a server has to do with the messages of modules, told event by event; what
 * it has to send to whom is appended to lists of the modules.
 */
#ifndef TEST_CENTRAL_ROUTING_MODEL_H
#define TEST_CENTRAL_ROUTING_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "central/settings/when_full.h"

enum {
    MODEL_MODULES = 6,
    MODEL_MESSAGES = 5,
    MODEL_HANDLERS = 2, /* of a module for a message */
    MODEL_ROOM = 4096   /* deliveries in any of the lists */
};

/* One message for one handler, or for nobody yet. */
struct model_item {
    int message;
    int number; /* its content */
    int handler;
    bool is_query;
    int asker; /* number of the connection that asks, see model_module */
    int reference;
};

struct model_list {
    struct model_item items[MODEL_ROOM];
    size_t count;
};

struct model_module {
    int connection; /* number, from 1 on; 0: not connected */
    int capacity;
    struct model_list active;  /* delivered and not finished, oldest first */
    struct model_list waiting; /* oldest first */
    int turns[MODEL_ROOM];     /* messages in the order in which they leave; as many as wait */
    int limits[MODEL_MESSAGES];
    int limit; /* of all together; below 0: none, as above */
    bool condemned;
    struct model_list sent;    /* deliveries that it has to be sent; whoever compares empties it */
    struct model_list replies; /* ... and replies to its queries: number and reference count */
};

struct model_subscription {
    int module;
    int handler;
};

struct model {
    enum when_full policy;
    size_t most_waiting; /* in one queue */
    struct model_module modules[MODEL_MODULES];
    int priorities[MODEL_MESSAGES];
    struct model_subscription subscriptions[MODEL_MESSAGES][MODEL_MODULES * MODEL_HANDLERS];
    size_t n_subscriptions[MODEL_MESSAGES];
    struct model_list unhandled[MODEL_MESSAGES]; /* queries */
    int n_connections;
    uint64_t n_dropped;
};

void model_init(struct model *model, enum when_full policy, size_t most_waiting);

void model_connect(struct model *model, int module);
void model_disconnect(struct model *model, int module);
bool model_is_subscribed(const struct model *model, int module, int message, int handler);
void model_subscribe(struct model *model, int module, int message, int handler);
void model_unsubscribe(struct model *model, int module, int message, int handler);
void model_set_capacity(struct model *model, int module, int capacity);
void model_set_limit(struct model *model, int module, int message, int limit);
void model_set_limit_of_all(struct model *model, int module, int limit);
void model_set_priority(struct model *model, int message, int priority);
void model_publish(struct model *model, int message, int number);
void model_query(struct model *model, int module, int message, int number, int reference);

/* The module reports one of its active deliveries finished, by its place in the list ... */
void model_finish(struct model *model, int module, size_t which);

/* ... or responds to it, with a number. */
void model_respond(struct model *model, int module, size_t which, int number);

/* Ends the connections that a full queue has condemned: what an event may end with. */
void model_settle(struct model *model);

#endif
