/*
 * Who handles a message, and how its modules can be reached directly.
 *
 * Told to anybody who asks.  For messages in direct mode, and for those whose
 * changes somebody wants to know, the list is also kept as a variable named
 * like the message.
 */
#ifndef IPC_CENTRAL_HANDLER_LIST_H
#define IPC_CENTRAL_HANDLER_LIST_H

#include "central/routing/server.h"

/* Fills in the list, newest subscription first; what it points to is valid until the next change.
 * Give it back with handler_list_fini. */
void handler_list_init(struct server *server, struct handler_list *list,
                       const struct message *message);
void handler_list_fini(struct handler_list *list);

/* Keeps the list as a variable from now on, or from the definition of the message on. */
void handler_list_keep(struct server *server, struct message *message);

/* The list may have changed. */
void handler_list_changed(struct server *server, const struct message *message);

#endif
