/*
 * Typed commands and their answers.
 */
#include "station.h"

#include <string.h>

#include "central/console.h"

struct fixture {
    struct station station;
    struct console console;
    struct peer planner, arm;
};

static void open_fixture(struct fixture *f)
{
    static const char *const arguments[] = {"-lx", NULL};
    station_open(&f->station, arguments);
    console_init(&f->console, &f->station.server);
    peer_connect(&f->station, &f->planner, "Planner");
    peer_connect(&f->station, &f->arm, "Arm");
    peer_define(&f->planner, "Ping", "int");
    station_run(&f->station);
    peer_subscribe(&f->arm, "Ping", 1);
    (void)station_log(&f->station);
}

static void close_fixture(struct fixture *f)
{
    console_fini(&f->console);
    station_close(&f->station);
}

/* The answer to some typed text. */
static const char *answer_to(struct fixture *f, const char *typed)
{
    console_feed(&f->console, typed, strlen(typed));
    return station_log(&f->station);
}

static void status_and_display(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    peer_publish(&f.planner, "Ping", 1);
    peer_publish(&f.planner, "Ping", 2);
    (void)peer_query(&f.planner, "Ping", 3);
    peer_define(&f.planner, "Where", "int");
    station_run(&f.station);
    (void)peer_query(&f.planner, "Where", 4);
    assert_string_equal(answer_to(&f, "status\n"),
                        "Resource status\n"
                        " Resource Planner  Attending: 0  Pending: 0 Resource Status: Active\n"
                        " Resource Arm  Attending: 1  Pending: 2 Resource Status: Active\n"
                        " Resource Where  Attending: 0  Pending: 1 Resource Status: Active\n"
                        "> ");
    assert_string_equal(answer_to(&f, "DISP\n"), "Active and Pending Messages:\n"
                                                 "  Ping {0}: Active\n"
                                                 "  Ping {1}: Pending\n"
                                                 "  Ping {2}: Pending\n"
                                                 "  Where {3}: Pending\n"
                                                 "> ");
    close_fixture(&f);
}

static void lines_may_come_in_pieces_and_many_at_once(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    assert_string_equal(answer_to(&f, "sta"), "");
    assert_non_null(strstr(answer_to(&f, "tus\r\n"), "Resource status\n"));
    assert_string_equal(answer_to(&f, "\n  \n\n"), "> > > ");
    const char *text = answer_to(&f, "display\nclose Nobody \nstat\n");
    assert_non_null(strstr(text, "Active and Pending Messages:\n> Can not find Nobody to close.\n"
                                 "> Resource status\n"));
    close_fixture(&f);
}

static void unknown_commands_get_the_listing(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    const char *text = answer_to(&f, "please display\n");
    assert_ptr_equal(text, strstr(text, "Unrecognized Command :please display\n\n"
                                        "The following command are available:\n"
                                        "help: print this message.\n"
                                        "display : Display active and pending messages.\n"));
    assert_non_null(strstr(text, "unlock <resource>: Unlock a locked resouce.\nThe following "
                                 "command line options can also be used as commands\n -v: "));
    assert_null(strstr(text, "-p<port>"));
    assert_int_equal(strncmp(answer_to(&f, "?\n"), "\nThe following command", 22), 0);
    close_fixture(&f);
}

static void modules_can_be_closed(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    assert_string_equal(answer_to(&f, "close X_IPC Server\n"),
                        "Can not find X_IPC Server to close.\n> ");
    assert_string_equal(answer_to(&f, "close \"arm\"\n"), "close Module: Closing Arm\n> ");
    station_run(&f.station);
    assert_true(peer_is_closed(&f.arm));
    assert_false(peer_is_closed(&f.planner));
    close_fixture(&f);
}

static void locks_can_be_released_by_resource_or_holder(void **state)
{
    struct fixture f;
    char *arm = (char *)(uintptr_t) "Arm";
    int number;
    (void)state;
    open_fixture(&f);
    assert_true(peer_ask(&f.planner, LM_LOCK, &arm, &number));
    assert_non_null(strstr(answer_to(&f, "status\n"), " Resource Arm  Attending: 0  Pending: 0 "
                                                      "Resource Status: Locked\n"));
    assert_non_null(strstr(answer_to(&f, "display\n"), "x_ipc_lockResourceMsg {0}: Completed\n"));
    peer_publish(&f.planner, "Ping", 1);
    assert_string_equal(answer_to(&f, "unlock Arm\n"), "> ");
    peer_expect(&f.arm, "1 Ping 1");
    assert_true(peer_ask(&f.planner, LM_LOCK, &arm, &number));
    peer_publish(&f.planner, "Ping", 2);
    assert_string_equal(answer_to(&f, "unlock planner\n"), "> ");
    peer_expect(&f.arm, "1 Ping 2");
    assert_string_equal(answer_to(&f, "unlock Nobody\n"), "Can not find Nobody to unlock.\n> ");
    close_fixture(&f);
}

static void options_can_be_typed(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    const char *text = answer_to(&f, "-lmi -iPing\n");
    assert_int_equal(strncmp(text, "Task Control Server ", 20), 0);
    peer_publish(&f.planner, "Ping", 1);
    assert_string_equal(station_log(&f.station), "");
    (void)answer_to(&f, "-lm\n");
    peer_expect(&f.arm, "1 Ping 1");
    station_run(&f.station);
    assert_non_null(strstr(station_log(&f.station), "  Done               Ping:\n"));
    assert_string_equal(answer_to(&f, "-u\nstatus\n"),
                        "Task Control Server " IPC_VERSION " (" IPC_RELEASE_DATE ")\n");
    close_fixture(&f);
}

static void memory_and_quit(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    const char *text = answer_to(&f, "memory\n");
    assert_int_equal(strncmp(text, "Cumulative Memory Usage:\n  Requests: ", 37), 0);
    assert_non_null(strstr(text, " bytes)\nData Msg Buffer Stats:\n  Total Alloc  : "));
    assert_string_equal(answer_to(&f, "q\nstatus\n"), "");
    assert_true(f.console.wants_to_quit);
    close_fixture(&f);
}

static void endless_lines_are_dropped(void **state)
{
    struct fixture f;
    char text[1000];
    (void)state;
    open_fixture(&f);
    memset(text, 'x', sizeof text);
    for (int i = 0; i < 100; i++) {
        console_feed(&f.console, text, sizeof text);
    }
    assert_true(f.console.line.length <= 64 * 1024);
    assert_string_equal(answer_to(&f, "\n"), "> ");
    assert_non_null(strstr(answer_to(&f, "display\n"), "Active and Pending"));
    close_fixture(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(status_and_display),
        cmocka_unit_test(lines_may_come_in_pieces_and_many_at_once),
        cmocka_unit_test(unknown_commands_get_the_listing),
        cmocka_unit_test(modules_can_be_closed),
        cmocka_unit_test(locks_can_be_released_by_resource_or_holder),
        cmocka_unit_test(options_can_be_typed),
        cmocka_unit_test(memory_and_quit),
        cmocka_unit_test(endless_lines_are_dropped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
