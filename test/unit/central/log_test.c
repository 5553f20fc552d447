/*
 * The exact lines of the log, by the scenarios of the sample logs.
 */
#include "station.h"

#include <stdio.h>
#include <string.h>

static void fixed_clock(struct local_time *time)
{
    memset(time, 0, sizeof *time);
    time->hour = 2;
    time->minute = 21;
    time->second = 19;
    time->hundredths = 73;
}

static void open_with(struct station *station, const char *option)
{
    const char *const arguments[] = {option, NULL};
    station_open(station, arguments);
    station->server.log.clock = fixed_clock;
    (void)station_log(station);
}

/* Three modules; Planner's Ping is handled by Arm and Camera. */
struct robot {
    struct station station;
    struct peer planner, arm, camera;
};

static void open_robot(struct robot *robot, const char *option)
{
    open_with(&robot->station, option);
    peer_connect(&robot->station, &robot->planner, "Planner");
    peer_connect(&robot->station, &robot->arm, "Arm");
    peer_connect(&robot->station, &robot->camera, "Camera");
    peer_define(&robot->planner, "Ping", "int");
    peer_define(&robot->planner, "Where", "int");
    peer_define(&robot->planner, "Here", "int");
    station_run(&robot->station);
    (void)station_log(&robot->station);
}

static void the_default_terminal_log(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-lmsi");
    peer_subscribe(&robot.arm, "Ping", 1);
    peer_subscribe(&robot.camera, "Ping", 1);
    peer_publish(&robot.planner, "Ping", 1);
    peer_publish(&robot.planner, "Ping", 2);
    peer_expect(&robot.arm, "1 Ping 1, 1 Ping 2");
    peer_expect(&robot.camera, "1 Ping 1, 1 Ping 2");
    station_run(&robot.station);
    assert_string_equal(station_log(&robot.station),
                        "Broadcast            Ping:    Planner --> Arm             (Sent)\n"
                        "Broadcast            Ping:    Planner --> Camera          (Sent)\n"
                        "Broadcast            Ping:    Planner --> Resource Arm    (Pending)\n"
                        "Broadcast            Ping:    Planner --> Resource Camera (Pending)\n"
                        "  Done               Ping:\n"
                        "Broadcast            Ping: Resource Arm --> Arm             (Sent)\n"
                        "  Done               Ping:\n"
                        "  Done               Ping:\n"
                        "Broadcast            Ping: Resource Camera --> Camera          (Sent)\n"
                        "  Done               Ping:\n");
    station_close(&robot.station);
}

static void references_parents_times_and_data(void **state)
{
    struct robot robot;
    struct frame query;
    (void)state;
    open_robot(&robot, "-lmtdirp");
    peer_subscribe(&robot.arm, "Where", 1);
    (void)peer_query(&robot.planner, "Where", 5);
    assert_string_equal(peer_delivery(&robot.arm, &query), "1 Where 5");
    (void)peer_query(&robot.planner, "Where", 7);
    peer_respond(&robot.arm, &query, "Here", 42);
    station_run(&robot.station);
    assert_string_equal(
        station_log(&robot.station),
        "Query               Where {0}:    Planner {-1} --> Arm             (Sent)  2:21:19.73\n"
        "    5\n"
        "Query               Where {1}:    Planner {-1} --> Resource Arm    (Pending)  2:21:19.73\n"
        "  Reply            Where {0}:        Arm --> Planner         {-1}  2:21:19.73\n"
        "    42\n"
        "Query               Where {1}: Resource Arm --> Arm             (Sent)  2:21:19.73\n"
        "    7\n");
    station_close(&robot.station);
}

static void a_query_that_waits_for_a_handler(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-lmsi");
    (void)peer_query(&robot.planner, "Where", 5);
    peer_subscribe(&robot.arm, "Where", 1);
    assert_string_equal(station_log(&robot.station),
                        "Query               Where:    Planner --> Resource Where  (Pending)\n"
                        "   Transferring Where from Resource Arm to Arm\n"
                        "Query               Where: Resource Arm --> Arm             (Sent)\n");
    station_close(&robot.station);
}

static void limits_and_capacity(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-lmsir");
    peer_subscribe(&robot.arm, "Ping", 1);
    peer_set_limit(&robot.arm, "Ping", 1);
    for (int i = 0; i < 3; i++) {
        peer_publish(&robot.planner, "Ping", i);
    }
    peer_set_limit(&robot.arm, "Ping", 2);
    peer_set_capacity(&robot.arm, 3);
    peer_set_capacity(&robot.arm, 0);
    assert_string_equal(station_log(&robot.station),
                        "Broadcast            Ping {0}:    Planner --> Arm             (Sent)\n"
                        "Broadcast            Ping {1}:    Planner --> Resource Arm    (Pending)\n"
                        "PENDING LIMIT: Deleted message Ping {1}\n"
                        "Broadcast            Ping {2}:    Planner --> Resource Arm    (Pending)\n"
                        "WARNING: Changing pending message limit of Ping from 1 to 2\n"
                        "\nWARNING: Capacity of -1:Arm changed to 3\n"
                        "Broadcast            Ping {2}: Resource Arm --> Arm             (Sent)\n"
                        "\nWARNING: Capacity of -1:Arm set to 1\n");
    station_close(&robot.station);
}

static void requests_to_the_server_with_what_they_cause(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-lmsd");
    peer_subscribe(&robot.arm, "Ping", 198);
    assert_string_equal(
        station_log(&robot.station),
        "Inform    x_ipc_registerHandlerMsg:        Arm --> X_IPC Server    (Sent)\n"
        "    {198, \"Ping\", \"HND-Ping198\"}\n"
        "Inform    V_set_X_IPC_BROADCAST_MSG_VAR: X_IPC Server --> X_IPC Server    (Sent)\n"
        "    {1, 1, <\"Ping\">}\n"
        "  Done    V_set_X_IPC_BROADCAST_MSG_VAR:\n"
        "  Done    x_ipc_registerHandlerMsg:\n");
    assert_true(peer_id_of(&robot.arm, "Ping") > 0);
    const char *text = station_log(&robot.station);
    assert_non_null(strstr(text,
                           "Query     x_ipc_msgInfoMsg:        Arm --> X_IPC Server    (Sent)\n"
                           "    {\"Ping\", \"NULL\"}\n"
                           "  Reply  x_ipc_msgInfoMsg: X_IPC Server --> Arm            \n"));
    assert_non_null(strstr(text, ", \"Ping\", 15, {int, <byte : 1>}, int}\n"));
    peer_define(&robot.planner, "Ping", "double");
    station_run(&robot.station);
    assert_non_null(strstr(station_log(&robot.station),
                           "    {\"Ping\", 15, \"{int, <byte:1>}\", \"double\"}\n"
                           "Registration: Message Ping Found. Updating.\n"
                           "WARNING: Planner on robot: it defines Ping as double (variable "
                           "length), but Planner as int (variable length): it is double instead of "
                           "int\n"
                           "  Done    x_ipc_registerMessageMsg:\n"));
    station_close(&robot.station);
}

static void the_registrations_at_the_start(void **state)
{
    static const char *const arguments[] = {"-lmsd", NULL};
    struct station station;
    (void)state;
    station_open(&station, arguments);
    const char *text = station_log(&station);
    assert_non_null(
        strstr(text, "Inform    x_ipc_registerGlobalVar: X_IPC Server --> X_IPC Server    (Sent)\n"
                     "    {\"CENTRAL_TERMINAL_LOG_VAR\", \"\n"
                     "     {*int,int,int,int,int,int,int,int,int,int,int,int}\"}\n"
                     "  Done    x_ipc_registerGlobalVar:\n"));
    assert_non_null(strstr(
        text, "Inform    V_set_CENTRAL_TERMINAL_LOG_VAR: X_IPC Server --> X_IPC Server    (Sent)\n"
              "    {NULL, 1, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}\n"
              "  Done    V_set_CENTRAL_TERMINAL_LOG_VAR:\n"));
    assert_non_null(strstr(text, "    {\"X_IPC_TAPPED_MSG_VAR\", \"{int, int, <string:2>}\"}\n"));
    assert_non_null(
        strstr(text, "Inform    V_set_X_IPC_BROADCAST_MSG_VAR: X_IPC Server --> X_IPC Server    "
                     "(Sent)\n    {0, 0, NULL}\n  Done    V_set_X_IPC_BROADCAST_MSG_VAR:\n"));
    station_close(&station);
}

static void ignored_messages_do_not_show_where_a_log_ignores(void **state)
{
    struct robot robot;
    char *ping = (char *)(uintptr_t) "PING";
    (void)state;
    open_robot(&robot, "-lmi");
    peer_subscribe(&robot.arm, "Ping", 1);
    (void)peer_tell(&robot.planner, LM_IGNORE_LOGGING, &ping);
    station_run(&robot.station);
    peer_publish(&robot.planner, "Ping", 1);
    peer_expect(&robot.arm, "1 Ping 1");
    assert_string_equal(station_log(&robot.station), "");
    (void)peer_tell(&robot.planner, LM_RESUME_LOGGING, &ping);
    station_run(&robot.station);
    peer_publish(&robot.planner, "Ping", 2);
    assert_string_equal(station_log(&robot.station),
                        "Broadcast            Ping:    Planner --> Arm             (Sent)\n");
    station_close(&robot.station);
}

static void raw_empty_and_bad_data(void **state)
{
    struct robot robot;
    struct frame frame;
    const uint8_t bytes[] = {1, 2, 0xff, 0x61};
    (void)state;
    open_robot(&robot, "-lmdi");
    const struct message_definition fixed = {(char *)(uintptr_t) "Fix", CLASS_BROADCAST,
                                             (char *)(uintptr_t) "[byte:4]", NULL};
    const struct message_definition empty = {(char *)(uintptr_t) "Empty", CLASS_BROADCAST, NULL,
                                             NULL};
    (void)peer_tell(&robot.planner, LM_DEFINE_MESSAGE, &fixed);
    (void)peer_tell(&robot.planner, LM_DEFINE_MESSAGE, &empty);
    peer_define(&robot.planner, "Raw", NULL);
    peer_define(&robot.planner, "Bad", "{nonsense");
    station_run(&robot.station);
    peer_set_capacity(&robot.arm, 10);
    peer_subscribe(&robot.arm, "Fix", 1);
    peer_subscribe(&robot.arm, "Empty", 1);
    peer_subscribe(&robot.arm, "Raw", 1);
    peer_subscribe(&robot.arm, "Bad", 1);
    (void)station_log(&robot.station);
    peer_frame(&robot.planner, &frame, CLASS_BROADCAST,
               message_find(&robot.station.server.messages, "Fix")->id);
    frame.data = bytes;
    frame.data_length = sizeof bytes;
    peer_send(&robot.planner, &frame);
    peer_frame(&robot.planner, &frame, CLASS_BROADCAST,
               message_find(&robot.station.server.messages, "Empty")->id);
    peer_send(&robot.planner, &frame);
    peer_publish(&robot.planner, "Raw",
                 byte_order_of_host() == ORDER_LITTLE ? 0x61020100 : 0x00010261);
    peer_publish(&robot.planner, "Bad", 1);
    assert_string_equal(station_log(&robot.station),
                        "Broadcast             Fix:    Planner --> Arm             (Sent)\n"
                        "    [0x1, 0x2, 0xff, 0x61]\n"
                        "Broadcast           Empty:    Planner --> Arm             (Sent)\n"
                        "Broadcast             Raw:    Planner --> Arm             (Sent)\n"
                        "    {4, <0, 0x1, 0x2, 0x61>}\n"
                        "Broadcast             Bad:    Planner --> Arm             (Sent)\n"
                        "    Bad Format\n");
    station_close(&robot.station);
}

static uint64_t slow_clock(void)
{
    static uint64_t now;
    return now += 3000000; /* every look takes three milliseconds */
}

static void a_summary_of_every_message_that_is_read(void **state)
{
    struct station station;
    struct peer peer;
    const int class = 4;
    (void)state;
    open_with(&station, "-lh");
    station.server.clock = slow_clock;
    peer_greet(&station, &peer, "M");
    (void)peer_id_of(&peer, "x_ipc_classInfoMsg");
    (void)peer_tell(&peer, LM_CLASS_INFO, &class);
    station_run(&station);
    assert_string_equal(station_log(&station),
                        "    1: Msg: 0.00%, Mon: 0.00%, Wait 0.00%, Msg: (27, 3) Ave: (27, 3)\n"
                        "    2: Msg: 0.00%, Mon: 0.00%, Wait 100.00%, Msg: (4, 3) Ave: (15, 3)\n");
    station_close(&station);
}

static void a_full_terminal_loses_lines_and_says_how_many(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-lmi");
    peer_subscribe(&robot.arm, "Ping", 1);
    robot.station.server.log.terminal.limit = 200;
    for (int i = 0; i < 10; i++) {
        peer_publish(&robot.planner, "Ping", i);
    }
    const char *text = station_log(&robot.station);
    assert_true(strlen(text) <= 200);
    peer_expect(&robot.arm, "1 Ping 0");
    station_run(&robot.station);
    assert_string_equal(station_log(&robot.station),
                        "*** 8 log lines lost ***\n"
                        "  Done               Ping:\n"
                        "Broadcast            Ping: Resource Arm --> Arm             (Sent)\n");
    station_close(&robot.station);
}

static void silence_is_silent(void **state)
{
    struct robot robot;
    (void)state;
    open_robot(&robot, "-s");
    peer_subscribe(&robot.arm, "Ping", 1);
    peer_publish(&robot.planner, "Ping", 1);
    peer_lose(&robot.arm);
    assert_string_equal(station_log(&robot.station), "");
    station_close(&robot.station);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_default_terminal_log),
        cmocka_unit_test(references_parents_times_and_data),
        cmocka_unit_test(a_query_that_waits_for_a_handler),
        cmocka_unit_test(limits_and_capacity),
        cmocka_unit_test(requests_to_the_server_with_what_they_cause),
        cmocka_unit_test(the_registrations_at_the_start),
        cmocka_unit_test(ignored_messages_do_not_show_where_a_log_ignores),
        cmocka_unit_test(raw_empty_and_bad_data),
        cmocka_unit_test(a_summary_of_every_message_that_is_read),
        cmocka_unit_test(a_full_terminal_loses_lines_and_says_how_many),
        cmocka_unit_test(silence_is_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
