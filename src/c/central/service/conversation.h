/*
 * The conversation with modules: bytes in, frames handled, one turn after
 * another.
 *
 * In a turn every connection that has something to say is heard for a bounded
 * time; what is to be sent gathers and leaves at the end of the turn.
 */
#ifndef IPC_CENTRAL_CONVERSATION_H
#define IPC_CENTRAL_CONVERSATION_H

#include "central/routing/server.h"

/* Reads from a module's socket, unless bytes of it wait to be handled. */
void conversation_read(struct server *server, struct module *module);

/* The other side has gone; reads what it has left. */
void conversation_hung_up(struct server *server, struct module *module);

/* Puts bytes where a socket would have put them, as many as there is room for before a turn:
 * returns how many. */
size_t conversation_feed(struct server *server, struct module *module, const void *bytes,
                         size_t count);

/* Tells that no more bytes will come. */
void conversation_end_input(struct server *server, struct module *module);

/* Handles what has come in, within this turn's measure of each connection; then settles what is
 * due.  What is to be sent is then in server.urgent and server.flush. */
void conversation_turn(struct server *server);

/* Whether work is left for the next turn. */
bool conversation_is_pending(const struct server *server);

/* Unsent bytes of a module have left, or have not: released what waited for room. */
void conversation_flushed(struct server *server, struct module *module);

/* Ends connections that have used up all patience.  Returns when to look again (UINT64_MAX: at
 * the next event). */
uint64_t conversation_check_patience(struct server *server);

#endif
