/*
 * Timers (T109 to T126).  Times are in milliseconds; calls may be late on a busy machine, never
 * early.
 */
#include "check.h"

#include <stdint.h>
#include <string.h>

enum { SLACK = 5 };

static long started;
static long starts[64];
static int n_starts;

/* Records its client data and the time. */
static void note_time(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    if (n_starts < 64) {
        starts[n_starts++] = now_ms() - started;
    }
    record("%s ", (const char *)client_data);
}

static void note_other(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
}

static void begin(void)
{
    started = now_ms();
    n_starts = 0;
}

static void expect_start(int number, long milliseconds)
{
    expect(number < n_starts && starts[number] >= milliseconds - SLACK, PLACE,
           "a call that is not early", "call %d of %d at %ld instead of %ld", number, n_starts,
           number < n_starts ? starts[number] : -1, milliseconds);
}

static void capture_warnings(void)
{
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
}

static void expect_warning(const char *place, const char *format, uintptr_t value)
{
    char expected[160];
    const char *found = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    snprintf(expected, sizeof expected, format, (unsigned long)value);
    expect_text(found, expected, place, "the warning");
}

/* ------------------------------------------------------------------------- arguments */

static void expect_arguments_to_be_checked(void)
{
    TIMER_REF reference;
    EXPECT_ERROR(IPC_addTimer(10, 1, NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_addTimer(0, 1, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addTimer(10, 0, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addTimer(10, -2, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addTimer(0, 0, NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_addTimerGetRef(10, 1, NULL, NULL, &reference), IPC_Null_Argument);
    EXPECT_ERROR(IPC_addTimerGetRef(0, 1, note_time, NULL, &reference), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addOneShotTimer(0, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addPeriodicTimer(0, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_removeTimer(NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_removeTimerByRef(NULL), IPC_Null_Argument);
}

CHECK(timers_check_their_arguments_in_every_state)
{
    IPC_setVerbosity(IPC_Silent);
    expect_arguments_to_be_checked();
    IPC_initialize();
    expect_arguments_to_be_checked();
    connected();
    expect_arguments_to_be_checked();
    IPC_disconnect();
    expect_arguments_to_be_checked();
}

CHECK_NEW(negative_delays_are_refused)
{
    connected();
    EXPECT_ERROR(IPC_addOneShotTimer(-1, note_time, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_addPeriodicTimer(-5, note_time, NULL), IPC_Argument_Out_Of_Range);
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    IPC_removeTimer(note_time);
    EXPECT(strstr(captured_stderr(), "does not exist\n") != NULL);
    IPC_setVerbosity(IPC_Silent);
}

/* --------------------------------------------------------------------- counting, replacing */

CHECK(a_counted_timer_is_gone_after_its_last_call)
{
    connected();
    begin();
    EXPECT_OK(IPC_addTimer(50, 3, note_time, "t"));
    listen_until(3);
    listen_for(150);
    EXPECT_TEXT(recorded(), "t t t ");
    expect_start(0, 50);
    expect_start(1, 100);
    expect_start(2, 150);
    capture_warnings();
    EXPECT_OK(IPC_removeTimer(note_time));
    EXPECT(strstr(captured_stderr(), ") does not exist\n") != NULL);
    IPC_setVerbosity(IPC_Silent);
}

CHECK(adding_a_timer_again_replaces_it_with_a_warning)
{
    connected();
    EXPECT_OK(IPC_addPeriodicTimer(40, note_time, "old"));
    listen_for(100);
    EXPECT(n_recorded() >= 1);
    recorded();
    begin();
    capture_warnings();
    EXPECT_OK(IPC_addTimer(30, 2, note_time, "new"));
    expect_warning(PLACE, "Replacing existing timer for handler (0x%lx)\n", (uintptr_t)note_time);
    listen_until(2);
    listen_for(100);
    EXPECT_TEXT(recorded(), "new new ");
    expect_start(0, 30);
    expect_start(1, 60);
}

CHECK(a_finished_timer_is_not_replaced_but_added)
{
    connected();
    EXPECT_OK(IPC_addTimer(10, 1, note_time, "first"));
    listen_until(1);
    capture_warnings();
    EXPECT_OK(IPC_addTimer(10, 1, note_time, "second"));
    expect_warning(PLACE, "", 0);
    listen_until(2);
    EXPECT_TEXT(recorded(), "first second ");
}

CHECK(timers_with_references_stand_beside_each_other)
{
    TIMER_REF first = NULL;
    TIMER_REF second = NULL;
    connected();
    EXPECT_OK(IPC_addTimerGetRef(100, 1, note_time, "100", &first));
    EXPECT_OK(IPC_addTimerGetRef(70, 1, note_time, "70", &second));
    EXPECT(first != NULL && second != NULL && first != second);
    listen_until(2);
    EXPECT_TEXT(recorded(), "70 100 ");
}

CHECK(timers_are_removed_by_handler_oldest_first_and_by_reference)
{
    TIMER_REF first;
    TIMER_REF second;
    connected();
    IPC_addTimerGetRef(60, 1, note_time, "first", &first);
    IPC_addTimerGetRef(60, TRIGGER_FOREVER, note_time, "second", &second);
    EXPECT_OK(IPC_removeTimer(note_time));
    listen_until(1);
    EXPECT_TEXT(recorded(), "second ");
    capture_warnings();
    EXPECT_OK(IPC_removeTimerByRef(second));
    expect_warning(PLACE, "", 0);
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
}

CHECK_NEW(removing_what_is_gone_is_warned_of_with_the_whole_reference)
{
    TIMER_REF first;
    TIMER_REF second;
    connected();
    IPC_addTimerGetRef(1000, 1, note_time, "first", &first);
    EXPECT_OK(IPC_removeTimerByRef(first));
    IPC_addTimerGetRef(1000, 1, note_time, "second", &second);
    EXPECT(first != second);
    capture_warnings();
    EXPECT_OK(IPC_removeTimerByRef(first));
    expect_warning(PLACE, "Timer with ref 0x%lx does not exist\n", (uintptr_t)first);
    capture_warnings();
    EXPECT_OK(IPC_removeTimer(note_other));
    expect_warning(PLACE, "Timer for handler (0x%lx) does not exist\n", (uintptr_t)note_other);
    EXPECT_INT(maxTriggers(first), 0);
    EXPECT_INT(maxTriggers(second), 1);
    capture_warnings();
    EXPECT_OK(IPC_removeTimerByRef(second));
    expect_warning(PLACE, "", 0);
}

CHECK(a_timer_without_a_reference_wanted_is_replaced_as_by_add_timer)
{
    connected();
    EXPECT_OK(IPC_addTimer(40, 1, note_time, "old"));
    EXPECT_OK(IPC_addTimerGetRef(20, 1, note_time, "new", NULL));
    listen_until(1);
    listen_for(60);
    EXPECT_TEXT(recorded(), "new ");
}

/* ------------------------------------------------------------------ what handlers may do */

static TIMER_REF own_reference;

static void remove_by_handler(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
    EXPECT_OK(IPC_removeTimer(remove_by_handler));
}

static void remove_by_reference(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
    EXPECT_OK(IPC_removeTimerByRef(own_reference));
}

CHECK(a_periodic_timer_may_remove_itself)
{
    connected();
    capture_warnings();
    IPC_addPeriodicTimer(20, remove_by_handler, "h");
    IPC_addTimerGetRef(20, TRIGGER_FOREVER, remove_by_reference, "r", &own_reference);
    listen_until(2);
    listen_for(80);
    expect_warning(PLACE, "", 0);
    EXPECT_TEXT(recorded(), "h r ");
}

static int n_again;

static void add_again(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
    if (++n_again < 3) {
        EXPECT_OK(IPC_addOneShotTimer(50, add_again, client_data));
    }
}

CHECK(a_one_shot_timer_may_add_itself_again)
{
    connected();
    begin();
    capture_warnings();
    EXPECT_OK(IPC_addOneShotTimer(50, add_again, "again"));
    listen_until(3);
    listen_for(80);
    expect_warning(PLACE, "", 0);
    EXPECT_TEXT(recorded(), "again again again ");
    expect_start(0, 50);
    expect_start(1, 100);
    expect_start(2, 150);
}

static void remove_other(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
    EXPECT_OK(IPC_removeTimer(note_other));
}

CHECK(a_timer_may_remove_another_one_that_is_due)
{
    connected();
    IPC_addOneShotTimer(20, remove_other, "first");
    IPC_addOneShotTimer(20, note_other, "second");
    sleep_ms(50);
    listen_for(60);
    EXPECT_TEXT(recorded(), "first ");
}

/* ------------------------------------------------------------------------- when and in which order
 */

static void note_lateness(void *client_data, unsigned long now, unsigned long scheduled)
{
    const unsigned long *delay = client_data;
    EXPECT(now >= scheduled);
    EXPECT(now - scheduled + SLACK >= 100 - *delay);
    record("%lu ", *delay);
}

CHECK(due_timers_run_in_the_order_in_which_they_were_added)
{
    static unsigned long delays[] = {50, 30, 40};
    TIMER_REF reference;
    connected();
    for (int i = 0; i < 3; i++) {
        IPC_addTimerGetRef(delays[i], 1, note_lateness, &delays[i], &reference);
    }
    sleep_ms(100);
    IPC_listen(10);
    EXPECT_TEXT(recorded(), "50 30 40 ");
}

CHECK(missed_periods_are_not_made_up_for)
{
    connected();
    begin();
    IPC_addPeriodicTimer(50, note_time, "t");
    sleep_ms(330);
    listen_until(3);
    IPC_removeTimer(note_time);
    expect_start(0, 330);
    EXPECT(starts[1] - starts[0] >= 15);
    EXPECT(starts[2] - starts[0] >= 65);
}

CHECK_NEW(lateness_does_not_add_up)
{
    connected();
    begin();
    IPC_addPeriodicTimer(20, note_time, "t");
    for (int i = 0; i < 40; i++) {
        sleep_ms(7); /* every call is late by some of this */
        IPC_listen(7);
    }
    const long last = now_ms() - started;
    IPC_removeTimer(note_time);
    /* With drift there would be one call in 28, as long as the machine is not busy otherwise. */
    expect(n_starts <= last / 20, PLACE, "no call too many", "%d in %ld", n_starts, last);
    for (int i = 1; i < n_starts; i++) {
        EXPECT(starts[i] >= 20 * (i + 1) - SLACK);
    }
}

static void sleep_130(void *client_data, unsigned long now, unsigned long scheduled)
{
    note_time(client_data, now, scheduled);
    sleep_ms(130);
}

CHECK(a_slow_handler_is_called_again_right_after)
{
    connected();
    begin();
    IPC_addPeriodicTimer(50, sleep_130, "slow");
    listen_until(4);
    IPC_removeTimer(sleep_130);
    expect_start(0, 50);
    for (int i = 1; i < 4; i++) {
        expect_start(i, starts[i - 1] + 130);
    }
}

static int depth;

static void listen_inside(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    EXPECT_INT(depth, 0);
    depth++;
    record("(%s ", (const char *)client_data);
    IPC_listenWait(120);
    record(") ");
    depth--;
}

CHECK(a_timer_is_not_called_while_its_handler_runs_but_others_are)
{
    connected();
    IPC_addPeriodicTimer(30, listen_inside, "A");
    IPC_addOneShotTimer(60, note_time, "B");
    listen_until(3);
    IPC_removeTimer(listen_inside);
    EXPECT(strncmp(recorded(), "(A B ) ", 7) == 0);
}

CHECK_NEW(a_one_shot_timer_may_listen)
{
    connected();
    IPC_addOneShotTimer(20, listen_inside, "once");
    IPC_addOneShotTimer(40, note_time, "B");
    listen_until(3);
    listen_for(50);
    EXPECT_TEXT(recorded(), "(once B ) ");
}

CHECK_NEW(a_timer_whose_handler_listens_may_be_replaced_meanwhile)
{
    TIMER_REF reference;
    connected();
    IPC_addTimerGetRef(20, TRIGGER_FOREVER, listen_inside, "A", &reference);
    IPC_addOneShotTimer(40, remove_other, "B");
    IPC_addOneShotTimer(5000, note_other, "C");
    listen_until(3);
    EXPECT_OK(IPC_removeTimerByRef(reference));
    recorded();
    listen_for(80);
    EXPECT_TEXT(recorded(), "");
}

/* --------------------------------------------------------------------- without a connection */

CHECK(a_timer_added_after_initialising_runs_once_connected)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    EXPECT_OK(IPC_addOneShotTimer(20, note_time, "early"));
    EXPECT_OK(IPC_connectModule("A", central->address));
    listen_until(1);
    EXPECT_TEXT(recorded(), "early ");
}

CHECK_NEW(a_timer_added_in_state_fresh_or_disconnected_runs_once_connected)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_addOneShotTimer(20, note_time, "fresh"));
    EXPECT_OK(IPC_connectModule("A", central->address));
    listen_until(1);
    EXPECT_TEXT(recorded(), "fresh ");
    IPC_disconnect();
    EXPECT_OK(IPC_addOneShotTimer(20, note_time, "disconnected"));
    EXPECT_OK(IPC_connectModule("A", central->address));
    listen_until(1);
    EXPECT_TEXT(recorded(), "disconnected ");
}

/* -------------------------------------------------------------------------------- arguments */

static void compare_clocks(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    EXPECT(x_ipc_timeInMsecs() >= now);
    EXPECT(x_ipc_timeInMsecs() - now < 1000);
    EXPECT(now >= scheduled);
    EXPECT(now - scheduled < 2000);
    record("x");
}

CHECK(the_times_that_a_handler_gets_are_of_the_clock_for_programs)
{
    connected();
    const unsigned long before = x_ipc_timeInMsecs();
    sleep_ms(20);
    EXPECT(x_ipc_timeInMsecs() - before >= 19);
    IPC_addTimer(20, 2, compare_clocks, NULL);
    listen_until(2);
    EXPECT_INT(n_recorded(), 2);
}

CHECK(the_remaining_calls_of_a_timer_can_be_asked_for)
{
    TIMER_REF counted;
    TIMER_REF endless;
    connected();
    IPC_addTimerGetRef(30, 3, note_time, "c", &counted);
    EXPECT_INT(maxTriggers(counted), 3);
    listen_until(1);
    EXPECT_INT(maxTriggers(counted), 2);
    IPC_addTimerGetRef(1000, TRIGGER_FOREVER, note_other, "e", &endless);
    EXPECT_INT((int)maxTriggers(endless), TRIGGER_FOREVER);
}

CHECK_NEW(an_unknown_reference_has_no_calls_left)
{
    int anything;
    connected();
    EXPECT_INT(maxTriggers((TIMER_REF)&anything), 0);
    EXPECT_INT(maxTriggers(NULL), 0);
    EXPECT_OK(IPC_removeTimerByRef((TIMER_REF)&anything));
}
