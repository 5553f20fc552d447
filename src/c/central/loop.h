/*
 * The loop: the server's sockets, streams and signals.
 *
 * Waits until something is there, lets the conversation have its turn, and
 * writes what has gathered.  Nothing here waits for a single module.
 */
#ifndef IPC_CENTRAL_LOOP_H
#define IPC_CENTRAL_LOOP_H

#include "central/operator/console.h"
#include "central/listeners.h"
#include "central/operator/metrics_server.h"
#include "central/model/presence.h"
#include "central/routing/server.h"
#include "platform/platform.h"

struct loop {
    struct server *server;
    struct console console;
    struct poller *poller;
    struct waker waker;
    struct listeners listeners;
    struct metrics_server metrics;
    struct presence presence;
    bool reads_input;        /* commands are read from standard input */
    bool input_is_unwatched; /* ... which cannot be watched: it is read in every turn */
    bool watches_output;     /* standard output takes nothing at the moment */
    int signal;              /* that ends the server; 0: none */
};

/* 0, or ERR_IO when the system refuses what every loop needs. */
int loop_init(struct loop *loop, struct server *server);
void loop_fini(struct loop *loop);

/* Serves until a command or a signal ends it. */
void loop_run(struct loop *loop);

/* Gives those who read a last chance to get what is on its way to them: a second at most. */
void loop_say_last_words(struct loop *loop);

#endif
