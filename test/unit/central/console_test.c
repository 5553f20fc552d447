/*
 * Typed commands and their answers.
 */
#include "station.h"

#include <stdio.h>
#include <string.h>

#include "central/operator/console.h"

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
    assert_non_null(strstr(text, "unlock <resource>: Unlock a locked resouce.\nmodules : "));
    assert_non_null(strstr(text, "what waits.\nThe following command line options can also be used "
                                 "as commands\n -v: "));
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

static void tables_of_what_goes_through(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    peer_set_limit(&f.arm, "Ping", 1);
    station_pass_time(&f.station, 10);
    for (int number = 1; number <= 3; number++) {
        peer_publish(&f.planner, "Ping", number);
    }
    peer_define(&f.planner, "Where", "int");
    station_run(&f.station);
    (void)peer_query(&f.planner, "Where", 5);
    station_run(&f.station);
    (void)station_log(&f.station);
    assert_string_equal(
        answer_to(&f, "queues\n"),
        "Resource     State  Capacity    Active   Waiting     bytes   Dropped Held back\n"
        "Planner     Active         1         0         0         0         0         0\n"
        "Arm         Active         1         1         1        12         1         0\n"
        "Where    no handler         0         0         1        12         0         0\n"
        "> ");
    assert_string_equal(
        answer_to(&f, "messages\n"),
        "Message  Handlers      Sent     per s     bytes   bytes/s Delivered   Waiting   Dropped\n"
        "Ping            1         3         3        36        36         1         1         1\n"
        "Where           0         1         1        12        12         0         1         0\n"
        "> ");
    assert_non_null(strstr(answer_to(&f, "messages all\n"), "\nx_ipc_lockResourceMsg"));
    const char *text = answer_to(&f, "modules\n");
    assert_ptr_equal(text, strstr(text, "Module  Host      State     Sends     per s     bytes   "
                                        "bytes/s      Gets     per s     bytes   bytes/s    "
                                        "Unread\nPlanner robot     ready "));
    assert_non_null(strstr(text, "\nArm     robot     ready "));
    station_pass_time(&f.station, 10);
    assert_non_null(strstr(answer_to(&f, "messages\n"),
                           "Ping            1         3         0        36         0  "));
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

/* The content of a file, which is removed; valid until the next time. */
static const char *taken_file(const char *path)
{
    static char text[5000];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    assert_int_equal(remove(path), 0);
    return text;
}

#define STARS_40 "****************************************"
#define BOX_TOP                                                                                    \
    "\n" STARS_40 STARS_40                                                                         \
    "\n*                                   Comments                                   *\n"         \
    "*                                                                              *\n"
#define BOX_BOTTOM                                                                                 \
    "*                                                                              "              \
    "*\n" STARS_40 STARS_40 "\n\n"
#define PROMPT "Enter any comments in the log file (end with blank line)\n"

static void comments_are_asked_for_at_a_terminal(void **state)
{
    static const char path[] = "console_test_comments.log";
    struct fixture f;
    (void)state;
    open_fixture(&f);
    f.console.may_ask = true;
    const char *text = answer_to(&f, "-Lmi -fconsole_test_comments.log\n");
    assert_non_null(strstr(text, "Logging to console_test_comments.log;\n" PROMPT));
    assert_string_equal(answer_to(&f, "Second test of the day\n"), "");
    peer_lose(&f.planner); /* the server goes on meanwhile */
    station_run(&f.station);
    assert_non_null(strstr(station_log(&f.station), "close Module: Closing Planner\n"));
    assert_string_equal(
        answer_to(&f, "A longer comment line that is more than seventy-six characters wide and so "
                      "is split in two\n\n"),
        "> ");
    assert_string_equal(answer_to(&f, "quit\n"), PROMPT);
    assert_false(f.console.wants_to_quit);
    assert_string_equal(answer_to(&f, "quit\n\n"), ""); /* a comment */
    assert_true(f.console.wants_to_quit);
    log_close(&f.station.server.log);
    text = strchr(taken_file(path), '\n') + 1; /* behind the header */
    assert_string_equal(
        text, " Closing Planner on robot\n"
              "close Module: Closing Planner\n" BOX_TOP
              "* Second test of the day                                                       *\n"
              "* A longer comment line that is more than seventy-six characters wide and so i *\n"
              "* s split in two                                                               "
              "*\n" BOX_BOTTOM BOX_TOP "* quit                                                     "
              "                    *\n" BOX_BOTTOM);
    close_fixture(&f);
}

static void comments_end_with_the_input(void **state)
{
    static const char path[] = "console_test_comments.log";
    struct fixture f;
    (void)state;
    open_fixture(&f);
    f.console.may_ask = true;
    (void)answer_to(&f, "-Lmi -fconsole_test_comments.log\nfirst\nlast");
    console_end_input(&f.console);
    assert_false(f.console.comments.asking);
    log_close(&f.station.server.log);
    const char *text = taken_file(path);
    assert_non_null(strstr(text, "* first  "));
    assert_non_null(strstr(text, "* last  "));
    close_fixture(&f);
}

static void nobody_is_asked_for_comments_without_need(void **state)
{
    static const char *const lines[] = {"-Lmin -fconsole_test_comments.log\n",
                                        "-L -fconsole_test_comments.log\n",
                                        "-Lmi -fconsole_test_comments.log\n"};
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(lines); i++) {
        struct fixture f;
        open_fixture(&f);
        f.console.may_ask = i < 2; /* the last one would ask */
        assert_null(strstr(answer_to(&f, lines[i]), PROMPT));
        assert_string_equal(answer_to(&f, "quit\n"), "");
        assert_true(f.console.wants_to_quit);
        close_fixture(&f);
        (void)taken_file("console_test_comments.log");
    }
}

static void a_log_that_is_not_wanted_is_closed_and_goes_on_later(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    (void)answer_to(&f, "-LmiN -fconsole_test.log\nclose nobody\n");
    (void)answer_to(&f, "-Lx\nclose somebody\n");
    assert_false(f.station.server.log.file.is_open);
    assert_non_null(strstr(answer_to(&f, "-LsN\n"), "Logging to console_test.log;\n"));
    (void)answer_to(&f, "close anybody\n");
    log_close(&f.station.server.log);
    const char *text = strchr(taken_file("console_test.log"), '\n') + 1;
    assert_string_equal(text, "Can not find nobody to close.\nCan not find anybody to close.\n");
    close_fixture(&f);
}

static void what_is_typed_last_needs_no_end_of_line(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    (void)answer_to(&f, "close nobody");
    console_end_input(&f.console);
    assert_string_equal(station_log(&f.station), "Can not find nobody to close.\n> ");
    console_end_input(&f.console);
    assert_string_equal(station_log(&f.station), "");
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
        cmocka_unit_test(tables_of_what_goes_through),
        cmocka_unit_test(memory_and_quit),
        cmocka_unit_test(endless_lines_are_dropped),
        cmocka_unit_test(comments_are_asked_for_at_a_terminal),
        cmocka_unit_test(comments_end_with_the_input),
        cmocka_unit_test(nobody_is_asked_for_comments_without_need),
        cmocka_unit_test(a_log_that_is_not_wanted_is_closed_and_goes_on_later),
        cmocka_unit_test(what_is_typed_last_needs_no_end_of_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
