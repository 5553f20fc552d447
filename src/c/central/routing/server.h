/*
 * The server's state: registries, connections and what is under way.
 *
 * Everything hangs on this struct, so that several servers live in one process
 * and whole conversations are tests without sockets.  Time is told to it.
 */
#ifndef IPC_CENTRAL_SERVER_H
#define IPC_CENTRAL_SERVER_H

#include <stdbool.h>
#include <stdint.h>

#include "central/model/dispatch.h"
#include "central/log/log.h"
#include "central/model/message.h"
#include "central/model/module.h"
#include "central/model/namesakes.h"
#include "central/settings/options.h"
#include "format/names.h"
#include "wire/catalogue.h"

struct statistics {
    struct meter read;  /* frames handled, with their class data and data */
    uint64_t n_dropped; /* deliveries given up because a queue was full */
    uint64_t n_modules; /* connections now */
    uint64_t peak_modules;
    uint64_t n_accepted;           /* connections ever */
    uint64_t n_refused;            /* newcomers by access control */
    uint64_t n_without_descriptor; /* newcomers refused because there were none left */
    uint32_t shortest_body;
    uint32_t longest_body;
    uint64_t working_ns;  /* time not spent waiting */
    uint64_t handling_ns; /* ... spent on frames; both are taken only for the summary */
};

struct server {
    struct options *options;
    struct log log;
    uint64_t start_ns;
    uint64_t now_ns; /* monotonic, of this turn */
    uint64_t (*clock)(void);
    struct poller *poller; /* watches the sockets; NULL when there are none */

    struct catalogue catalogue;
    struct format_names *names;
    struct message_registry messages;
    struct message *library[LM_COUNT]; /* the library messages under their names of today */
    struct table variables;            /* name -> struct variable */
    size_t n_named_formats;
    struct dispatch_pool dispatches;
    struct pending_pool places;

    /* Variables of the server's own, and the messages in the list of active broadcasts. */
    struct variable *terminal_log;
    struct variable *file_log;
    struct variable *tapped;
    struct variable *broadcasts;
    struct list active_broadcasts;
    size_t n_active_broadcasts;

    struct list modules; /* all connections, in order of arrival */
    struct list greeted; /* those without introduction, oldest first */
    size_t n_greeted;
    struct list waiting; /* those whose wish to start is not answered, oldest first */
    size_t n_waiting;
    bool started;        /* as many as expected have asked to start */
    bool has_priorities; /* of messages: what waits may be overtaken */
    struct namesakes module_names;
    struct namesakes resource_names;

    /* Work of this turn. */
    struct list input;     /* modules with bytes to handle */
    bool holding;          /* a watched variable has a new value, behind which everything waits */
    struct list urgent;    /* modules to flush first */
    struct list flush;     /* the other modules to flush */
    struct list due;       /* modules to which due values of variables may go now */
    struct list condemned; /* modules whose connections end with the turn */
    struct list ended;     /* modules to let go at the end of the turn */
    struct list crowded;   /* resources for which senders wait */

    /* What ended modules have lost, while somebody is asked whether to send it again. */
    bool asks_before_resending;
    struct list losses;
    size_t n_losses;

    struct statistics statistics;
};

/* Tells the time. */
static inline void server_set_time(struct server *server, uint64_t now_ns)
{
    server->now_ns = now_ns;
}

/* The connection ends when the frame at hand has been handled: nothing that is just being looked at
 * goes away. */
static inline void server_condemn(struct server *server, struct module *module)
{
    if (module->state != MODULE_ENDED && list_is_empty(&module->in_condemned)) {
        list_append(&server->condemned, &module->in_condemned);
    }
}

#endif
