/*
 * Publications: who gets them, in what order, how many at a time.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "central/routing/variable.h"

struct pair {
    struct station station;
    struct peer sender;
    struct peer receiver;
};

/* A sender that has defined some messages, and a receiver that handles them with the number that is
 * the letter's code. */
static void open_pair(struct pair *pair, const char *messages)
{
    station_open(&pair->station, NULL);
    peer_connect(&pair->station, &pair->sender, "S");
    peer_connect(&pair->station, &pair->receiver, "R");
    for (; *messages != '\0'; messages++) {
        const char name[2] = {*messages, '\0'};
        peer_define(&pair->sender, name, "int");
        station_run(&pair->station);
        peer_subscribe(&pair->receiver, name, *messages);
    }
}

/* Publishes what a text like "A0 B1" says. */
static void publish_all(struct pair *pair, const char *text)
{
    for (; *text != '\0'; text += text[2] == '\0' ? 2 : 3) {
        const char name[2] = {text[0], '\0'};
        peer_publish(&pair->sender, name, text[1] - '0');
    }
}

/* Checks that the receiver gets what a text like "A0 B1" says, acknowledging each. */
static void expect_all(struct pair *pair, const char *text)
{
    char found[200] = "";
    struct frame frame;
    while (strcmp(peer_delivery(&pair->receiver, &frame), "none") != 0) {
        (void)snprintf(found + strlen(found), sizeof found - strlen(found), "%s%c%d",
                       found[0] == '\0' ? "" : " ", frame.class_data[4],
                       (int)load_32(frame.data + 8, (enum byte_order)frame.data_order));
        peer_acknowledge(&pair->receiver, &frame);
    }
    assert_string_equal(found, text);
}

/* Nothing is under way any more once all acknowledgements have been handled. */
static void close_pair(struct pair *pair)
{
    station_run(&pair->station);
    assert_int_equal(pair->station.server.dispatches.numbers.in_use, 0);
    station_close(&pair->station);
}

/* ------------------------------------------------------------------- delivery */

static void a_publication_reaches_every_handler_oldest_subscription_first(void **state)
{
    struct station station;
    struct peer sender, first, second;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &sender, "S");
    peer_connect(&station, &first, "A");
    peer_connect(&station, &second, "B");
    peer_set_capacity(&first, 10);
    peer_define(&sender, "M", "int");
    station_run(&station);
    peer_subscribe(&first, "M", 30);
    peer_subscribe(&second, "M", 20);
    peer_subscribe(&first, "M", 10);
    peer_subscribe(&sender, "M", 1);
    peer_publish(&sender, "m", 7);
    peer_expect(&first, "30 M 7, 10 M 7");
    peer_expect(&second, "20 M 7");
    peer_expect(&sender, "1 M 7");
    peer_expect_nothing(&first);
    station_close(&station);
}

static void a_delivery_is_the_frame_as_it_came(void **state)
{
    struct pair pair;
    struct frame frame, got;
    const uint8_t data[] = {0, 0, 0, 4, 0, 0, 0, 4, 0x12, 0x34, 0x56, 0x78};
    (void)state;
    open_pair(&pair, "M");
    peer_frame(&pair.sender, &frame, CLASS_BROADCAST,
               message_find(&pair.station.server.messages, "M")->id);
    frame.data = data;
    frame.data_length = sizeof data;
    frame.data_order = ORDER_BIG;
    frame.parent = 77;
    peer_send(&pair.sender, &frame);
    assert_true(peer_receive(&pair.receiver, &got));
    assert_int_equal(got.class, CLASS_BROADCAST);
    assert_int_equal(got.data_order, ORDER_BIG);
    assert_int_equal(got.class_order, byte_order_of_host());
    assert_int_equal(got.parent, 77);
    assert_int_equal(got.dispatch, NO_ID);
    assert_int_equal(got.data_length, sizeof data);
    assert_memory_equal(got.data, data, sizeof data);
    peer_acknowledge(&pair.receiver, &got);
    close_pair(&pair);
}

static void data_of_any_size_arrives_whole_also_after_waiting(void **state)
{
    static const size_t sizes[] = {0, 1, 28, 4095, 4096, 4097, 16384, 16385, 300000};
    struct pair pair;
    struct frame frame, got;
    (void)state;
    open_pair(&pair, "M");
    uint8_t *data = malloc(300000);
    for (size_t i = 0; i < 300000; i++) {
        data[i] = (uint8_t)(i * 7);
    }
    for (size_t i = 0; i < N_ELEMENTS(sizes); i++) {
        peer_frame(&pair.sender, &frame, CLASS_BROADCAST,
                   message_find(&pair.station.server.messages, "M")->id);
        frame.data = data;
        frame.data_length = (uint32_t)sizes[i];
        peer_send(&pair.sender, &frame);
    }
    for (size_t i = 0; i < N_ELEMENTS(sizes); i++) {
        assert_true(peer_receive(&pair.receiver, &got));
        assert_int_equal(got.data_length, sizes[i]);
        assert_memory_equal(got.data, data, sizes[i]);
        peer_acknowledge(&pair.receiver, &got);
    }
    free(data);
    close_pair(&pair);
}

static void publications_without_handler_vanish(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "");
    peer_define(&pair.sender, "M", "int");
    station_run(&pair.station);
    peer_publish(&pair.sender, "M", 1);
    peer_subscribe(&pair.receiver, "M", 5);
    peer_publish(&pair.sender, "M", 2);
    peer_expect(&pair.receiver, "5 M 2");
    peer_expect_nothing(&pair.receiver);
    close_pair(&pair);
}

static void the_first_number_of_a_handler_name_remains_valid(void **state)
{
    struct pair pair;
    const struct subscription_notice again = {0, (char *)(uintptr_t) "M",
                                              (char *)(uintptr_t) "HND-M5"};
    (void)state;
    open_pair(&pair, "");
    peer_define(&pair.sender, "M", "int");
    peer_subscribe(&pair.receiver, "M", 5);
    (void)peer_tell(&pair.receiver, LM_SUBSCRIBE, &again);
    station_run(&pair.station);
    peer_publish(&pair.sender, "M", 1);
    peer_expect(&pair.receiver, "5 M 1");
    peer_expect_nothing(&pair.receiver);
    peer_unsubscribe(&pair.receiver, "M", 5);
    peer_publish(&pair.sender, "M", 2);
    peer_expect_nothing(&pair.receiver);
    (void)peer_tell(&pair.receiver, LM_SUBSCRIBE, &again);
    station_run(&pair.station);
    peer_publish(&pair.sender, "M", 3);
    peer_expect(&pair.receiver, "5 M 3");
    close_pair(&pair);
}

static void what_waits_for_a_removed_handler_still_comes(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "M");
    publish_all(&pair, "M0 M1 M2");
    peer_unsubscribe(&pair.receiver, "M", 'M');
    expect_all(&pair, "M0 M1 M2");
    close_pair(&pair);
}

/* ------------------------------------------------------- capacity and pending */

static void one_delivery_at_a_time_is_the_default(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "M");
    publish_all(&pair, "M0 M1");
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    peer_expect_nothing(&pair.receiver);
    peer_acknowledge(&pair.receiver, &frame);
    peer_expect(&pair.receiver, "77 M 1");
    close_pair(&pair);
}

static void a_raised_capacity_is_filled_at_once(void **state)
{
    struct pair pair;
    struct frame first, frame;
    (void)state;
    open_pair(&pair, "M");
    publish_all(&pair, "M0 M1 M2 M3");
    assert_string_equal(peer_delivery(&pair.receiver, &first), "77 M 0");
    peer_set_capacity(&pair.receiver, 3);
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 1");
    peer_acknowledge(&pair.receiver, &frame);
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 2");
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 3");
    peer_set_capacity(&pair.receiver, -5);
    assert_int_equal(pair.receiver.module->own->capacity, 1);
    station_close(&pair.station);
}

static void the_observed_sequences_of_limits_and_priorities(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "M");
    peer_set_limit(&pair.receiver, "M", 3);
    publish_all(&pair, "M1 M2 M3 M4 M5 M6 M7 M8");
    expect_all(&pair, "M1 M6 M7 M8");
    close_pair(&pair);

    open_pair(&pair, "NLH");
    peer_set_priority(&pair.sender, "L", 1);
    peer_set_priority(&pair.sender, "H", 9);
    publish_all(&pair, "N0 N1 L2 H3 N4 L5 H6");
    expect_all(&pair, "N0 H3 H6 L2 L5 N1 N4");
    close_pair(&pair);

    open_pair(&pair, "ABC");
    peer_set_priority(&pair.receiver, "B", 0);
    publish_all(&pair, "A0 A1 B2 C3 B4");
    expect_all(&pair, "A0 B2 B4 A1 C3");
    close_pair(&pair);
}

static void a_limit_of_the_resource_and_a_limit_of_0(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "AB");
    peer_set_limit(&pair.receiver, NULL, 2);
    publish_all(&pair, "A0 A1 B2 A3 B4");
    expect_all(&pair, "A0 A3 B4");
    close_pair(&pair);

    open_pair(&pair, "AB");
    peer_set_limit(&pair.receiver, "A", 0);
    publish_all(&pair, "A0 A1 B2 A3");
    expect_all(&pair, "A0 B2");
    close_pair(&pair);
}

static void a_full_queue_loses_its_oldest_and_says_so_once(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "M");
    pair.station.options.limits.pending_messages = 3;
    (void)station_log(&pair.station);
    publish_all(&pair, "M0 M1 M2 M3 M4 M5 M6");
    const char *text = station_log(&pair.station);
    const char *warning =
        strstr(text, "WARNING: R on robot: the queue of R is full: M of S is dropped, "
                     "the newest messages are kept\n");
    assert_non_null(warning);
    assert_null(strstr(warning + 1, "WARNING"));
    assert_int_equal(pair.station.server.statistics.n_dropped, 3);
    expect_all(&pair, "M0 M4 M5 M6");
    station_pass_time(&pair.station, 1); /* the receiver counts as stopped again */
    publish_all(&pair, "M0 M1 M2 M3 M4");
    assert_non_null(strstr(station_log(&pair.station), "is full"));
    expect_all(&pair, "M0 M2 M3 M4");
    close_pair(&pair);
}

static void a_queue_is_bounded_in_bytes_too(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "M");
    pair.station.options.limits.pending_bytes = 3 * 12;
    publish_all(&pair, "M0 M1 M2 M3 M4 M5");
    expect_all(&pair, "M0 M3 M4 M5");
    close_pair(&pair);
}

static void unsent_bytes_hold_the_queue_back_but_lose_nothing(void **state)
{
    struct pair pair;
    (void)state;
    open_pair(&pair, "M");
    peer_set_capacity(&pair.receiver, 1000);
    pair.station.options.limits.out_queue = 100;
    publish_all(&pair, "M0 M1 M2 M3 M4 M5");
    assert_true(link_waiting(&pair.receiver.module->link) < 200);
    assert_true(pair.receiver.module->own->pending.count > 0);
    expect_all(&pair, "M0 M1 M2 M3 M4 M5");
    close_pair(&pair);
}

static void a_module_that_never_reads_is_let_go_in_the_end(void **state)
{
    struct pair pair;
    const struct message_info_request request = {(char *)(uintptr_t) "M", NULL};
    (void)state;
    open_pair(&pair, "M");
    pair.station.options.limits.out_queue = 100;
    pair.station.options.limits.data = 100;
    for (int i = 0; i < 10; i++) {
        (void)peer_tell(&pair.receiver, LM_MESSAGE_INFO, &request);
    }
    station_run(&pair.station);
    conversation_flushed(&pair.station.server, pair.receiver.module);
    station_pass_time(&pair.station, 29);
    conversation_flushed(&pair.station.server, pair.receiver.module);
    assert_false(peer_is_closed(&pair.receiver));
    station_pass_time(&pair.station, 2);
    conversation_flushed(&pair.station.server, pair.receiver.module);
    assert_true(peer_is_closed(&pair.receiver));
    station_close(&pair.station);
}

/* ------------------------------------------------------------- acknowledgements */

static void late_double_and_foreign_acknowledgements_count_for_nothing(void **state)
{
    struct pair pair;
    struct frame frame, foreign;
    (void)state;
    open_pair(&pair, "M");
    publish_all(&pair, "M0 M1 M2");
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    foreign = frame;
    peer_acknowledge(&pair.sender, &frame);
    peer_expect_nothing(&pair.receiver);
    peer_acknowledge(&pair.receiver, &frame);
    peer_acknowledge(&pair.receiver, &foreign);
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 1");
    peer_expect_nothing(&pair.receiver);
    peer_acknowledge(&pair.receiver, &frame);
    peer_expect(&pair.receiver, "77 M 2");
    station_run(&pair.station);
    assert_non_null(strstr(station_log(&pair.station), "WARNING: S on robot: it reports delivery"));
    close_pair(&pair);
}

static void failures_and_responses_end_a_delivery_as_well(void **state)
{
    struct pair pair;
    struct frame frame, failure;
    const uint8_t reason[] = "\4\0\0\0oops";
    (void)state;
    open_pair(&pair, "M");
    publish_all(&pair, "M0 M1 M2");
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    frame_init(&failure, CLASS_FAILURE);
    failure.dispatch = frame.reference;
    failure.class_data = reason;
    failure.class_length = 8;
    failure.class_order = ORDER_LITTLE;
    peer_send(&pair.receiver, &failure);
    station_run(&pair.station);
    assert_non_null(strstr(station_log(&pair.station), "  Failure               M: oops\n"));
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 1");
    peer_respond(&pair.receiver, &frame, "Answer", 5);
    peer_expect(&pair.receiver, "77 M 2");
    peer_expect_nothing(&pair.sender);
    close_pair(&pair);
}

/* -------------------------------------------------------------------- watches */

#define WATCH VARIABLE_WATCH VARIABLE_BROADCASTS

static void watch(struct peer *peer)
{
    const struct subscription_notice notice = {199, (char *)(uintptr_t)WATCH,
                                               (char *)(uintptr_t)WATCH};
    (void)peer_tell(peer, LM_SUBSCRIBE, &notice);
    station_run(peer->station);
}

/* How many names the next delivery, which has to be a list of broadcasts, holds; -1: none came. */
static int names_in_update(struct peer *peer, struct frame *frame)
{
    struct name_list list;
    const struct format *format = peer->station->server.catalogue.name_list;
    if (!peer_receive(peer, frame)) {
        return -1;
    }
    assert_int_equal(frame->intent, 199);
    assert_int_equal(payload_decode(format, frame->data, frame->data_length,
                                    (enum byte_order)frame->data_order, &list),
                     0);
    (void)format_release(format, &list);
    return list.used;
}

static void subscribe_to_many(struct peer *peer, int from, int to)
{
    for (int i = from; i < to; i++) {
        char name[20];
        (void)snprintf(name, sizeof name, "many%d", i);
        peer_subscribe(peer, name, i);
    }
}

static void only_the_newest_list_waits_for_a_module_of_any_library(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "");
    watch(&pair.sender);
    subscribe_to_many(&pair.receiver, 0, 1);
    assert_int_equal(names_in_update(&pair.sender, &frame), 2);
    subscribe_to_many(&pair.receiver, 1, 50);
    peer_expect_nothing(&pair.sender);
    peer_acknowledge(&pair.sender, &frame);
    assert_int_equal(names_in_update(&pair.sender, &frame), 51);
    peer_acknowledge(&pair.sender, &frame);
    peer_expect_nothing(&pair.sender);
    close_pair(&pair);
}

static void a_library_that_keeps_the_order_gets_each_list_that_it_reads(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "");
    assert_int_equal(peer_id_of(&pair.sender, ABILITY_IN_ORDER), 0);
    watch(&pair.sender);
    subscribe_to_many(&pair.receiver, 0, 1);
    assert_int_equal(names_in_update(&pair.sender, &frame), 2);
    subscribe_to_many(&pair.receiver, 1, 2);
    assert_int_equal(names_in_update(&pair.sender, &frame), 3); /* nothing is acknowledged */
    subscribe_to_many(&pair.receiver, 2, 50);
    assert_int_equal(names_in_update(&pair.sender, &frame), 4); /* this one was not read at once */
    assert_int_equal(names_in_update(&pair.sender, &frame), 51);
    assert_int_equal(names_in_update(&pair.sender, &frame), -1);
    station_close(&pair.station);
}

static void lists_do_not_wait_behind_a_busy_module_s_deliveries(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "M");
    watch(&pair.receiver);
    publish_all(&pair, "M0 M1");
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    subscribe_to_many(&pair.sender, 0, 1);
    assert_int_equal(names_in_update(&pair.receiver, &frame), 3);
    station_close(&pair.station);
}

static void a_list_goes_before_anything_that_follows_from_the_subscription(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "M");
    (void)peer_id_of(&pair.receiver, ABILITY_IN_ORDER);
    watch(&pair.receiver);
    subscribe_to_many(&pair.sender, 0, 1); /* leaves unread, so that the next list is held back */
    subscribe_to_many(&pair.sender, 1, 2);
    publish_all(&pair, "M0");
    assert_int_equal(names_in_update(&pair.receiver, &frame), 3);
    assert_int_equal(names_in_update(&pair.receiver, &frame), 4);
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    station_close(&pair.station);
}

static void other_libraries_get_nothing_before_they_have_handled_the_newest_list(void **state)
{
    struct pair pair;
    struct frame first, second, frame;
    (void)state;
    open_pair(&pair, "M");
    peer_set_capacity(&pair.receiver, 5);
    watch(&pair.receiver);
    subscribe_to_many(&pair.sender, 0, 1);
    subscribe_to_many(&pair.sender, 1, 2);
    publish_all(&pair, "M0");
    assert_int_equal(names_in_update(&pair.receiver, &first), 3);
    peer_expect_nothing(&pair.receiver);
    peer_acknowledge(&pair.receiver, &first);
    assert_int_equal(names_in_update(&pair.receiver, &second), 4);
    assert_string_equal(peer_delivery(&pair.receiver, &frame), "77 M 0");
    station_close(&pair.station);

    /* With capacity 1 even the newest list has to be handled first. */
    open_pair(&pair, "M");
    watch(&pair.receiver);
    subscribe_to_many(&pair.sender, 0, 1);
    publish_all(&pair, "M0");
    assert_int_equal(names_in_update(&pair.receiver, &first), 3);
    peer_expect_nothing(&pair.receiver);
    peer_acknowledge(&pair.receiver, &first);
    peer_expect(&pair.receiver, "77 M 0");
    close_pair(&pair);
}

/* Modules that do not listen stay due for ever; a turn is not to go through them all. */
static void a_module_that_is_due_a_list_costs_a_turn_nothing(void **state)
{
    struct pair pair;
    struct peer lazy;
    const struct server *server;
    (void)state;
    open_pair(&pair, "M");
    server = &pair.station.server;
    peer_connect(&pair.station, &lazy, "Lazy");
    watch(&lazy);
    subscribe_to_many(&pair.sender, 0, 3);
    assert_false(list_is_empty(&lazy.module->due));
    assert_true(list_is_empty(&server->due));
    publish_all(&pair, "M0");
    assert_true(list_is_empty(&server->due));
    expect_all(&pair, "M0");
    station_close(&pair.station);
}

/* Subscribes without letting the server handle it yet. */
static void tell_of_subscription(struct peer *peer, const char *message)
{
    const struct subscription_notice notice = {5, (char *)(uintptr_t)message,
                                               (char *)(uintptr_t)message};
    (void)peer_tell(peer, LM_SUBSCRIBE, &notice);
}

static void the_changes_of_a_turn_are_told_once_and_before_what_follows(void **state)
{
    struct pair pair;
    struct frame frame;
    (void)state;
    open_pair(&pair, "");
    assert_int_equal(peer_id_of(&pair.sender, ABILITY_IN_ORDER), 0);
    watch(&pair.sender);
    tell_of_subscription(&pair.sender, "one");
    const int first = peer_tell(&pair.sender, LM_READY, NULL);
    tell_of_subscription(&pair.receiver, "two");
    const int second = peer_tell(&pair.receiver, LM_READY, NULL);
    tell_of_subscription(&pair.sender, "three");
    const int third = peer_tell(&pair.sender, LM_READY, NULL);
    assert_int_equal(names_in_update(&pair.sender, &frame), 4);
    assert_true(peer_receive(&pair.sender, &frame));
    assert_int_equal(frame.reference, first);
    assert_true(peer_receive(&pair.sender, &frame));
    assert_int_equal(frame.reference, third);
    peer_expect_nothing(&pair.sender);
    assert_true(peer_receive(&pair.receiver, &frame));
    assert_int_equal(frame.reference, second);
    station_close(&pair.station);
}

/* What a module reads last is the newest. */
static void an_answer_that_tells_the_list_is_not_overtaken_by_a_newer_one(void **state)
{
    struct pair pair;
    struct frame frame;
    const struct variable *list;
    (void)state;
    open_pair(&pair, "");
    list = pair.station.server.broadcasts;
    assert_int_equal(peer_id_of(&pair.sender, ABILITY_IN_ORDER), 0);
    watch(&pair.sender);
    tell_of_subscription(&pair.sender, "one");
    peer_frame(&pair.sender, &frame, CLASS_QUERY, variable_message(list, MESSAGE_GET)->id);
    const int reference = frame.reference;
    peer_send(&pair.sender, &frame);
    tell_of_subscription(&pair.sender, "two");
    assert_true(peer_receive(&pair.sender, &frame));
    assert_int_equal(frame.reference, reference);
    assert_int_equal(names_in_update(&pair.sender, &frame), 3);
    peer_expect_nothing(&pair.sender);
    station_close(&pair.station);
}

static void links_with_a_list_are_flushed_first(void **state)
{
    struct pair pair;
    struct server *server;
    const struct subscription_notice notice = {5, (char *)(uintptr_t) "new",
                                               (char *)(uintptr_t) "HND-new"};
    (void)state;
    open_pair(&pair, "");
    server = &pair.station.server;
    watch(&pair.sender);
    (void)peer_tell(&pair.receiver, LM_SUBSCRIBE, &notice);
    (void)peer_tell(&pair.receiver, LM_READY, NULL);
    conversation_turn(server);
    assert_ptr_equal(server->urgent.next, &pair.sender.module->in_flush);
    assert_ptr_equal(server->urgent.next->next, &server->urgent);
    assert_ptr_equal(server->flush.next, &pair.receiver.module->in_flush);
    station_close(&pair.station);
}

/* ---------------------------------------------------------------- back-pressure */

/* A pair with a place for so many deliveries, whose receiver has finished one. */
static void open_small_pair(struct pair *pair, size_t pending_messages)
{
    open_pair(pair, "M");
    pair->station.options.limits.pending_messages = pending_messages;
    publish_all(pair, "M0");
    expect_all(pair, "M0");
    station_run(&pair->station);
}

static const char twenty[] = "M0 M1 M2 M3 M4 M5 M6 M7 M8 M9 M0 M1 M2 M3 M4 M5 M6 M7 M8 M9";

static void who_outpaces_a_working_receiver_waits_and_loses_nothing(void **state)
{
    struct pair pair;
    (void)state;
    open_small_pair(&pair, 8);
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_true(module_waits(pair.sender.module));
    assert_int_equal(pair.receiver.module->own->pending.count, 5);
    expect_all(&pair, twenty);
    assert_false(module_waits(pair.sender.module));
    assert_int_equal(pair.station.server.statistics.n_dropped, 0);
    close_pair(&pair);
}

static void waiting_begins_at_half_of_the_bytes_too(void **state)
{
    struct pair pair;
    (void)state;
    open_small_pair(&pair, 1000);
    pair.station.options.limits.pending_bytes = 8 * 12;
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_int_equal(pair.receiver.module->own->pending.count, 5);
    expect_all(&pair, twenty);
    close_pair(&pair);
}

static void nobody_waits_long_for_a_receiver_that_has_stopped(void **state)
{
    struct pair pair;
    (void)state;
    open_small_pair(&pair, 8);
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_true(module_waits(pair.sender.module));
    station_pass_time(&pair.station, 1);
    assert_false(module_waits(pair.sender.module));
    assert_int_equal(pair.station.server.statistics.n_dropped, 20 - 1 - 8);
    publish_all(&pair, "M0");
    station_run(&pair.station);
    assert_false(module_waits(pair.sender.module));
    expect_all(&pair, "M0 M3 M4 M5 M6 M7 M8 M9 M0");
    close_pair(&pair);
}

static void others_are_heard_while_one_waits(void **state)
{
    struct pair pair;
    struct peer other;
    (void)state;
    open_small_pair(&pair, 8);
    peer_connect(&pair.station, &other, "O");
    peer_define(&other, "N", "int");
    peer_subscribe(&other, "M", 1);
    peer_subscribe(&other, "N", 2);
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_true(module_waits(pair.sender.module));
    peer_publish(&other, "N", 7);
    peer_expect(&other, "1 M 0, 1 M 1, 1 M 2, 1 M 3, 1 M 4, 1 M 5, 2 N 7");
    station_close(&pair.station);
}

static void what_a_waiting_sender_has_said_is_heard_when_it_ends(void **state)
{
    struct pair pair;
    (void)state;
    open_small_pair(&pair, 50);
    publish_all(&pair, twenty);
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_true(module_waits(pair.sender.module));
    peer_lose(&pair.sender);
    char all[2 * sizeof twenty];
    (void)snprintf(all, sizeof all, "%s %s", twenty, twenty);
    expect_all(&pair, all);
    close_pair(&pair);
}

static void a_sender_goes_on_when_the_receiver_ends(void **state)
{
    struct pair pair;
    struct peer other;
    (void)state;
    open_small_pair(&pair, 8);
    publish_all(&pair, twenty);
    station_run(&pair.station);
    assert_true(module_waits(pair.sender.module));
    peer_lose(&pair.receiver);
    assert_false(module_waits(pair.sender.module));
    peer_connect(&pair.station, &other, "O");
    peer_subscribe(&other, "M", 1);
    publish_all(&pair, "M9");
    peer_expect(&other, "1 M 9");
    close_pair(&pair);
}

static void a_module_does_not_wait_for_itself(void **state)
{
    struct pair pair;
    (void)state;
    open_small_pair(&pair, 8);
    peer_unsubscribe(&pair.receiver, "M", 'M');
    peer_subscribe(&pair.sender, "M", 1);
    publish_all(&pair, "M0");
    peer_expect(&pair.sender, "1 M 0");
    publish_all(&pair, "M0 M1 M2 M3 M4 M5 M6 M7");
    station_run(&pair.station);
    assert_false(module_waits(pair.sender.module));
    peer_expect(&pair.sender, "1 M 0, 1 M 1, 1 M 2, 1 M 3, 1 M 4, 1 M 5, 1 M 6, 1 M 7");
    close_pair(&pair);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_publication_reaches_every_handler_oldest_subscription_first),
        cmocka_unit_test(a_delivery_is_the_frame_as_it_came),
        cmocka_unit_test(data_of_any_size_arrives_whole_also_after_waiting),
        cmocka_unit_test(publications_without_handler_vanish),
        cmocka_unit_test(the_first_number_of_a_handler_name_remains_valid),
        cmocka_unit_test(what_waits_for_a_removed_handler_still_comes),
        cmocka_unit_test(one_delivery_at_a_time_is_the_default),
        cmocka_unit_test(a_raised_capacity_is_filled_at_once),
        cmocka_unit_test(the_observed_sequences_of_limits_and_priorities),
        cmocka_unit_test(a_limit_of_the_resource_and_a_limit_of_0),
        cmocka_unit_test(a_full_queue_loses_its_oldest_and_says_so_once),
        cmocka_unit_test(a_queue_is_bounded_in_bytes_too),
        cmocka_unit_test(unsent_bytes_hold_the_queue_back_but_lose_nothing),
        cmocka_unit_test(a_module_that_never_reads_is_let_go_in_the_end),
        cmocka_unit_test(late_double_and_foreign_acknowledgements_count_for_nothing),
        cmocka_unit_test(failures_and_responses_end_a_delivery_as_well),
        cmocka_unit_test(only_the_newest_list_waits_for_a_module_of_any_library),
        cmocka_unit_test(a_library_that_keeps_the_order_gets_each_list_that_it_reads),
        cmocka_unit_test(lists_do_not_wait_behind_a_busy_module_s_deliveries),
        cmocka_unit_test(a_list_goes_before_anything_that_follows_from_the_subscription),
        cmocka_unit_test(other_libraries_get_nothing_before_they_have_handled_the_newest_list),
        cmocka_unit_test(a_module_that_is_due_a_list_costs_a_turn_nothing),
        cmocka_unit_test(the_changes_of_a_turn_are_told_once_and_before_what_follows),
        cmocka_unit_test(an_answer_that_tells_the_list_is_not_overtaken_by_a_newer_one),
        cmocka_unit_test(links_with_a_list_are_flushed_first),
        cmocka_unit_test(who_outpaces_a_working_receiver_waits_and_loses_nothing),
        cmocka_unit_test(waiting_begins_at_half_of_the_bytes_too),
        cmocka_unit_test(nobody_waits_long_for_a_receiver_that_has_stopped),
        cmocka_unit_test(others_are_heard_while_one_waits),
        cmocka_unit_test(what_a_waiting_sender_has_said_is_heard_when_it_ends),
        cmocka_unit_test(a_sender_goes_on_when_the_receiver_ends),
        cmocka_unit_test(a_module_does_not_wait_for_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
