/*
 * Full queues: what is kept by each policy, and what the log says about the rest.
 */
#include "station.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"

/* Two receivers of M and one of N, with places for three deliveries each, and two senders. */
struct fixture {
    struct station station;
    struct peer slow, other, sender, second;
};

static void open_fixture(struct fixture *f, const char *policy)
{
    const char *const arguments[] = {"--limit-queue-messages=3", policy, NULL};
    station_open(&f->station, arguments);
    peer_connect(&f->station, &f->slow, "Slow");
    peer_connect(&f->station, &f->other, "Other");
    peer_connect(&f->station, &f->sender, "Sender");
    peer_connect(&f->station, &f->second, "Second");
    peer_define(&f->sender, "M", "int");
    peer_define(&f->sender, "N", "int");
    peer_subscribe(&f->slow, "M", 1);
    peer_subscribe(&f->slow, "N", 2);
    peer_subscribe(&f->other, "M", 3);
    (void)station_log(&f->station);
}

/* Publishes M and leaves it to Slow; Other takes what it gets. */
static void publish(struct fixture *f, int first, int last)
{
    for (int number = first; number <= last; number++) {
        char expected[20];
        (void)snprintf(expected, sizeof expected, "3 M %d", number);
        peer_publish(&f->sender, "M", number);
        peer_expect(&f->other, expected);
    }
}

/* The lines of the log that are warnings, without what they begin with. */
static void assert_warnings(struct fixture *f, const char *expected)
{
    static const char beginning[] = "WARNING: Slow on robot: ";
    char found[2000] = "";
    const char *at = station_log(&f->station);
    while ((at = strstr(at, beginning)) != NULL) {
        at += sizeof beginning - 1;
        (void)snprintf(found + strlen(found), sizeof found - strlen(found), "%.*s\n",
                       (int)strcspn(at, "\n"), at);
    }
    assert_string_equal(found, expected);
}

static void the_newest_are_kept(void **state)
{
    static const char *const policies[] = {"--when-full=newest", "--when-full=wait",
                                           "--when-full=Slow:newest"};
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        struct fixture f;
        open_fixture(&f, policies[i]);
        publish(&f, 0, 9);
        assert_warnings(&f, "the queue of Slow is full: M of Sender is dropped, "
                            "the newest messages are kept\n");
        peer_expect(&f.slow, "1 M 0, 1 M 7, 1 M 8, 1 M 9");
        assert_warnings(&f, "the queue of Slow was full: 6 of M were dropped\n");
        assert_int_equal(f.station.server.statistics.n_dropped, 6);
        assert_int_equal(message_get(&f.station.server.messages, "M")->dropped, 6);
        assert_int_equal(f.slow.module->own->dropped, 6);
        station_close(&f.station);
    }
}

static void the_oldest_are_kept(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f, "--when-full=oldest");
    publish(&f, 0, 9);
    assert_warnings(&f, "the queue of Slow is full: M of Sender is dropped, "
                        "the oldest messages are kept\n");
    peer_expect(&f.slow, "1 M 0, 1 M 1, 1 M 2, 1 M 3");
    assert_warnings(&f, "the queue of Slow was full: 6 of M were dropped\n");
    publish(&f, 10, 10);
    peer_expect(&f.slow, "1 M 10");
    station_close(&f.station);
}

static void a_module_may_be_disconnected(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f, "--when-full=slow:disconnect");
    publish(&f, 0, 3);
    assert_false(peer_is_closed(&f.slow));
    publish(&f, 4, 9);
    assert_true(peer_is_closed(&f.slow));
    assert_warnings(&f, "the queue of Slow is full: M of Sender is dropped, its connection ends\n"
                        "the queue of Slow was full: 1 of M were dropped\n");
    station_close(&f.station);
}

/* Its second subscription to the message that fills the queue comes right after the first. */
static void a_module_with_two_handlers_of_the_message_may_be_disconnected(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f, "--when-full=disconnect");
    peer_subscribe(&f.slow, "M", 8);
    peer_subscribe(&f.slow, "M", 9);
    publish(&f, 0, 4);
    assert_true(peer_is_closed(&f.slow));
    assert_false(peer_is_closed(&f.other));
    station_close(&f.station);
}

/* The one who is disconnected was watched by another one whose queue is full as well. */
static void one_disconnection_may_lead_to_another(void **state)
{
    struct fixture f;
    struct peer watcher;
    (void)state;
    open_fixture(&f, "--when-full=disconnect");
    peer_connect(&f.station, &watcher, "Watcher");
    peer_subscribe(&watcher, "x_ipc_disconnectNotify", 4);
    peer_subscribe(&watcher, "M", 5);
    publish(&f, 0, 3);
    assert_false(peer_is_closed(&watcher));
    publish(&f, 4, 4);
    assert_true(peer_is_closed(&f.slow));
    assert_true(peer_is_closed(&watcher));
    publish(&f, 5, 9);
    station_close(&f.station);
}

/* Each message that has lost something is told once in a burst, with the first who lost it. */
static void a_burst_is_told_once_for_each_message(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f, "--when-full=newest");
    for (int number = 0; number < 20; number++) {
        peer_publish(number % 2 == 0 ? &f.second : &f.sender, "N", number);
        publish(&f, number, number);
    }
    assert_warnings(&f, "the queue of Slow is full: M of Sender is dropped, "
                        "the newest messages are kept\n"
                        "the queue of Slow is full: N of Sender is dropped, "
                        "the newest messages are kept\n");
    peer_expect(&f.slow, "2 N 0, 1 M 18, 2 N 19, 1 M 19");
    assert_warnings(&f, "the queue of Slow was full: 18 of M were dropped\n"
                        "the queue of Slow was full: 18 of N were dropped\n");
    publish(&f, 0, 5);
    assert_warnings(&f, "the queue of Slow is full: M of Sender is dropped, "
                        "the newest messages are kept\n");
    peer_lose(&f.slow);
    assert_warnings(&f, "the queue of Slow was full: 2 of M were dropped\n");
    assert_int_equal(f.station.server.statistics.n_dropped, 38);
    station_close(&f.station);
}

/* Nobody waits for a receiver whose queue has another policy than to wait. */
static void only_the_standard_policy_makes_senders_wait(void **state)
{
    static const char *const policies[] = {"--when-full=wait", "--when-full=newest",
                                           "--when-full=oldest", "--when-full=disconnect"};
    (void)state;
    for (size_t i = 0; i < 4; i++) {
        struct fixture f;
        open_fixture(&f, policies[i]);
        peer_publish(&f.sender, "N", 0);
        peer_expect(&f.slow, "2 N 0"); /* it works */
        station_run(&f.station);
        for (int number = 0; number < 3; number++) {
            peer_publish(&f.sender, "N", number);
        }
        assert_int_equal(module_waits(f.sender.module), i == 0);
        station_close(&f.station);
    }
}

/* A query that finds no room is lost like any other message; the asker hears nothing. */
static void queries_are_counted_as_well(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f, "--when-full=oldest");
    for (int number = 0; number < 6; number++) {
        (void)peer_query(&f.sender, "N", number);
    }
    assert_warnings(&f, "the queue of Slow is full: N of Sender is dropped, "
                        "the oldest messages are kept\n");
    peer_expect(&f.slow, "2 N 0, 2 N 1, 2 N 2, 2 N 3");
    assert_warnings(&f, "the queue of Slow was full: 2 of N were dropped\n");
    peer_expect_nothing(&f.sender);
    station_close(&f.station);
}

/* Queries that waited for a handler find its queue too small. */
static void what_waited_for_a_handler_counts_against_its_queue(void **state)
{
    static const char *const policies[] = {"--when-full=newest", "--when-full=oldest"};
    static const char *const kept[] = {"7 Q 2, 7 Q 3, 7 Q 4", "7 Q 0, 7 Q 1, 7 Q 2"};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        struct fixture f;
        open_fixture(&f, policies[i]);
        peer_define(&f.sender, "Q", "int");
        station_run(&f.station);
        for (int number = 0; number < 5; number++) {
            (void)peer_query(&f.sender, "Q", number);
        }
        peer_subscribe(&f.slow, "Q", 7);
        peer_expect(&f.slow, kept[i]);
        peer_expect_nothing(&f.slow);
        station_close(&f.station);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_newest_are_kept),
        cmocka_unit_test(the_oldest_are_kept),
        cmocka_unit_test(a_module_may_be_disconnected),
        cmocka_unit_test(a_module_with_two_handlers_of_the_message_may_be_disconnected),
        cmocka_unit_test(one_disconnection_may_lead_to_another),
        cmocka_unit_test(a_burst_is_told_once_for_each_message),
        cmocka_unit_test(only_the_standard_policy_makes_senders_wait),
        cmocka_unit_test(queries_are_counted_as_well),
        cmocka_unit_test(what_waited_for_a_handler_counts_against_its_queue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
