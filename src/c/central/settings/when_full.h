/*
 * What becomes of a queue that is full: the policies, and which module has which.
 */
#ifndef IPC_CENTRAL_WHEN_FULL_H
#define IPC_CENTRAL_WHEN_FULL_H

#include "base/list.h"

enum when_full {
    WHEN_FULL_WAIT,      /* senders wait for a receiver that works; else as WHEN_FULL_NEWEST */
    WHEN_FULL_NEWEST,    /* the oldest messages are given up for new ones */
    WHEN_FULL_OLDEST,    /* new messages are given up */
    WHEN_FULL_DISCONNECT /* the receiver's connection ends */
};

/* What an operator has chosen, with --when-full=[<module>:]<policy>. */
struct full_policies {
    enum when_full standard;
    struct list of_modules; /* owned; the newest first */
};

void full_policies_init(struct full_policies *policies);
void full_policies_fini(struct full_policies *policies);

/* Chooses by "policy" or "module:policy": 0, or ERR_UNKNOWN (no such policy, or no name). */
int full_policies_set(struct full_policies *policies, const char *choice);

/* The policy for the queues of modules of that name. */
enum when_full full_policies_of(const struct full_policies *policies, const char *module);

#endif
