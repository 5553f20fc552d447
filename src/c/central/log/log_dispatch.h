/*
 * The lines about the life of a dispatch.
 */
#ifndef IPC_CENTRAL_LOG_DISPATCH_H
#define IPC_CENTRAL_LOG_DISPATCH_H

#include "central/log/log_output.h"

/* The lines themselves; what follows asks first whether any log shows message lines. */
void log_write_sent(struct log *log, struct dispatch *dispatch, const char *receiver);
void log_write_queued(struct log *log, const struct dispatch *dispatch, const char *resource);
void log_write_released(struct log *log, struct dispatch *dispatch);
void log_write_done(struct log *log, const struct dispatch *dispatch);

/* Sent at once. */
static inline void log_sent(struct log *log, struct dispatch *dispatch, const char *receiver)
{
    if (log->messages_on) {
        log_write_sent(log, dispatch, receiver);
    }
}

/* Queued for a resource, or standing in for a handler under the message's name. */
static inline void log_queued(struct log *log, const struct dispatch *dispatch,
                              const char *resource)
{
    if (log->messages_on) {
        log_write_queued(log, dispatch, resource);
    }
}

/* Sent from the queue of its resource. */
static inline void log_released(struct log *log, struct dispatch *dispatch)
{
    if (log->messages_on) {
        log_write_released(log, dispatch);
    }
}

static inline void log_done(struct log *log, const struct dispatch *dispatch)
{
    if (log->messages_on) {
        log_write_done(log, dispatch);
    }
}

/* A request to lock or reserve has to wait. */
void log_request_waits(struct log *log, const struct dispatch *dispatch);

void log_failed(struct log *log, const struct dispatch *dispatch, const char *reason, int length);

/* Data of a reply: in the format of a message (a response), or in one of its own. */
struct log_reply {
    const char *replier;
    const uint8_t *data;
    size_t length;
    enum byte_order order;
    struct message *message; /* NULL: format says it */
    const struct format *format;
};

void log_replied(struct log *log, const struct dispatch *dispatch, const struct log_reply *reply);

/* Dropped, because as many wait as may. */
void log_limited(struct log *log, const struct dispatch *dispatch);

/* Given up, because its module has ended. */
void log_cleared(struct log *log, const struct dispatch *dispatch);

/* Handed from the stand-in of its message to a resource. */
void log_transferred(struct log *log, const struct dispatch *dispatch,
                     const struct resource *resource);

#endif
