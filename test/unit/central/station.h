/*
 * Conversations with a server in memory: a station is a server, a peer is a
 * module made by hand.  Nothing here needs a socket, and time passes only when
 * a test says so.
 */
#ifndef TEST_CENTRAL_STATION_H
#define TEST_CENTRAL_STATION_H

#include "unit.h"

#include <stdbool.h>

#include "central/service/conversation.h"
#include "central/routing/server.h"

struct station {
    struct options options;
    struct server server;
    struct list peers;
};

/* Options are the arguments of a command line, ended by NULL; the server is told it is 1000 s. */
void station_open(struct station *station, const char *const *arguments);

/* Ends all peers and checks that nothing is left over. */
void station_close(struct station *station);

/* Lets the server handle everything that has come in. */
void station_run(struct station *station);

/* Lets time pass, and the server lose its patience. */
void station_pass_time(struct station *station, uint64_t seconds);

/* What the terminal log has written since it was last asked; valid until then. */
const char *station_log(struct station *station);

struct peer {
    struct list in_station;
    struct station *station;
    const char *name;
    struct module *module;
    struct reader reader;
    struct buffer input; /* raw, before the reader takes it */
    size_t taken;        /* of it, by the reader */
    int last_reference;
    enum byte_order order;
};

/* A connection that has not said anything yet; its greeting has been read and checked. */
void peer_greet(struct station *station, struct peer *peer, const char *name);

/* The shortest handshake: introduction and start. */
void peer_connect(struct station *station, struct peer *peer, const char *name);

/* Its connection is gone. */
void peer_lose(struct peer *peer);

/* The same, and nothing is left of the peer. */
void peer_leave(struct peer *peer);

/* Whether the server has closed the connection. */
bool peer_is_closed(const struct peer *peer);

/* --------------------------------------------------------------------- frames */

/* A frame with the peer's next reference. */
void peer_frame(struct peer *peer, struct frame *frame, enum frame_class class, int intent);

void peer_send(struct peer *peer, const struct frame *frame);
void peer_send_bytes(struct peer *peer, const void *bytes, size_t count);

/* The next frame from the server after it has handled everything: false when there is none. */
bool peer_receive(struct peer *peer, struct frame *frame);

/* The next frame has to be this. */
void peer_expect_nothing(struct peer *peer);

/* A delivery, ready for comparison: "<handler> <message> <number>" or "none". */
const char *peer_delivery(struct peer *peer, struct frame *frame);

/* Checks that the next deliveries are these, separated by commas, acknowledging each. */
void peer_expect(struct peer *peer, const char *deliveries);

void peer_acknowledge(struct peer *peer, const struct frame *delivery);
void peer_respond(struct peer *peer, const struct frame *delivery, const char *message, int number);

/* ------------------------------------------------------------------- requests */

/* Looks a name up: its number (0: unknown, or not defined). */
int peer_id_of(struct peer *peer, const char *name);

/* Sends a library message and returns its reference. */
int peer_tell(struct peer *peer, enum library_message which, const void *payload);

/* Asks, and decodes the answer into reply (which the caller releases with the catalogue's format);
 * false for an answer without data.  The answer has to be the next frame. */
bool peer_ask(struct peer *peer, enum library_message which, const void *payload, void *reply);

void peer_define(struct peer *peer, const char *name, const char *content);
void peer_subscribe(struct peer *peer, const char *message, int id);
void peer_unsubscribe(struct peer *peer, const char *message, int id);
void peer_set_capacity(struct peer *peer, int capacity);
void peer_set_limit(struct peer *peer, const char *message, int limit);
void peer_set_priority(struct peer *peer, const char *message, int priority);

/* Publishes, or asks (returns the reference), with one int as content. */
void peer_publish(struct peer *peer, const char *message, int number);
int peer_query(struct peer *peer, const char *message, int number);

#endif
