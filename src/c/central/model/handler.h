/*
 * Handlers and subscriptions.
 *
 * A handler is a callback of one module, known by a name and by the number that
 * the module gave when it first used the name; later numbers for the same name
 * do not count, for as long as the connection lasts.  A subscription attaches a
 * handler to a message.
 */
#ifndef IPC_CENTRAL_HANDLER_H
#define IPC_CENTRAL_HANDLER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/list.h"
#include "central/model/message.h"
#include "central/model/resource.h"

struct module;

struct handler {
    char *name; /* owned */
    int id;     /* the module's own number for it */
    struct module *module;
    struct resource *resource; /* against whose capacity its deliveries count */
    struct list subscriptions;
    size_t n_subscriptions;
};

struct subscription {
    struct handler *handler;
    struct message *message;
    struct list in_handler;
    struct list in_message; /* in order of subscription */

    /* Of watches, see watch.h. */
    struct list in_due; /* in module.due: the newest value is to be sent */
    unsigned in_flight; /* values sent and not yet reported handled */
    uint64_t mark;      /* link.queued behind the latest value sent */
};

/* The handler of that name, or NULL. */
struct handler *handler_find(const struct module *module, const char *name);

/* The same, made with that number if the name is new; NULL when the module has too many. */
struct handler *handler_get(struct module *module, const char *name, int id);

/* Frees all handlers of a module, whose subscriptions have to be gone. */
void handler_free_all(struct module *module);

/* Whether the handler is subscribed to the message: the subscription, or NULL. */
struct subscription *subscription_find(const struct handler *handler,
                                       const struct message *message);

/* Subscribes a handler that is not subscribed to the message. */
struct subscription *subscription_new(struct handler *handler, struct message *message);

/* Takes it out of its message: it gets no deliveries any more. */
void subscription_detach(struct subscription *subscription);

/* Frees a subscription, detached or not. */
void subscription_free(struct subscription *subscription);

/* The first one (latest: the last one) of a message, NULL if there is none. */
struct subscription *subscription_oldest(const struct message *message);
struct subscription *subscription_latest(const struct message *message);

#endif
