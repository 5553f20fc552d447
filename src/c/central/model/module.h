/*
 * Modules: one record per connection.
 *
 * A connection is a small state machine; only module_enter changes the state.
 *
 *     GREETED ---> INTRODUCED ---> WAITING ---> READY
 *        |             |              |           |
 *        +-------------+--------------+-----------+---> ENDED
 *
 * Names are labels: several connections may bear the same one.  The record of
 * an ended connection stays as long as deliveries name it as their sender.
 */
#ifndef IPC_CENTRAL_MODULE_H
#define IPC_CENTRAL_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/list.h"
#include "base/table.h"
#include "central/model/meter.h"
#include "central/model/resource.h"
#include "central/settings/when_full.h"
#include "link/link.h"

enum module_state {
    MODULE_GREETED,    /* accepted; may look messages up and introduce itself */
    MODULE_INTRODUCED, /* has a name and a resource; gets no deliveries yet */
    MODULE_WAITING,    /* has asked to start; the answer is withheld */
    MODULE_READY,      /* gets deliveries */
    MODULE_ENDED       /* the connection is over */
};

struct module {
    enum module_state state;
    unsigned references; /* one of the connection, one per delivery that names it as sender */
    char *name;          /* owned; MODULE_UNNAMED until introduced */
    char *host;
    int shown_fd; /* the descriptor as the log shows it, also after the end */
    struct link link;

    struct list in_server;    /* all connections, in order of arrival */
    struct list in_state;     /* of the greeted or the waiting ones, in order of arrival; of the
                              ended ones */
    struct list same_name;    /* once introduced */
    struct list in_condemned; /* of the server: its connection ends soon */
    uint64_t accepted_ns;
    int polled;       /* what the poller tells of its socket, READY_READ | READY_WRITE */
    bool in_order;    /* its library has the ability ABILITY_IN_ORDER */
    bool takes_ahead; /* ... ABILITY_AHEAD */

    /* What goes through. */
    struct meter sends; /* frames of every kind */
    struct meter gets;  /* deliveries */

    /* Input. */
    struct list in_input;       /* has bytes that are not handled yet */
    bool input_ended;           /* no more bytes will come */
    struct list in_waiting_for; /* of the resource for which it waits: it is not read meanwhile */

    /* Output. */
    struct list in_flush;    /* has bytes that are not flushed yet, or is polled for too much */
    bool urgent;             /* ... among them a new value of a watched variable */
    struct link *later;      /* frames held behind such values, see outbox.h; owned, or NULL */
    bool deaf;               /* writing failed: nothing more is queued */
    bool wants_room;         /* its queue waits for unsent bytes to leave */
    uint64_t stuck_since_ns; /* unsent bytes exceed every measure; 0: they do not */

    /* From MODULE_INTRODUCED on. */
    struct resource *own;
    struct list resources;    /* own is the first */
    enum when_full when_full; /* what becomes of its queues then */
    uint64_t finished_ns;     /* when it last reported a delivery finished */
    size_t n_resources;
    struct table handlers;          /* name -> struct handler */
    struct list due;                /* subscriptions whose watched variable has a new value */
    struct list in_due;             /* of the server, when something has been written since */
    struct dispatch *start_request; /* while MODULE_WAITING */
    struct table provides;          /* names; the values mean nothing */
    struct table needs;
    struct list held; /* requests of it that lock or reserve something */
    size_t n_claims;  /* these, and those that wait */
    int direct_port;  /* NO_PORT: it has announced none */
};

enum { NO_PORT = -1 };

#define MODULE_UNNAMED "**NEWMOD**"
#define MODULE_UNKNOWN_HOST "**UNKNOWN**"

/* A record with one reference for a connection over that socket (-1: memory). */
struct module *module_new(int fd, uint64_t now_ns);

/* Changes the state. */
void module_enter(struct module *module, enum module_state state);

/* Gives the connection its name, and its own resource. */
void module_introduce(struct module *module, const char *name, const char *host,
                      struct pending_pool *pool);

/* Drops the frames that are held. */
void module_drop_later(struct module *module);

struct module *module_ref(struct module *module);

/* Gives one reference back; the last one frees.  NULL is fine. */
void module_unref(struct module *module);

static inline bool module_is_introduced(const struct module *module)
{
    return module->state >= MODULE_INTRODUCED && module->state < MODULE_ENDED;
}

/* Whether it waits for a receiver that it has outpaced. */
static inline bool module_waits(const struct module *module)
{
    return !list_is_empty(&module->in_waiting_for);
}

/* The module's resource of that name, or NULL. */
struct resource *module_find_resource(const struct module *module, const char *name);

#endif
