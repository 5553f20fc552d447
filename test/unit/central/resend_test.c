/*
 * Option -r: what a module did not finish before it ended is sent again.
 */
#include "station.h"

#include <string.h>

#include "central/operator/console.h"
#include "central/routing/resend.h"

/* Planner defines Ping and Where, which Arm handles; Camera handles Ping as well. */
struct robot {
    struct station station;
    struct console console;
    struct peer planner, arm, camera;
};

static void open_robot(struct robot *robot)
{
    static const char *const arguments[] = {"-r", "-lm", NULL};
    station_open(&robot->station, arguments);
    console_init(&robot->console, &robot->station.server);
    peer_connect(&robot->station, &robot->planner, "Planner");
    peer_connect(&robot->station, &robot->arm, "Arm");
    peer_connect(&robot->station, &robot->camera, "Camera");
    peer_define(&robot->planner, "Ping", "int");
    peer_define(&robot->planner, "Where", "int");
    station_run(&robot->station);
    peer_subscribe(&robot->arm, "Ping", 1);
    peer_subscribe(&robot->arm, "Where", 2);
    peer_subscribe(&robot->camera, "Ping", 1);
    station_run(&robot->station);
    (void)station_log(&robot->station);
}

static void close_robot(struct robot *robot)
{
    console_fini(&robot->console);
    station_close(&robot->station);
}

/* Typed text, and what the terminal says to it. */
static const char *answer_to(struct robot *robot, const char *typed)
{
    console_feed(&robot->console, typed, strlen(typed));
    return station_log(&robot->station);
}

/* Three publications, of which Arm has got one. */
static void publish_three(struct robot *robot)
{
    for (int number = 1; number <= 3; number++) {
        peer_publish(&robot->planner, "Ping", number);
    }
    station_run(&robot->station);
    (void)station_log(&robot->station);
}

static void a_broadcast_goes_only_to_who_has_lost_it(void **state)
{
    struct robot robot;
    struct peer other, again;
    (void)state;
    open_robot(&robot);
    publish_three(&robot);
    peer_lose(&robot.arm);
    assert_non_null(
        strstr(station_log(&robot.station),
               "close Module: Closing Arm\n"
               "Broadcast            Ping:    Planner --> Resource Ping   (Pending)\n"
               "Broadcast            Ping:    Planner --> Resource Ping   (Pending)\n"
               "Broadcast            Ping:    Planner --> Resource Ping   (Pending)\n"));
    peer_connect(&robot.station, &other, "Hand");
    peer_subscribe(&other, "Ping", 1);
    peer_expect_nothing(&other);
    peer_connect(&robot.station, &again, "arm"); /* names have no case */
    peer_subscribe(&again, "Where", 1);
    peer_expect_nothing(&again);
    peer_subscribe(&again, "Ping", 4);
    peer_expect(&again, "4 Ping 1, 4 Ping 2, 4 Ping 3");
    peer_expect(&robot.camera, "1 Ping 1, 1 Ping 2, 1 Ping 3"); /* once, as ever */
    station_run(&robot.station);
    peer_expect_nothing(&robot.camera);
    assert_int_equal(robot.station.server.dispatches.numbers.in_use, 0);
    close_robot(&robot);
}

static void it_is_lost_and_sent_as_often_as_needed(void **state)
{
    struct robot robot;
    struct peer again[2];
    struct frame frame;
    (void)state;
    open_robot(&robot);
    publish_three(&robot);
    peer_lose(&robot.arm);
    peer_connect(&robot.station, &again[0], "Arm");
    peer_subscribe(&again[0], "Ping", 1);
    assert_string_equal(peer_delivery(&again[0], &frame), "1 Ping 1"); /* not acknowledged */
    peer_lose(&again[0]);
    peer_connect(&robot.station, &again[1], "Arm");
    peer_subscribe(&again[1], "Ping", 1);
    peer_publish(&robot.planner, "Ping", 4);
    peer_expect(&again[1], "1 Ping 1, 1 Ping 2, 1 Ping 3, 1 Ping 4");
    close_robot(&robot);
}

static void a_query_goes_to_another_handler_or_the_next_that_comes(void **state)
{
    struct robot robot;
    struct peer next;
    struct frame query, reply;
    (void)state;
    open_robot(&robot);
    (void)peer_query(&robot.planner, "Where", 5);
    station_run(&robot.station);
    peer_lose(&robot.arm);
    peer_connect(&robot.station, &next, "Hand");
    peer_subscribe(&next, "Where", 3);
    assert_string_equal(peer_delivery(&next, &query), "3 Where 5");
    peer_subscribe(&robot.camera, "Where", 2);
    peer_lose(&next);
    assert_string_equal(peer_delivery(&robot.camera, &query), "2 Where 5");
    peer_respond(&robot.camera, &query, "Ping", 6);
    assert_true(peer_receive(&robot.planner, &reply));
    assert_int_equal(reply.reference, robot.planner.last_reference);
    close_robot(&robot);
}

static void what_the_module_has_finished_is_not_sent_again(void **state)
{
    struct robot robot;
    struct peer again;
    (void)state;
    open_robot(&robot);
    publish_three(&robot);
    peer_expect(&robot.arm, "1 Ping 1, 1 Ping 2, 1 Ping 3");
    station_run(&robot.station);
    peer_lose(&robot.arm);
    peer_connect(&robot.station, &again, "Arm");
    peer_subscribe(&again, "Ping", 1);
    peer_expect_nothing(&again);
    close_robot(&robot);
}

static void without_the_option_it_is_cleared(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot);
    robot.station.options.resend = false;
    publish_three(&robot);
    robot.station.options.resend = true; /* typed too late for what has been sent already */
    peer_lose(&robot.arm);
    const char *text = station_log(&robot.station);
    assert_non_null(strstr(text, "Clearing handler for message Ping\n"
                                 "Broadcast            Ping:    Planner --> Resource Ping   "
                                 "(Pending)\n"));
    close_robot(&robot);
}

static void somebody_at_a_terminal_is_asked(void **state)
{
    struct robot robot;
    struct peer again;
    (void)state;
    open_robot(&robot);
    resend_set_asking(&robot.station.server, true);
    publish_three(&robot);
    peer_lose(&robot.arm);
    assert_non_null(strstr(station_log(&robot.station),
                           "close Module: Closing Arm\n\a\aResend active and/or pending messages "
                           "for the Arm resource?"));
    peer_publish(&robot.planner, "Ping", 4); /* nobody waits for the answer */
    peer_expect(&robot.camera, "1 Ping 1, 1 Ping 2, 1 Ping 3, 1 Ping 4");
    station_run(&robot.station);
    (void)station_log(&robot.station);
    assert_string_equal(answer_to(&robot, "y\n"), "Resend Ping message?");
    assert_string_equal(answer_to(&robot, "yes, y\n"),
                        "Broadcast            Ping:    Planner --> Resource Ping   (Pending)\n"
                        "Resend Ping message?");
    assert_string_equal(answer_to(&robot, "no\n"), "Not resending message: Ping\n"
                                                   "Resend Ping message?");
    assert_string_equal(answer_to(&robot, "y\n"),
                        "Broadcast            Ping:    Planner --> Resource Ping   (Pending)\n"
                        "> ");
    peer_connect(&robot.station, &again, "Arm");
    peer_subscribe(&again, "Ping", 1);
    peer_expect(&again, "1 Ping 1, 1 Ping 3");
    close_robot(&robot);
}

static void who_does_not_want_it_loses_it(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot);
    resend_set_asking(&robot.station.server, true);
    publish_three(&robot);
    peer_expect(&robot.camera, "1 Ping 1, 1 Ping 2, 1 Ping 3");
    station_run(&robot.station);
    peer_lose(&robot.arm);
    (void)station_log(&robot.station);
    assert_string_equal(answer_to(&robot, "\n"), "Not resending messages.\n> ");
    assert_string_equal(answer_to(&robot, "display\n"), "Active and Pending Messages:\n> ");
    assert_int_equal(robot.station.server.dispatches.numbers.in_use, 0);
    close_robot(&robot);
}

static void one_question_comes_after_another_and_none_without_a_terminal(void **state)
{
    struct robot robot;
    struct peer again;
    (void)state;
    open_robot(&robot);
    resend_set_asking(&robot.station.server, true);
    publish_three(&robot);
    peer_lose(&robot.arm);
    peer_lose(&robot.camera);
    (void)station_log(&robot.station);
    assert_string_equal(answer_to(&robot, "n\n"),
                        "Not resending messages.\n\a\aResend active and/or pending messages for "
                        "the Camera resource?");
    resend_set_asking(&robot.station.server, false); /* the terminal has gone */
    assert_false(resend_asks(&robot.station.server));
    peer_connect(&robot.station, &again, "Camera");
    peer_subscribe(&again, "Ping", 1);
    peer_expect(&again, "1 Ping 1, 1 Ping 2, 1 Ping 3");
    close_robot(&robot);
}

static void what_waits_for_an_answer_ends_with_the_server(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot);
    resend_set_asking(&robot.station.server, true);
    publish_three(&robot);
    peer_lose(&robot.arm);
    close_robot(&robot); /* which looks for what is left over */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_broadcast_goes_only_to_who_has_lost_it),
        cmocka_unit_test(it_is_lost_and_sent_as_often_as_needed),
        cmocka_unit_test(a_query_goes_to_another_handler_or_the_next_that_comes),
        cmocka_unit_test(what_the_module_has_finished_is_not_sent_again),
        cmocka_unit_test(without_the_option_it_is_cleared),
        cmocka_unit_test(somebody_at_a_terminal_is_asked),
        cmocka_unit_test(who_does_not_want_it_loses_it),
        cmocka_unit_test(one_question_comes_after_another_and_none_without_a_terminal),
        cmocka_unit_test(what_waits_for_an_answer_ends_with_the_server),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
