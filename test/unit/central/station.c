/*
 * A server in memory, and modules made by hand.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/routing/ending.h"
#include "central/routing/lifecycle.h"
#include "central/routing/outbox.h"
#include "central/routing/watch.h"
#include "central/settings/command_line.h"

enum { MAX_ARGUMENTS = 16, GREETING_SIZE = 137 };

#define START_NS UINT64_C(1000000000000)

/* -------------------------------------------------------------------- station */

void station_open(struct station *station, const char *const *arguments)
{
    char *words[MAX_ARGUMENTS] = {(char *)(uintptr_t) "central"};
    int count = 1;
    struct buffer out, errors;
    const struct options_output output = {&out, &errors};
    buffer_init(&out);
    buffer_init(&errors);
    options_init(&station->options);
    while (arguments != NULL && *arguments != NULL) {
        words[count++] = (char *)(uintptr_t)*arguments++;
    }
    assert_int_equal(options_parse(&station->options, count, words, &output), OPTIONS_GO);
    assert_int_equal(errors.length, 0);
    buffer_fini(&out);
    buffer_fini(&errors);
    list_init(&station->peers);
    server_init(&station->server, &station->options, -1, START_NS);
}

void station_close(struct station *station)
{
    struct list *at, *following;
    LIST_EACH (at, following, &station->peers) {
        peer_leave(LIST_OWNER(at, struct peer, in_station));
    }
    assert_true(list_is_empty(&station->server.modules));
    server_fini(&station->server);
    options_fini(&station->options);
}

/* What a loop does between two turns, with memory in place of sockets. */
static void flush(struct list *modules)
{
    struct list *at, *following;
    LIST_EACH (at, following, modules) {
        list_remove(at);
        LIST_OWNER(at, struct module, in_flush)->urgent = false;
    }
}

void station_run(struct station *station)
{
    struct server *server = &station->server;
    do {
        conversation_turn(server);
        outbox_let_go(server);
        flush(&server->urgent);
        flush(&server->flush);
    } while (conversation_is_pending(server));
    ending_sweep(server);
}

void station_pass_time(struct station *station, uint64_t seconds)
{
    server_set_time(&station->server, station->server.now_ns + seconds * UINT64_C(1000000000));
    (void)conversation_check_patience(&station->server);
    station_run(station);
}

const char *station_log(struct station *station)
{
    static char text[1 << 16];
    struct sink *sink = &station->server.log.terminal;
    const size_t length = sink_waiting(sink);
    assert_true(length < sizeof text);
    if (length > 0) {
        memcpy(text, sink->waiting.bytes + sink->start, length);
    }
    text[length] = '\0';
    sink->start = 0;
    buffer_clear(&sink->waiting);
    return text;
}

/* ---------------------------------------------------------------------- frames */

static void take_output(struct peer *peer)
{
    station_run(peer->station);
    if (peer->module->state != MODULE_ENDED) {
        assert_int_equal(link_take(&peer->module->link, &peer->input), 0);
        /* What waited for bytes to leave may now go. */
        watch_look_at(&peer->station->server, peer->module);
        conversation_flushed(&peer->station->server, peer->module);
        station_run(peer->station);
        assert_int_equal(link_take(&peer->module->link, &peer->input), 0);
    }
}

/* Gives the reader some of the bytes that have come; false when there are none. */
static bool feed_reader(struct peer *peer)
{
    size_t room;
    const size_t left = peer->input.length - peer->taken;
    if (left == 0) {
        buffer_clear(&peer->input);
        peer->taken = 0;
        return false;
    }
    uint8_t *space = reader_space(&peer->reader, &room);
    const size_t taken = left < room ? left : room;
    memcpy(space, peer->input.bytes + peer->taken, taken);
    reader_filled(&peer->reader, taken);
    peer->taken += taken;
    return true;
}

bool peer_receive(struct peer *peer, struct frame *frame)
{
    int result = reader_next(&peer->reader, frame);
    bool asked = false;
    while (result == 0) {
        if (!feed_reader(peer)) {
            if (asked) {
                return false;
            }
            take_output(peer);
            asked = true;
        }
        result = reader_next(&peer->reader, frame);
    }
    assert_int_equal(result, 1);
    return true;
}

void peer_send_bytes(struct peer *peer, const void *bytes, size_t count)
{
    const uint8_t *at = bytes;
    while (count > 0 && peer->module->state != MODULE_ENDED) {
        const size_t taken = conversation_feed(&peer->station->server, peer->module, at, count);
        at += taken;
        count -= taken;
        if (count > 0) {
            station_run(peer->station);
        }
    }
}

void peer_send(struct peer *peer, const struct frame *frame)
{
    uint8_t header[FRAME_HEADER_SIZE];
    frame_write_header(frame, header);
    peer_send_bytes(peer, header, sizeof header);
    peer_send_bytes(peer, frame->class_data, frame->class_data == NULL ? 0 : frame->class_length);
    peer_send_bytes(peer, frame->data, frame->data == NULL ? 0 : frame->data_length);
}

void peer_frame(struct peer *peer, struct frame *frame, enum frame_class class, int intent)
{
    frame_init(frame, class);
    frame->intent = intent;
    frame->reference = ++peer->last_reference;
}

void peer_expect_nothing(struct peer *peer)
{
    struct frame frame;
    assert_false(peer_receive(peer, &frame));
}

static int number_in(const struct frame *frame)
{
    assert_int_equal(frame->data_length, 12);
    return (int)load_32(frame->data + 8, (enum byte_order)frame->data_order);
}

const char *peer_delivery(struct peer *peer, struct frame *frame)
{
    static char text[200];
    if (!peer_receive(peer, frame)) {
        return "none";
    }
    assert_true(frame->class == CLASS_BROADCAST || frame->class == CLASS_QUERY ||
                frame->class == CLASS_INFORM);
    assert_int_equal(frame->dispatch, NO_ID);
    assert_true(frame->reference >= 0);
    assert_true(frame->class_length > 4);
    assert_int_equal(load_32(frame->class_data, (enum byte_order)frame->class_order),
                     frame->class_length - 4);
    (void)snprintf(text, sizeof text, "%d %.*s %d", (int)frame->intent,
                   (int)frame->class_length - 4, (const char *)frame->class_data + 4,
                   number_in(frame));
    return text;
}

void peer_expect(struct peer *peer, const char *deliveries)
{
    char found[1000] = "";
    size_t length = 0;
    struct frame frame;
    for (const char *at = deliveries; at != NULL; at = strchr(at + 1, ',')) {
        length += (size_t)snprintf(found + length, sizeof found - length, "%s%s",
                                   length == 0 ? "" : ", ", peer_delivery(peer, &frame));
        peer_acknowledge(peer, &frame);
    }
    assert_string_equal(found, deliveries);
}

void peer_acknowledge(struct peer *peer, const struct frame *delivery)
{
    struct frame frame;
    frame_init(&frame, CLASS_SUCCESS);
    frame.parent = delivery->reference;
    frame.dispatch = delivery->reference;
    peer_send(peer, &frame);
}

/* Fills in an int as the content of a message of variable length. */
static void set_number(struct frame *frame, uint8_t data[12], int number)
{
    const int length = (int)sizeof number;
    memcpy(data, &length, sizeof length);
    memcpy(data + 4, &length, sizeof length);
    memcpy(data + 8, &number, sizeof number);
    frame->data = data;
    frame->data_length = 12;
}

void peer_respond(struct peer *peer, const struct frame *delivery, const char *message, int number)
{
    uint8_t data[12];
    uint8_t name[100];
    struct frame frame;
    const uint32_t length = (uint32_t)strlen(message);
    frame_init(&frame, CLASS_REPLY);
    frame.parent = delivery->reference;
    frame.dispatch = delivery->reference;
    memcpy(name, &length, sizeof length);
    memcpy(name + sizeof length, message, length);
    frame.class_data = name;
    frame.class_length = (uint32_t)sizeof length + length;
    set_number(&frame, data, number);
    peer_send(peer, &frame);
}

/* -------------------------------------------------------------------- requests */

static const struct catalogue *catalogue_of(const struct peer *peer)
{
    return &peer->station->server.catalogue;
}

/* Sends a frame of the message's class with an encoded payload. */
static int send_payload(struct peer *peer, enum library_message which, int id, const void *payload)
{
    struct buffer data;
    struct frame frame;
    const struct format *format = catalogue_of(peer)->request[which];
    buffer_init(&data);
    if (format != NULL) {
        assert_int_equal(format_encode(format, payload, peer->order, &data), 0);
    }
    peer_frame(peer, &frame, (enum frame_class)library_messages[which].class, id);
    frame.data = data.bytes;
    frame.data_length = (uint32_t)data.length;
    frame.data_order = (uint8_t)peer->order;
    peer_send(peer, &frame);
    buffer_fini(&data);
    return frame.reference;
}

/* Receives the answer to that reference: whether it has data, which are decoded. */
static bool receive_answer(struct peer *peer, int reference, const struct format *format,
                           void *reply)
{
    struct frame frame;
    assert_true(peer_receive(peer, &frame));
    assert_int_equal(frame.class, CLASS_NONE);
    assert_int_equal(frame.intent, INTENT_REPLY);
    assert_int_equal(frame.reference, reference);
    assert_int_equal(frame.parent, 0);
    assert_int_equal(frame.dispatch, 0);
    if (frame.data_length == 0) {
        return false;
    }
    assert_int_equal(payload_decode(format, frame.data, frame.data_length,
                                    (enum byte_order)frame.data_order, reply),
                     0);
    return true;
}

static int look_up(struct peer *peer, const char *name)
{
    const struct message_info_request request = {(char *)(uintptr_t)name, NULL};
    const struct format *format = catalogue_of(peer)->reply[LM_MESSAGE_INFO];
    struct optional_message_info reply = {NULL};
    const int first = peer->station->server.library[LM_MESSAGE_INFO]->id;
    const int reference = send_payload(peer, LM_MESSAGE_INFO, first, &request);
    assert_true(receive_answer(peer, reference, format, &reply));
    const int id = reply.info == NULL ? 0 : reply.info->id;
    (void)format_release(format, &reply);
    return id;
}

int peer_id_of(struct peer *peer, const char *name)
{
    return look_up(peer, name);
}

/* The number of a library message, without asking: tests of the look-up ask. */
static int id_of(const struct peer *peer, enum library_message which)
{
    return peer->station->server.library[which]->id;
}

int peer_tell(struct peer *peer, enum library_message which, const void *payload)
{
    return send_payload(peer, which, id_of(peer, which), payload);
}

bool peer_ask(struct peer *peer, enum library_message which, const void *payload, void *reply)
{
    const int reference = peer_tell(peer, which, payload);
    return receive_answer(peer, reference, catalogue_of(peer)->reply[which], reply);
}

void peer_greet(struct station *station, struct peer *peer, const char *name)
{
    const uint8_t *number;
    struct frame frame;
    memset(peer, 0, sizeof *peer);
    peer->station = station;
    peer->name = name;
    peer->order = byte_order_of_host();
    reader_init(&peer->reader, FROM_CENTRAL);
    buffer_init(&peer->input);
    list_append(&station->peers, &peer->in_station);
    peer->module = module_ref(server_add_connection(&station->server, -1));
    assert_int_equal(link_waiting(&peer->module->link), GREETING_SIZE);
    take_output(peer);
    size_t room;
    memcpy(reader_space(&peer->reader, &room), peer->input.bytes, GREETING_SIZE);
    reader_filled(&peer->reader, GREETING_SIZE);
    buffer_clear(&peer->input);
    assert_int_equal(reader_take_raw(&peer->reader, 4, &number), 1);
    assert_int_equal(load_be32(number), id_of(peer, LM_MESSAGE_INFO));
    assert_true(peer_receive(peer, &frame));
    assert_true(peer_receive(peer, &frame));
}

void peer_connect(struct station *station, struct peer *peer, const char *name)
{
    struct introduction_reply version;
    int yes = 0;
    peer_greet(station, peer, name);
    const struct introduction introduction = {(char *)(uintptr_t)name, (char *)(uintptr_t) "robot"};
    assert_true(peer_ask(peer, LM_INTRODUCTION, &introduction, &version));
    assert_int_equal(version.major, 3);
    assert_true(peer_ask(peer, LM_READY, NULL, &yes));
    assert_int_equal(yes, 1);
}

void peer_lose(struct peer *peer)
{
    if (peer->module->state != MODULE_ENDED) {
        conversation_end_input(&peer->station->server, peer->module);
    }
    station_run(peer->station);
    assert_true(peer_is_closed(peer));
}

void peer_leave(struct peer *peer)
{
    peer_lose(peer);
    list_remove(&peer->in_station);
    module_unref(peer->module);
    reader_fini(&peer->reader);
    buffer_fini(&peer->input);
}

bool peer_is_closed(const struct peer *peer)
{
    return peer->module->state == MODULE_ENDED;
}

void peer_define(struct peer *peer, const char *name, const char *content)
{
    const struct message_definition definition = {(char *)(uintptr_t)name, CLASS_BROADCAST,
                                                  (char *)(uintptr_t) "{int, <byte:1>}",
                                                  (char *)(uintptr_t)content};
    (void)peer_tell(peer, LM_DEFINE_MESSAGE, &definition);
}

/* The handler's name follows from message and number. */
static void tell_subscription(struct peer *peer, enum library_message which, const char *message,
                              int id)
{
    char handler[200];
    (void)snprintf(handler, sizeof handler, "HND-%s%d", message, id);
    const struct subscription_notice notice = {id, (char *)(uintptr_t)message, handler};
    (void)peer_tell(peer, which, &notice);
}

void peer_subscribe(struct peer *peer, const char *message, int id)
{
    tell_subscription(peer, LM_SUBSCRIBE, message, id);
    station_run(peer->station);
}

void peer_unsubscribe(struct peer *peer, const char *message, int id)
{
    tell_subscription(peer, LM_UNSUBSCRIBE, message, id);
    station_run(peer->station);
}

void peer_set_capacity(struct peer *peer, int capacity)
{
    const struct number_and_name payload = {capacity, (char *)(uintptr_t)peer->name};
    (void)peer_tell(peer, LM_RESOURCE, &payload);
    station_run(peer->station);
}

void peer_set_limit(struct peer *peer, const char *message, int limit)
{
    const struct pending_limit payload = {(char *)(uintptr_t)message, (char *)(uintptr_t)peer->name,
                                          limit};
    (void)peer_tell(peer, LM_LIMIT_PENDING, &payload);
    station_run(peer->station);
}

void peer_set_priority(struct peer *peer, const char *message, int priority)
{
    const struct name_and_number payload = {(char *)(uintptr_t)message, priority};
    (void)peer_tell(peer, LM_PRIORITY, &payload);
    station_run(peer->station);
}

static int send_number(struct peer *peer, enum frame_class class, const char *message, int number)
{
    uint8_t data[12];
    struct frame frame;
    peer_frame(peer, &frame, class, message_find(&peer->station->server.messages, message)->id);
    set_number(&frame, data, number);
    peer_send(peer, &frame);
    station_run(peer->station);
    return frame.reference;
}

void peer_publish(struct peer *peer, const char *message, int number)
{
    (void)send_number(peer, CLASS_BROADCAST, message, number);
}

int peer_query(struct peer *peer, const char *message, int number)
{
    return send_number(peer, CLASS_QUERY, message, number);
}
