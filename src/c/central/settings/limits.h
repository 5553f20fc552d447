/*
 * How much of the server a module may use.
 *
 * Every queue, length and count that a module can make grow has its bound here;
 * those that concern frames and names of both sides are in base/limits.h.
 */
#ifndef IPC_CENTRAL_LIMITS_H
#define IPC_CENTRAL_LIMITS_H

#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"
#include "base/limits.h"

#define LIMIT_MESSAGES 262144u     /* message names, defined or only mentioned */
#define LIMIT_VARIABLES 65536u     /* variables, those of watched handlers included */
#define LIMIT_NAMED_FORMATS 65536u /* definitions of named formats */
#define LIMIT_HANDLERS 65536u      /* handler names of one module, deregistered ones included */
#define LIMIT_SUBSCRIPTIONS 1024u  /* messages that one handler is subscribed to */
#define LIMIT_RESOURCES 1024u      /* resources of one module */
#define LIMIT_CLAIMS 1024u         /* locks and reservations that one module holds or waits for */
#define LIMIT_PROVIDED 4096u       /* names that one module provides or requires */
#define LIMIT_TAPS 1024u           /* taps of one message */
#define LIMIT_AHEAD 64u            /* deliveries sent before their turn for one resource */
#define LIMIT_AHEAD_BYTES (256u * 1024) /* data of these, unless it is only one */
#define LIMIT_DIRECT_HANDLERS 100u      /* handlers that a publisher in direct mode is told of */
#define LIMIT_WAITING_QUERIES 100000u   /* deliveries of one message that nobody handles yet */
#define LIMIT_WAITING_BYTES (256u * 1024 * 1024) /* data of these */
#define LIMIT_QUESTIONS 100u /* ended resources about which somebody is asked at a time */

/* Those that an operator may change, with --limit-<name>=<number>; none is 0. */
struct central_limits {
    uint64_t data;             /* bytes of data in one frame; fits an int */
    uint64_t class_data;       /* bytes of class data in one frame; fits an int */
    uint64_t out_queue;        /* unsent bytes above which a module's queue is not taken from */
    uint64_t pending_bytes;    /* data that waits for one resource */
    uint64_t pending_messages; /* deliveries that wait for one resource */
    uint64_t progress_ns;      /* patience of senders with a receiver that finishes nothing */
    uint64_t introduction_ns;  /* patience with a connection that does not introduce itself */
    uint64_t look_up_ns;       /* patience with the look-up of a newcomer's name */
    uint64_t stuck_ns;         /* patience with a module whose unsent bytes exceed every measure */
    uint64_t unintroduced;     /* connections that have not introduced themselves yet */
};

void limits_init(struct central_limits *limits);

/* Sets one by "name=number": 0, ERR_UNKNOWN (no such name) or ERR_RANGE (no such number). */
int limits_set(struct central_limits *limits, const char *assignment);

/* Appends a line about each. */
void limits_show_help(struct buffer *out);

/* Unsent bytes above which a module is stuck: replies must have piled up, since a queue is not
 * taken from above the first limit, and then one frame of the longest kind still fits. */
static inline uint64_t limits_stuck_bytes(const struct central_limits *limits)
{
    return 2 * limits->out_queue + limits->data;
}

#endif
