/*
 * The list of active broadcasts: the variable by which modules know what is
 * worth sending.
 *
 * It names every broadcast message that somebody is subscribed to, undefined
 * ones included.  A listening module does not send what is not in the list.
 */
#ifndef IPC_CENTRAL_BROADCASTS_H
#define IPC_CENTRAL_BROADCASTS_H

#include "central/routing/server.h"

/* Puts a message that has (or is about to have) so many subscriptions in or out of the list, and
 * tells everybody if that changes it. */
void broadcasts_update(struct server *server, struct message *message, size_t n_subscriptions);

/* The same without telling; returns whether the list has changed. */
bool broadcasts_put(struct server *server, struct message *message, size_t n_subscriptions);

/* Tells everybody the list as it is. */
void broadcasts_tell(struct server *server);

#endif
