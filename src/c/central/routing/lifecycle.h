/*
 * How a server begins and ends, and how connections join it.
 */
#ifndef IPC_CENTRAL_LIFECYCLE_H
#define IPC_CENTRAL_LIFECYCLE_H

#include "central/routing/server.h"

/* A server without connections; terminal_fd is where its terminal log goes (-1: nowhere). */
void server_init(struct server *server, struct options *options, int terminal_fd, uint64_t now_ns);

/* Ends all connections without a word. */
void server_fini(struct server *server);

/* Takes a connected socket over (-1: memory) and greets it. */
struct module *server_add_connection(struct server *server, int fd);

/* Makes the names in the options' ignore set effective. */
void server_ignore_names(struct server *server);

#endif
