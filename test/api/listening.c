/*
 * Listening: what the calls do, how long they take, in which order things happen (T84 to T100).
 */
#include "check.h"

#include <ipcx.h>

#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

/* The library cannot be that punctual on a busy machine, and has to be no more punctual than this.
 */
#define EXPECT_AT_LEAST(milliseconds, start) EXPECT(now_ms() - (start) >= (milliseconds) - 5)

static void note_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    record("%s ", (const char *)client_data);
}

static void read_fd(int fd, void *client_data)
{
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    record("%s ", (const char *)client_data);
}

CHECK(every_listening_call_waits_and_then_says_that_time_is_over)
{
    connected();
    IPC_listenClear(50);
    long start = now_ms();
    EXPECT_TIMEOUT(IPC_listen(300));
    EXPECT_AT_LEAST(300, start);
    start = now_ms();
    EXPECT_TIMEOUT(IPC_listenClear(300));
    EXPECT_AT_LEAST(300, start);
    start = now_ms();
    EXPECT_TIMEOUT(IPC_listenWait(300));
    EXPECT_AT_LEAST(300, start);
    start = now_ms();
    EXPECT_TIMEOUT(IPC_handleMessage(300));
    EXPECT_AT_LEAST(300, start);
}

/* Four messages that have arrived and wait for a listening call. */
static void let_four_wait(void)
{
    define_int("m");
    IPC_setCapacity(5);
    IPC_subscribe("m", note_a, "");
    settle();
    EXPECT(IPC_msgFormatter("m") != NULL);
    publish_int("m", 0);
    listen_until(1);
    recorded();
    for (int i = 1; i <= 4; i++) {
        publish_int("m", i);
    }
    let_arrive();
}

CHECK(handle_message_handles_one_event)
{
    connected();
    let_four_wait();
    const char *const expected[] = {"1 ", "2 ", "3 ", "4 "};
    for (int i = 0; i < 4; i++) {
        EXPECT_OK(IPC_handleMessage(1000));
        EXPECT_TEXT(recorded(), expected[i]);
    }
    EXPECT_TIMEOUT(IPC_handleMessage(100));
}

CHECK_NEW(handle_message_takes_a_descriptor_when_there_is_no_message)
{
    int ends[2];
    connected();
    let_four_wait();
    EXPECT_INT(pipe(ends), 0);
    IPC_subscribeFD(ends[0], read_fd, "fd");
    EXPECT_INT(write(ends[1], "x", 1), 1);
    for (int i = 0; i < 5; i++) {
        EXPECT_OK(IPC_handleMessage(1000));
        EXPECT_INT(n_recorded(), i + 1);
    }
    EXPECT_TIMEOUT(IPC_handleMessage(50));
    EXPECT_TEXT(recorded(), "1 2 3 4 fd ");
}

CHECK_NEW(listen_handles_all_that_wait)
{
    connected();
    let_four_wait();
    EXPECT_OK(IPC_listen(100));
    EXPECT_TEXT(recorded(), "1 2 3 4 ");
    EXPECT_TIMEOUT(IPC_listen(50));
}

CHECK(listen_clear_handles_all_that_wait)
{
    connected();
    let_four_wait();
    EXPECT_OK(IPC_listenClear(100));
    EXPECT_TEXT(recorded(), "1 2 3 4 ");
    EXPECT_TIMEOUT(IPC_listenClear(50));
}

PLAYER(sends_two_later)
{
    define_int("m");
    player_say(0);
    player_wait();
    sleep_ms(100);
    publish_int("m", 1);
    sleep_ms(100);
    publish_int("m", 2);
    player_wait();
}

CHECK(listen_wait_uses_all_of_its_time)
{
    struct central *central = connected();
    define_int("m");
    IPC_subscribe("m", note_a, "");
    settle();
    struct module *module = module_start("sends_two_later", central);
    module_tell(module, 1);
    const long start = now_ms();
    EXPECT(IPC_listenWait(500) != IPC_Error);
    EXPECT_AT_LEAST(500, start);
    listen_until(2);
    EXPECT_TEXT(recorded(), "1 2 ");
}

CHECK(timers_do_not_end_listening)
{
    connected();
    IPC_listenClear(20);
    IPC_addPeriodicTimer(200, note_timer, "timer");
    const long start = now_ms();
    EXPECT_TIMEOUT(IPC_listen(900));
    EXPECT_AT_LEAST(900, start);
    EXPECT(n_recorded() >= 3 && n_recorded() <= 4);
}

static volatile sig_atomic_t n_alarms;

static void count_alarm(int number)
{
    (void)number;
    n_alarms++;
}

CHECK(signals_do_not_end_listening)
{
    struct sigaction action = {.sa_handler = count_alarm};
    struct itimerval often = {{0, 200000}, {0, 200000}};
    struct itimerval never = {{0, 0}, {0, 0}};
    connected();
    IPC_listenClear(20);
    sigaction(SIGALRM, &action, NULL);
    setitimer(ITIMER_REAL, &often, NULL);
    const long start = now_ms();
    EXPECT_TIMEOUT(IPC_listen(1000));
    EXPECT_AT_LEAST(1000, start);
    setitimer(ITIMER_REAL, &never, NULL);
    EXPECT(n_alarms >= 3);
}

PLAYER(subscribes_and_unsubscribes)
{
    player_say(0);
    player_wait();
    IPC_subscribe("m", note_a, NULL);
    IPC_unsubscribe("m", note_a);
    player_say(IPC_numHandlers("m"));
    player_wait();
}

CHECK_NEW(subscriptions_of_others_do_not_end_listening)
{
    struct central *central = connected();
    struct module *module = module_start("subscribes_and_unsubscribes", central);
    const long start = now_ms();
    module_tell(module, 1);
    EXPECT_TIMEOUT(IPC_listen(300));
    EXPECT_AT_LEAST(300, start);
    EXPECT_INT(module_hear(module), 0);
}

/* -------------------------------------------------------- disconnecting while listening */

static void disconnect(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    note_a(instance, content, client_data);
    EXPECT_OK(IPC_disconnect());
}

static void subscribe_to_disconnect(void)
{
    define_int("m");
    IPC_subscribe("m", disconnect, "");
    settle();
    publish_int("m", 1);
}

CHECK(listening_ends_well_when_a_handler_disconnects)
{
    connected();
    subscribe_to_disconnect();
    IPC_RETURN_TYPE result = IPC_OK;
    while (n_recorded() == 0 && result != IPC_Error) {
        result = IPC_listen(2000);
    }
    EXPECT_INT(result, IPC_OK);
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    EXPECT_TEXT(recorded(), "1 ");
}

CHECK(dispatching_ends_when_a_handler_disconnects)
{
    connected();
    subscribe_to_disconnect();
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_ERROR(IPC_dispatch(), IPC_Not_Connected);
    EXPECT_TEXT(captured_stderr(), "ERROR: Not connected to IPC central\n");
    IPC_setVerbosity(IPC_Silent);
}

static const char *address;

static void dispatch_or_exit(void)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_connectModule("A", address);
    subscribe_to_disconnect();
    IPC_setVerbosity(IPC_Exit_On_Errors);
    IPC_dispatch();
}

CHECK(dispatching_ends_the_process_when_errors_do)
{
    address = central_start(NULL)->address;
    const struct outcome outcome = run_apart(dispatch_or_exit);
    EXPECT_INT(outcome.status, 255);
    EXPECT_TEXT(outcome.err, "ERROR: Not connected to IPC central\n");
}

static void begin_anew(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    note_a(instance, content, client_data);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("B", address));
    IPC_subscribe("m", note_b, "new");
}

CHECK_NEW(a_handler_may_begin_a_new_connection)
{
    char line[80];
    struct central *central = connected();
    address = central->address;
    define_int("m");
    IPC_subscribe("m", begin_anew, "old");
    publish_int("m", 1);
    snprintf(line, sizeof line, "... IPC Connected on port %d\n", central->port);
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_OK(IPC_listen(2000));
    EXPECT_TEXT(captured_stderr(), line);
    IPC_setVerbosity(IPC_Silent);
    publish_int("m", 2);
    listen_until(2);
    EXPECT_TEXT(recorded(), "old1 new2 ");
}

/* ------------------------------------------------------------------------ order */

CHECK(a_pass_runs_timers_then_descriptors_then_messages)
{
    int low[2];
    int high[2];
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "message");
    settle();
    EXPECT(IPC_msgFormatter("m") != NULL);
    publish_int("m", 0);
    listen_until(1);
    EXPECT_INT(pipe(low), 0);
    EXPECT_INT(pipe(high), 0);
    EXPECT_INT(write(low[1], "x", 1), 1);
    EXPECT_INT(write(high[1], "x", 1), 1);
    IPC_subscribeFD(high[0], read_fd, "high");
    IPC_subscribeFD(low[0], read_fd, "low");
    publish_int("m", 1);
    TIMER_REF reference;
    IPC_addTimerGetRef(50, 1, note_timer, "timer50", &reference);
    IPC_addTimerGetRef(20, 1, note_timer, "timer20", &reference);
    recorded();
    sleep_ms(200);
    EXPECT_OK(IPC_listen(100));
    listen_until(5);
    EXPECT_TEXT(recorded(), "timer50 timer20 low high message1 ");
}

static void listen_inside(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    static int depth;
    const int number = *(int *)content;
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    record("(%d ", number);
    depth++;
    while (number < 3 && IPC_listen(200) == IPC_OK && depth + number > 100) {
    }
    depth--;
    record("%d) ", number);
}

static void publish_three_to(HANDLER_TYPE handler, int capacity)
{
    connected();
    define_int("m");
    IPC_setCapacity(capacity);
    IPC_subscribe("m", handler, NULL);
    settle();
    EXPECT(IPC_msgFormatter("m") != NULL);
    for (int i = 1; i <= 3; i++) {
        publish_int("m", i);
    }
    let_arrive();
    listen_until(6);
}

CHECK(with_capacity_one_listening_in_a_handler_gets_no_message)
{
    publish_three_to(listen_inside, 1);
    EXPECT_TEXT(recorded(), "(1 1) (2 2) (3 3) ");
}

CHECK(with_more_capacity_listening_in_a_handler_nests)
{
    publish_three_to(listen_inside, 5);
    EXPECT_TEXT(recorded(), "(1 (2 (3 3) 2) 1) ");
}

CHECK_NEW(no_handler_runs_inside_a_call_that_does_not_listen)
{
    struct central *central = connected();
    let_four_wait();
    IPC_addOneShotTimer(1, note_timer, "timer");
    sleep_ms(20);
    central_stop(central);
    if (fork() == 0) {
        sleep_ms(300);
        central_continue(central);
        _exit(0);
    }
    EXPECT_INT(IPC_isMsgDefined("zz"), 0);
    EXPECT_TEXT(recorded(), "");
    EXPECT_OK(IPC_listen(1000));
    EXPECT_TEXT(recorded(), "timer 1 2 3 4 ");
}

/* ------------------------------------------------------------------------ clock */

static long wall_clock_offset;

/* Takes the place of the C library's functions for the whole program. */
int clock_gettime(clockid_t clock, struct timespec *now)
{
    const int result = (int)syscall(SYS_clock_gettime, clock, now);
    if (result == 0 && clock == CLOCK_REALTIME) {
        now->tv_sec += wall_clock_offset;
    }
    return result;
}

int gettimeofday(struct timeval *now, void *zone)
{
    struct timespec precise;
    (void)zone;
    const int result = clock_gettime(CLOCK_REALTIME, &precise);
    now->tv_sec = precise.tv_sec;
    now->tv_usec = precise.tv_nsec / 1000;
    return result;
}

static void set_clock_back(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    wall_clock_offset = -3600;
    record("%s ", (const char *)client_data);
}

CHECK_NEW(setting_the_wall_clock_changes_no_timeout)
{
    connected();
    IPC_addOneShotTimer(200, set_clock_back, "back");
    TIMER_REF reference;
    IPC_addTimerGetRef(400, 1, note_timer, "timer", &reference);
    const long start = now_ms();
    EXPECT_TIMEOUT(IPC_listen(1000));
    EXPECT_AT_LEAST(1000, start);
    EXPECT_TEXT(recorded(), "back timer ");
}

/* --------------------------------------------------------------------------- other event loops */

CHECK_NEW(what_a_question_has_taken_in_wakes_another_event_loop)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    struct pollfd item = {IPCx_fd(), POLLIN, 0};
    for (int i = 0; i < 10 && poll(&item, 1, 0) != 0; i++) {
        EXPECT_TIMEOUT(IPCx_process()); /* woken for nothing, which connecting may do */
    }
    EXPECT_INT(poll(&item, 1, 0), 0);
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(IPC_isMsgDefined("undefined"), 0);
    EXPECT_INT(poll(&item, 1, 5000), 1);
    EXPECT_OK(IPCx_process());
    EXPECT_TEXT(recorded(), "m1 ");
}
