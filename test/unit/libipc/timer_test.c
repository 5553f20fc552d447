/*
 * Timers: replacement, references, counts, and removal while they run.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "libipc/report.h"
#include "libipc/timer.h"

static char called[32]; /* the client data of the calls so far, a letter each */

static void handler(void *client_data, unsigned long now, unsigned long scheduled)
{
    const char letter[2] = {*(const char *)client_data, '\0'};
    assert_true(now >= scheduled);
    strcat(called, letter);
}

static void other_handler(void *client_data, unsigned long now, unsigned long scheduled)
{
    handler(client_data, now, scheduled);
}

static void removing_handler(void *client_data, unsigned long now, unsigned long scheduled)
{
    handler(client_data, now, scheduled);
    struct library *library = library_enter();
    assert_true(timer_remove(library, removing_handler));
    (void)timer_remove(library, other_handler);
    library_leave(library);
}

static int set_up(void **state)
{
    *state = library_enter();
    library_initialise(*state);
    ipcVerbosity = IPC_Silent;
    called[0] = '\0';
    return 0;
}

static int tear_down(void **state)
{
    timer_clear(*state);
    library_leave(*state);
    return 0;
}

/* Runs what is due once the time of the next timer has come. */
static void run_when_due(struct library *library)
{
    while (clock_ns() < library->next_timer_ns) {
    }
    timer_run_due(library);
}

static void the_same_handler_without_reference_is_replaced(void **state)
{
    struct library *library = *state;
    char a = 'a';
    char b = 'b';
    const TIMER_REF first = timer_add(library, 100000, TRIGGER_FOREVER, handler, &a, false);
    const TIMER_REF second = timer_add(library, 1, 2, handler, &b, false);
    assert_ptr_equal(first, second);
    assert_int_equal(timer_count(library, second), 2);
    run_when_due(library);
    run_when_due(library);
    assert_string_equal(called, "bb");
    assert_int_equal(timer_count(library, second), 0);
    assert_int_equal(library->next_timer_ns, UINT64_MAX);
    assert_false(timer_remove(library, handler));
}

static void references_keep_timers_of_one_handler_apart(void **state)
{
    struct library *library = *state;
    char a = 'a';
    char b = 'b';
    const TIMER_REF first = timer_add(library, 100000, 1, handler, &a, true);
    const TIMER_REF second = timer_add(library, 1, 1, handler, &b, true);
    assert_ptr_not_equal(first, second);
    assert_true(timer_remove(library, handler)); /* the older one */
    assert_int_equal(timer_count(library, first), 0);
    assert_int_equal(timer_count(library, second), 1);
    assert_true(timer_remove_reference(library, second));
    assert_false(timer_remove_reference(library, second));
    const TIMER_REF third = timer_add(library, 1, 1, handler, &b, true);
    assert_ptr_not_equal(second, third); /* a dead reference is never given out again */
    assert_int_equal(timer_count(library, second), 0);
}

static void due_timers_run_in_the_order_of_adding(void **state)
{
    struct library *library = *state;
    char a = 'a';
    char b = 'b';
    (void)timer_add(library, 3, 1, handler, &a, true);
    (void)timer_add(library, 1, 1, other_handler, &b, true);
    const uint64_t later = clock_ns() + 5000000;
    while (clock_ns() < later) {
    }
    timer_run_due(library);
    assert_string_equal(called, "ab");
}

static void a_running_handler_may_remove_itself_and_others(void **state)
{
    struct library *library = *state;
    char a = 'a';
    char b = 'b';
    (void)timer_add(library, 1, TRIGGER_FOREVER, removing_handler, &a, false);
    (void)timer_add(library, 1, TRIGGER_FOREVER, other_handler, &b, false);
    const uint64_t later = clock_ns() + 5000000;
    while (clock_ns() < later) {
    }
    timer_run_due(library);
    assert_string_equal(called, "a");
    assert_int_equal(library->next_timer_ns, UINT64_MAX);
    assert_true(list_is_empty(&library->timers));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_same_handler_without_reference_is_replaced, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(references_keep_timers_of_one_handler_apart, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(due_timers_run_in_the_order_of_adding, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_running_handler_may_remove_itself_and_others, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
