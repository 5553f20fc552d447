/*
 * Dispatches: one message on its way from one sender to one receiver.
 *
 * The number of a dispatch is what the receiver acknowledges, what the log
 * shows as reference, and free again as soon as the dispatch is over.  Requests
 * to the server are dispatches, too, while they are carried out.
 */
#ifndef IPC_CENTRAL_DISPATCH_H
#define IPC_CENTRAL_DISPATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/block.h"
#include "base/idpool.h"
#include "base/list.h"
#include "central/model/handler.h"
#include "central/model/message.h"
#include "central/model/module.h"
#include "central/model/pending.h"
#include "central/model/pool.h"
#include "wire/frame.h"

enum dispatch_state {
    DISPATCH_NEW,     /* nowhere yet */
    DISPATCH_SERVED,  /* a request that the server carries out or has not answered yet */
    DISPATCH_HELD,    /* a request, answered, that locks or reserves a resource */
    DISPATCH_WAITING, /* nobody handles its message; in message.waiting */
    DISPATCH_PENDING, /* in a resource's queue */
    DISPATCH_AHEAD,   /* sent before its turn: to everybody but the link it is still pending */
    DISPATCH_ACTIVE   /* sent, not reported finished */
};

/* Data up to this length are kept in the dispatch itself. */
enum { DISPATCH_SMALL = 96 };

struct dispatch {
    uint32_t id;
    uint64_t number; /* never given again */
    enum dispatch_state state;
    bool uncounted;     /* takes nothing of the capacity */
    uint16_t class;     /* as sent, enum frame_class */
    uint8_t data_order; /* of the data, enum byte_order as far as checked */
    int32_t parent;     /* as sent */
    int32_t reference;  /* the sender's own number for it */
    struct message *message;
    struct module *sender;     /* a reference; NULL: the server itself */
    struct handler *handler;   /* NULL for requests to the server and while waiting */
    struct resource *resource; /* of pending, active and claiming ones */
    struct module *lost_by;    /* a reference: it waits for a module of that name; NULL: it does not
                                  matter who handles it */
    struct list link;          /* in the list that the state says */
    struct pending_item waiting;

    const uint8_t *data;
    uint32_t data_length;
    struct block *block; /* keeps data alive; NULL: in small, or only good for this moment */
    uint8_t small[DISPATCH_SMALL];
};

struct dispatch_pool {
    struct idpool numbers; /* -> struct dispatch */
    struct pool records;
    uint64_t n_begun;
    uint64_t n_ended;
};

void dispatch_pool_init(struct dispatch_pool *pool);

/* Frees everything; all dispatches have to be over. */
void dispatch_pool_fini(struct dispatch_pool *pool);

/* A dispatch of a frame's data, which is not copied; sender NULL: the server. */
struct dispatch *dispatch_new(struct dispatch_pool *pool, struct message *message,
                              struct module *sender, const struct frame *frame);

/* Ends a dispatch, which has left its lists (its link is taken out of one) and its queue. */
void dispatch_free(struct dispatch_pool *pool, struct dispatch *dispatch);

/* The dispatch of that number, or NULL. */
struct dispatch *dispatch_find(const struct dispatch_pool *pool, int64_t number);

/*
 * Makes the data last.  shared is a block that holds it already, or NULL; it is
 * set to the block that holds it now, so that the next dispatch of the same
 * frame shares it; the caller gives that reference back.  0 or ERR_MEMORY.
 */
int dispatch_keep(struct dispatch *dispatch, struct block **shared);

/* Gives the data up. */
void dispatch_drop_data(struct dispatch *dispatch);

/* Who sent it, as the log names parties. */
const char *dispatch_sender_name(const struct dispatch *dispatch);

#endif
