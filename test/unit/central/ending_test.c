/*
 * The end of connections, and what others learn of it; direct mode; locks.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Subscribes under the message's own name, as libraries do for what they watch. */
static void subscribe_as(struct peer *peer, const char *message, int id)
{
    const struct subscription_notice notice = {id, (char *)(uintptr_t)message,
                                               (char *)(uintptr_t)message};
    (void)peer_tell(peer, LM_SUBSCRIBE, &notice);
    station_run(peer->station);
}

static void the_end_is_told_in_order(void **state)
{
    struct station station;
    struct peer leaver, watcher;
    struct frame frame;
    char *message = (char *)(uintptr_t) "M";
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &watcher, "Watcher");
    peer_connect(&station, &leaver, "Leaver");
    peer_set_capacity(&watcher, 10);
    peer_define(&watcher, "M", "int");
    (void)peer_tell(&watcher, LM_WATCH_HANDLERS, &message);
    peer_subscribe(&leaver, "M", 7);
    subscribe_as(&watcher, "V_watch_M", 1);
    subscribe_as(&watcher, VARIABLE_WATCH VARIABLE_BROADCASTS, 2);
    subscribe_as(&watcher, "x_ipc_disconnectNotify", 3);
    while (peer_receive(&watcher, &frame)) {
        peer_acknowledge(&watcher, &frame);
    }
    station_run(&station);
    (void)station_log(&station);
    (void)peer_tell(&leaver, LM_CLOSE, NULL);
    station_run(&station);
    assert_true(peer_is_closed(&leaver));
    assert_string_equal(station_log(&station),
                        "x_ipcClose: Closed Connection Detected from: sd: -1:\n"
                        "x_ipcClose: Closing Leaver on robot\n"
                        "close Module: Closing Leaver\n");
    for (int handler = 1; handler <= 3; handler++) {
        assert_true(peer_receive(&watcher, &frame));
        assert_int_equal(frame.intent, handler);
    }
    assert_memory_equal(frame.data + 4, "Leaver", 6);
    peer_expect_nothing(&watcher);
    station_close(&station);
}

static void what_was_on_its_way_to_it_is_cleared_active_first(void **state)
{
    struct station station;
    struct peer leaver, sender;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &sender, "Planner");
    peer_connect(&station, &leaver, "Arm");
    peer_define(&sender, "Ping", "int");
    station_run(&station);
    peer_subscribe(&leaver, "Ping", 7);
    for (int i = 0; i < 3; i++) {
        peer_publish(&sender, "Ping", i);
    }
    (void)station_log(&station);
    station.options.terminal.references = true;
    peer_lose(&leaver);
    assert_string_equal(station_log(&station), "Closed Connection Detected from: sd: -1: \n"
                                               " Closing Arm on robot\n"
                                               "close Module: Closing Arm\n"
                                               "Clearing handler for message Ping {0}\n"
                                               "Clearing handler for message Ping {1}\n"
                                               "Clearing handler for message Ping {2}\n");
    assert_int_equal(station.server.dispatches.numbers.in_use, 0);
    station_close(&station);
}

static void of_two_modules_of_one_name_only_the_one_concerned_ends(void **state)
{
    struct station station;
    struct peer first, second, sender;
    struct frame frame;
    int is_connected;
    char *name = (char *)(uintptr_t) "twin";
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &sender, "S");
    peer_connect(&station, &first, "TWIN");
    peer_connect(&station, &second, "TWIN");
    peer_define(&sender, "M", "int");
    station_run(&station);
    peer_subscribe(&first, "M", 1);
    peer_subscribe(&second, "M", 2);
    peer_publish(&sender, "M", 1);
    peer_publish(&sender, "M", 2);
    assert_string_equal(peer_delivery(&second, &frame), "2 M 1"); /* each has a slot of its own */
    peer_lose(&first);
    assert_false(peer_is_closed(&second));
    assert_true(peer_ask(&sender, LM_IS_CONNECTED, &name, &is_connected));
    assert_int_equal(is_connected, 1);
    peer_acknowledge(&second, &frame);
    peer_expect(&second, "2 M 2");
    peer_lose(&second);
    assert_true(peer_ask(&sender, LM_IS_CONNECTED, &name, &is_connected));
    assert_int_equal(is_connected, 0);
    station_close(&station);
}

static void a_stranger_leaves_without_notice(void **state)
{
    struct station station;
    struct peer stranger, watcher;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &watcher, "Watcher");
    subscribe_as(&watcher, "x_ipc_disconnectNotify", 3);
    peer_greet(&station, &stranger, "stranger");
    (void)station_log(&station);
    peer_lose(&stranger);
    assert_string_equal(station_log(&station), "Closed Connection Detected from: sd: -1: \n"
                                               " Closing **NEWMOD** on **UNKNOWN**\n"
                                               "close Module: Closing **NEWMOD**\n");
    peer_expect_nothing(&watcher);
    station_close(&station);
}

static void what_a_module_said_before_its_end_is_heard(void **state)
{
    struct station station;
    struct peer hasty, listener;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &listener, "L");
    peer_connect(&station, &hasty, "H");
    peer_set_capacity(&listener, 1000);
    peer_define(&hasty, "M", "int");
    station_run(&station);
    peer_subscribe(&listener, "M", 5);
    struct frame frame;
    const uint8_t data[12] = {4, 0, 0, 0, 4, 0, 0, 0, 7, 0, 0, 0};
    for (int i = 0; i < 200; i++) { /* more than one turn hears */
        peer_frame(&hasty, &frame, CLASS_BROADCAST,
                   message_find(&station.server.messages, "M")->id);
        frame.data = data;
        frame.data_length = sizeof data;
        peer_send(&hasty, &frame);
    }
    peer_lose(&hasty);
    int count = 0;
    while (peer_receive(&listener, &frame)) {
        count++;
    }
    assert_int_equal(count, 200);
    station_close(&station);
}

static void one_connection_is_heard_for_a_bounded_time_only(void **state)
{
    struct station station;
    struct peer talker, other;
    struct frame frame;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &talker, "T");
    peer_connect(&station, &other, "O");
    frame_init(&frame, CLASS_SUCCESS);
    for (int i = 0; i < 100; i++) {
        peer_send(&talker, &frame);
    }
    peer_send(&other, &frame);
    const uint64_t before = station.server.statistics.read.total.messages;
    conversation_turn(&station.server);
    assert_int_equal(station.server.statistics.read.total.messages - before, 64 + 1);
    assert_true(conversation_is_pending(&station.server));
    station_close(&station);
}

/* ----------------------------------------------------------------- direct mode */

static void direct_mode_tells_where_handlers_listen(void **state)
{
    static const char *const arguments[] = {"-c", NULL};
    struct station station;
    struct peer sender, receiver;
    struct frame frame;
    struct handler_list list;
    char *message = (char *)(uintptr_t) "Ping";
    const struct number_and_name foreign = {8001, (char *)(uintptr_t) "Planner"};
    const struct number_and_name own = {8002, (char *)(uintptr_t) "arm"};
    (void)state;
    station_open(&station, arguments);
    peer_connect(&station, &sender, "Planner");
    peer_connect(&station, &receiver, "Arm");
    peer_define(&sender, "Ping", "int");
    assert_true(peer_id_of(&sender, "Ping") < 0);
    assert_true(peer_id_of(&sender, "x_ipc_waitMsg") > 0);
    assert_true(peer_id_of(&sender, "V_watch_Ping") > 0);
    subscribe_as(&sender, "V_watch_Ping", 4);
    peer_subscribe(&receiver, "Ping", 7);
    assert_true(peer_receive(&sender, &frame));
    peer_acknowledge(&sender, &frame);
    (void)station_log(&station);
    station.options.terminal.ignore = true;
    (void)peer_tell(&receiver, LM_DIRECT_PORT, &foreign);
    station_run(&station);
    assert_string_equal(station_log(&station),
                        "Direct Connection: Not Made: Planner did not originate call.\n");
    (void)peer_tell(&receiver, LM_DIRECT_PORT, &own);
    station_run(&station);
    assert_string_equal(station_log(&station), "Direct Connection Established For: Arm at 8002\n");
    assert_true(peer_receive(&sender, &frame)); /* the list with the port */
    assert_true(peer_ask(&sender, LM_HANDLERS, &message, &list));
    assert_int_equal(list.count, 1);
    assert_int_equal(list.handlers[0].id, 7);
    assert_int_equal(list.handlers[0].port, 8002);
    assert_string_equal(list.handlers[0].host, "robot");
    assert_string_equal(list.handlers[0].module, "Arm");
    (void)format_release(station.server.catalogue.handler_list, &list);
    /* Through central nevertheless: with the negative number. */
    peer_frame(&sender, &frame, CLASS_BROADCAST,
               -message_find(&station.server.messages, "Ping")->id);
    const uint8_t data[12] = {4, 0, 0, 0, 4, 0, 0, 0, 9, 0, 0, 0};
    frame.data = data;
    frame.data_length = sizeof data;
    frame.data_order = ORDER_LITTLE;
    peer_send(&sender, &frame);
    peer_expect(&receiver, "7 Ping 9");
    station_close(&station);
}

static void a_list_of_nobody_is_an_answer_without_data(void **state)
{
    struct station station;
    struct peer peer;
    struct handler_list list;
    char *message = (char *)(uintptr_t) "M";
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &peer, "P");
    assert_false(peer_ask(&peer, LM_HANDLERS, &message, &list));
    peer_define(&peer, "M", "int");
    assert_false(peer_ask(&peer, LM_HANDLERS, &message, &list));
    station_close(&station);
}

static void wishes_for_handler_lists_are_kept_until_the_definition(void **state)
{
    struct station station;
    struct peer watcher, other;
    struct frame frame;
    char *message = (char *)(uintptr_t) "Late";
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &watcher, "W");
    peer_connect(&station, &other, "O");
    (void)peer_tell(&watcher, LM_WATCH_HANDLERS, &message);
    subscribe_as(&watcher, "V_watch_Late", 4);
    peer_expect_nothing(&watcher);
    peer_define(&other, "Late", "int");
    assert_true(peer_receive(&watcher, &frame)); /* nobody yet */
    peer_acknowledge(&watcher, &frame);
    peer_subscribe(&other, "Late", 7);
    assert_true(peer_receive(&watcher, &frame));
    assert_int_equal(frame.intent, 4);
    station_close(&station);
}

/* ----------------------------------------------------------------------- locks */

static int claim(struct peer *peer, enum library_message which, const char *resource)
{
    int number = 0;
    assert_true(peer_ask(peer, which, &resource, &number));
    return number;
}

struct lock_fixture {
    struct station station;
    struct peer receiver, holder, sender;
};

static void open_lock(struct lock_fixture *fixture)
{
    station_open(&fixture->station, NULL);
    peer_connect(&fixture->station, &fixture->receiver, "Arm");
    peer_connect(&fixture->station, &fixture->holder, "Holder");
    peer_connect(&fixture->station, &fixture->sender, "Sender");
    peer_define(&fixture->receiver, "M", "int");
    peer_subscribe(&fixture->receiver, "M", 5);
}

static void nothing_is_delivered_from_a_locked_resource(void **state)
{
    struct lock_fixture f;
    (void)state;
    open_lock(&f);
    const int number = claim(&f.holder, LM_LOCK, "arm");
    assert_true(number >= 0);
    peer_publish(&f.sender, "M", 1);
    peer_publish(&f.holder, "M", 2);
    peer_expect_nothing(&f.receiver);
    const int wrong = number + 1;
    (void)peer_tell(&f.holder, LM_UNLOCK, &wrong);
    (void)peer_tell(&f.sender, LM_UNLOCK, &number); /* not its own */
    peer_expect_nothing(&f.receiver);
    (void)peer_tell(&f.holder, LM_UNLOCK, &number);
    peer_expect(&f.receiver, "5 M 1, 5 M 2");
    station_close(&f.station);
}

static void the_end_of_its_holder_unlocks(void **state)
{
    struct lock_fixture f;
    (void)state;
    open_lock(&f);
    assert_true(claim(&f.holder, LM_LOCK, "Arm") >= 0);
    peer_publish(&f.sender, "M", 1);
    peer_lose(&f.holder);
    peer_expect(&f.receiver, "5 M 1");
    station_close(&f.station);
}

static void only_the_holder_of_a_reservation_is_served(void **state)
{
    struct lock_fixture f;
    struct frame frame;
    (void)state;
    open_lock(&f);
    const int number = claim(&f.holder, LM_RESERVE, "Arm");
    assert_true(number >= 0);
    assert_int_equal(claim(&f.holder, LM_RESERVE, "Arm"), NO_ID);
    peer_publish(&f.sender, "M", 1);
    peer_publish(&f.holder, "M", 2);
    peer_publish(&f.holder, "M", 3);
    assert_string_equal(peer_delivery(&f.receiver, &frame), "5 M 2");
    peer_expect_nothing(&f.receiver);
    peer_acknowledge(&f.receiver, &frame);
    peer_expect(&f.receiver, "5 M 3");
    (void)peer_tell(&f.holder, LM_CANCEL_RESERVATION, &number);
    peer_expect(&f.receiver, "5 M 1");
    station_close(&f.station);
}

static void claims_wait_for_each_other_and_for_room(void **state)
{
    struct lock_fixture f;
    struct frame delivery, frame;
    char *arm = (char *)(uintptr_t) "Arm";
    (void)state;
    open_lock(&f);
    peer_publish(&f.sender, "M", 1);
    assert_string_equal(peer_delivery(&f.receiver, &delivery), "5 M 1");
    const int first = peer_tell(&f.holder, LM_LOCK, &arm); /* no room: one is active */
    const int second = peer_tell(&f.sender, LM_LOCK, &arm);
    peer_expect_nothing(&f.holder);
    peer_acknowledge(&f.receiver, &delivery);
    assert_true(peer_receive(&f.holder, &frame));
    assert_int_equal(frame.reference, first);
    peer_expect_nothing(&f.sender);
    peer_lose(&f.holder);
    assert_true(peer_receive(&f.sender, &frame));
    assert_int_equal(frame.reference, second);
    station_close(&f.station);
}

static void claims_on_a_resource_that_goes_are_refused(void **state)
{
    struct lock_fixture f;
    struct frame frame;
    char *arm = (char *)(uintptr_t) "Arm";
    (void)state;
    open_lock(&f);
    assert_true(claim(&f.holder, LM_LOCK, "Arm") >= 0);
    (void)peer_tell(&f.sender, LM_LOCK, &arm);
    peer_expect_nothing(&f.sender);
    peer_lose(&f.receiver);
    assert_true(peer_receive(&f.sender, &frame));
    assert_int_equal((int)load_32(frame.data, (enum byte_order)frame.data_order), NO_ID);
    assert_int_equal(claim(&f.sender, LM_LOCK, "Arm"), NO_ID); /* unknown now */
    assert_true(list_is_empty(&f.holder.module->held));
    station_close(&f.station);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_end_is_told_in_order),
        cmocka_unit_test(what_was_on_its_way_to_it_is_cleared_active_first),
        cmocka_unit_test(of_two_modules_of_one_name_only_the_one_concerned_ends),
        cmocka_unit_test(a_stranger_leaves_without_notice),
        cmocka_unit_test(what_a_module_said_before_its_end_is_heard),
        cmocka_unit_test(one_connection_is_heard_for_a_bounded_time_only),
        cmocka_unit_test(direct_mode_tells_where_handlers_listen),
        cmocka_unit_test(a_list_of_nobody_is_an_answer_without_data),
        cmocka_unit_test(wishes_for_handler_lists_are_kept_until_the_definition),
        cmocka_unit_test(nothing_is_delivered_from_a_locked_resource),
        cmocka_unit_test(the_end_of_its_holder_unlocks),
        cmocka_unit_test(only_the_holder_of_a_reservation_is_served),
        cmocka_unit_test(claims_wait_for_each_other_and_for_room),
        cmocka_unit_test(claims_on_a_resource_that_goes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
