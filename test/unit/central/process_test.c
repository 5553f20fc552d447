/*
 * A request to end reaches the process that catches such requests, and ends nothing by itself.
 */
#include "unit.h"

#include "platform/owner.h"
#include "platform/process.h"

enum { PATIENCE_MS = 30000 };

static void a_request_to_end_is_told_once(void **state)
{
    struct waker waker;
    (void)state;
    assert_int_equal(waker_open(&waker), 0);
    assert_int_equal(process_catch_signals(&waker), 0);
    assert_int_equal(process_take_signal(), 0);
    assert_int_equal(owner_end((int)process_number()), 0);
    struct ready_item item = {waker.read_fd, READY_READ, 0};
    assert_int_equal(ready_wait(&item, 1, PATIENCE_MS), 1);
    assert_true(process_signal_ends(process_take_signal()));
    assert_int_equal(process_take_signal(), 0);
}

static void nobody_is_not_asked(void **state)
{
    (void)state;
    assert_true(owner_end(0) != 0);
    assert_true(owner_end(-1) != 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_request_to_end_is_told_once),
        cmocka_unit_test(nobody_is_not_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
