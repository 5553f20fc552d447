/*
 * Queries: which handler gets them, and what becomes of the response.
 */
#include "station.h"

#include <stdlib.h>
#include <string.h>

#include "central/settings/limits.h"

struct trio {
    struct station station;
    struct peer asker;
    struct peer server;
    struct peer other;
};

static void open_trio(struct trio *trio)
{
    station_open(&trio->station, NULL);
    peer_connect(&trio->station, &trio->asker, "ASKER");
    peer_connect(&trio->station, &trio->server, "SERVER");
    peer_connect(&trio->station, &trio->other, "OTHER");
    peer_define(&trio->asker, "Q", "int");
    peer_define(&trio->asker, "A", "int");
    station_run(&trio->station);
}

static void close_trio(struct trio *trio)
{
    station_run(&trio->station);
    assert_int_equal(trio->station.server.dispatches.numbers.in_use, 0);
    station_close(&trio->station);
}

/* Checks that the next frame is the response with that number to the query with that reference. */
static void expect_response(struct peer *peer, int reference, int number)
{
    struct frame frame;
    assert_true(peer_receive(peer, &frame));
    assert_int_equal(frame.class, CLASS_REPLY);
    assert_int_equal(frame.intent, INTENT_REPLY);
    assert_int_equal(frame.reference, reference);
    assert_int_equal(frame.class_length, 5);
    assert_memory_equal(frame.class_data + 4, "A", 1);
    assert_int_equal(load_32(frame.data + 8, (enum byte_order)frame.data_order), number);
}

static void a_response_goes_to_the_asker_alone_and_unchanged(void **state)
{
    struct trio trio;
    struct frame query, response;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 198);
    peer_subscribe(&trio.other, "A", 5);
    const int reference = peer_query(&trio.asker, "Q", 21);
    assert_string_equal(peer_delivery(&trio.server, &query), "198 Q 21");
    assert_int_equal(query.class, CLASS_QUERY);
    peer_respond(&trio.server, &query, "A", 42);
    assert_true(peer_receive(&trio.asker, &response));
    assert_int_equal(response.parent, query.reference);
    assert_int_equal(response.dispatch, query.reference);
    assert_int_equal(response.reference, reference);
    peer_expect_nothing(&trio.other);
    peer_expect_nothing(&trio.asker);
    close_trio(&trio);
}

static void responses_may_come_in_any_order_and_each_frees_its_slot(void **state)
{
    struct trio trio;
    struct frame first, second, third;
    int references[3];
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 198);
    peer_set_capacity(&trio.server, 2);
    for (int i = 0; i < 3; i++) {
        references[i] = peer_query(&trio.asker, "Q", i);
    }
    assert_string_equal(peer_delivery(&trio.server, &first), "198 Q 0");
    assert_string_equal(peer_delivery(&trio.server, &second), "198 Q 1");
    peer_expect_nothing(&trio.server);
    peer_respond(&trio.server, &second, "A", 11);
    expect_response(&trio.asker, references[1], 11);
    assert_string_equal(peer_delivery(&trio.server, &third), "198 Q 2");
    peer_respond(&trio.server, &third, "A", 12);
    peer_respond(&trio.server, &first, "A", 10);
    expect_response(&trio.asker, references[2], 12);
    expect_response(&trio.asker, references[0], 10);
    close_trio(&trio);
}

static void a_handler_that_does_not_respond_leaves_the_asker_without_an_answer(void **state)
{
    struct trio trio;
    struct frame query;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 198);
    (void)peer_query(&trio.asker, "Q", 1);
    assert_string_equal(peer_delivery(&trio.server, &query), "198 Q 1");
    peer_acknowledge(&trio.server, &query);
    peer_expect_nothing(&trio.asker);
    close_trio(&trio);
}

static void a_response_that_names_no_message_is_not_passed_on(void **state)
{
    struct trio trio;
    struct frame query, response;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 198);
    (void)peer_query(&trio.asker, "Q", 1);
    assert_string_equal(peer_delivery(&trio.server, &query), "198 Q 1");
    frame_init(&response, CLASS_REPLY);
    response.dispatch = query.reference;
    peer_send(&trio.server, &response);
    peer_expect_nothing(&trio.asker);
    close_trio(&trio);
}

static void queries_wait_for_a_handler_and_go_at_once_when_it_comes(void **state)
{
    struct trio trio;
    struct frame query;
    int references[2];
    (void)state;
    open_trio(&trio);
    references[0] = peer_query(&trio.asker, "Q", 0);
    references[1] = peer_query(&trio.asker, "Q", 1);
    peer_publish(&trio.other, "Q", 9); /* does not wait with them */
    peer_subscribe(&trio.server, "Q", 198);
    for (int i = 0; i < 2; i++) {
        assert_true(strncmp(peer_delivery(&trio.server, &query), "198 Q ", 6) == 0);
        peer_respond(&trio.server, &query, "A", 10 + i);
        expect_response(&trio.asker, references[i], 10 + i);
    }
    peer_expect_nothing(&trio.server);
    close_trio(&trio);
}

static void a_query_of_several_handlers_goes_to_the_oldest_that_is_free(void **state)
{
    struct trio trio;
    struct frame first, second, third;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 1);
    peer_subscribe(&trio.other, "Q", 2);
    const int a = peer_query(&trio.asker, "Q", 0);
    const int b = peer_query(&trio.asker, "Q", 1);
    const int c = peer_query(&trio.asker, "Q", 2); /* both are busy: the oldest again */
    assert_string_equal(peer_delivery(&trio.server, &first), "1 Q 0");
    assert_string_equal(peer_delivery(&trio.other, &second), "2 Q 1");
    peer_expect_nothing(&trio.other);
    peer_respond(&trio.other, &second, "A", 1);
    expect_response(&trio.asker, b, 1);
    peer_respond(&trio.server, &first, "A", 0);
    expect_response(&trio.asker, a, 0);
    assert_string_equal(peer_delivery(&trio.server, &third), "1 Q 2");
    peer_respond(&trio.server, &third, "A", 2);
    expect_response(&trio.asker, c, 2);
    close_trio(&trio);
}

static void busy_handlers_share_the_queries_by_the_length_of_their_queues(void **state)
{
    struct trio trio;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 1);
    peer_subscribe(&trio.other, "Q", 2);
    for (int i = 0; i < 6; i++) {
        (void)peer_query(&trio.asker, "Q", i);
    }
    assert_int_equal(trio.server.module->own->pending.count, 2);
    assert_int_equal(trio.other.module->own->pending.count, 2);
    station_close(&trio.station);
}

static void an_inform_of_an_old_module_goes_to_one_handler(void **state)
{
    struct trio trio;
    struct frame frame, got;
    const uint8_t data[12] = {0};
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 1);
    peer_subscribe(&trio.other, "Q", 2);
    peer_frame(&trio.asker, &frame, CLASS_INFORM,
               message_find(&trio.station.server.messages, "Q")->id);
    frame.data = data;
    frame.data_length = sizeof data;
    peer_send(&trio.asker, &frame);
    assert_true(peer_receive(&trio.server, &got));
    assert_int_equal(got.class, CLASS_INFORM);
    peer_expect_nothing(&trio.other);
    peer_acknowledge(&trio.server, &got);
    peer_expect_nothing(&trio.asker);
    close_trio(&trio);
}

static void responses_of_modules_in_direct_mode_are_accepted(void **state)
{
    struct trio trio;
    struct frame query, response;
    uint8_t name[5] = "\1\0\0\0A";
    const uint8_t data[12] = {4, 0, 0, 0, 4, 0, 0, 0, 7, 0, 0, 0};
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 1);
    const int reference = peer_query(&trio.asker, "Q", 3);
    assert_string_equal(peer_delivery(&trio.server, &query), "1 Q 3");
    frame_init(&response, CLASS_REPLY);
    response.intent = INTENT_REPLY;
    response.dispatch = query.reference;
    response.reference = query.reference;
    response.class_data = name;
    response.class_length = sizeof name;
    response.class_order = ORDER_LITTLE;
    response.data = data;
    response.data_length = sizeof data;
    response.data_order = ORDER_LITTLE;
    peer_send(&trio.server, &response);
    expect_response(&trio.asker, reference, 7);
    close_trio(&trio);
}

static void the_response_to_a_dead_asker_is_dropped(void **state)
{
    struct trio trio;
    struct frame query;
    (void)state;
    open_trio(&trio);
    peer_subscribe(&trio.server, "Q", 1);
    (void)peer_query(&trio.asker, "Q", 3);
    assert_string_equal(peer_delivery(&trio.server, &query), "1 Q 3");
    peer_lose(&trio.asker);
    (void)station_log(&trio.station);
    peer_respond(&trio.server, &query, "A", 2);
    station_run(&trio.station);
    assert_string_equal(station_log(&trio.station),
                        "  Reply                Q:     SERVER --> ASKER          \n");
    peer_publish(&trio.other, "Q", 9);
    peer_expect(&trio.server, "1 Q 9");
    close_trio(&trio);
}

static void waiting_queries_are_bounded(void **state)
{
    struct trio trio;
    struct frame frame;
    const size_t length = LIMIT_WAITING_BYTES / 4;
    uint8_t *data = calloc(1, length);
    (void)state;
    open_trio(&trio);
    const struct message *message = message_find(&trio.station.server.messages, "Q");
    for (int i = 0; i < 6; i++) {
        peer_frame(&trio.asker, &frame, CLASS_QUERY, message->id);
        frame.data = data;
        frame.data_length = (uint32_t)length;
        peer_send(&trio.asker, &frame);
        station_run(&trio.station);
    }
    free(data);
    assert_int_equal(message->n_waiting, 4);
    assert_int_equal(message->waiting_bytes, LIMIT_WAITING_BYTES);
    assert_int_equal(trio.station.server.statistics.n_dropped, 2);
    station_close(&trio.station);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_response_goes_to_the_asker_alone_and_unchanged),
        cmocka_unit_test(responses_may_come_in_any_order_and_each_frees_its_slot),
        cmocka_unit_test(a_handler_that_does_not_respond_leaves_the_asker_without_an_answer),
        cmocka_unit_test(a_response_that_names_no_message_is_not_passed_on),
        cmocka_unit_test(queries_wait_for_a_handler_and_go_at_once_when_it_comes),
        cmocka_unit_test(a_query_of_several_handlers_goes_to_the_oldest_that_is_free),
        cmocka_unit_test(busy_handlers_share_the_queries_by_the_length_of_their_queues),
        cmocka_unit_test(an_inform_of_an_old_module_goes_to_one_handler),
        cmocka_unit_test(responses_of_modules_in_direct_mode_are_accepted),
        cmocka_unit_test(the_response_to_a_dead_asker_is_dropped),
        cmocka_unit_test(waiting_queries_are_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
