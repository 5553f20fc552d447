/*
 * Taps: a second message that carries the data of each instance of a first one.
 *
 * Kept for modules of an older library; modules of today never ask for them.
 * Only the condition "when sent" ever fires here; taps on later stages of a
 * delivery are taken note of, so that they show in the list of tapped messages.
 */
#ifndef IPC_CENTRAL_TAP_H
#define IPC_CENTRAL_TAP_H

#include "central/routing/server.h"

enum { TAP_WHEN_SENT = 1, TAP_LAST_CONDITION = 18 };

struct tap_entry {
    int condition;
    struct message *listening;
    struct list in_message; /* the tapped one's */
};

/* Adds a tap; ERR_LIMIT when the message has too many, 0 also for one that exists. */
int tap_add(struct server *server, struct message *tapped, struct message *listening,
            int condition);

/* Removes a tap: 0 or ERR_UNKNOWN. */
int tap_remove(struct server *server, struct message *tapped, const struct message *listening,
               int condition);

void tap_free_all(struct server *server);

#endif
