/*
 * The platform: every folder beside platform.h keeps what that promises.
 */
#include "unit.h"

#include <string.h>

#include "base/error.h"
#include "platform/platform.h"

enum { PATIENCE_MS = 30000 };

static int look_at(int fd, int64_t timeout_ms)
{
    struct ready_item item = {fd, READY_READ, 0};
    const int n = ready_wait(&item, 1, timeout_ms);
    return n > 0 ? item.found : n;
}

/* Two ends of a connection. */
static void connect_pair(int ends[2])
{
    int listener;
    int port = 0;
    assert_int_equal(net_listen_tcp("127.0.0.1", &port, &listener), 0);
    assert_int_equal(net_connect_tcp("127.0.0.1", port, PATIENCE_MS, NULL, &ends[0]), 0);
    assert_int_equal(look_at(listener, PATIENCE_MS), READY_READ);
    assert_int_equal(net_accept(listener, &ends[1]), 0);
    net_close(listener);
}

static void a_waker_is_readable_until_it_is_cleared(void **state)
{
    struct waker waker;
    (void)state;
    assert_int_equal(waker_open(&waker), 0);
    assert_int_equal(look_at(waker.read_fd, 0), 0);
    waker_wake(&waker);
    waker_wake(&waker);
    assert_int_equal(look_at(waker.read_fd, PATIENCE_MS), READY_READ);
    waker_clear(&waker);
    assert_int_equal(look_at(waker.read_fd, 0), 0);
    waker_close(&waker);
}

static void a_wait_is_not_shorter_than_its_time(void **state)
{
    enum { A_WHILE_MS = 30 };
    (void)state;
    const uint64_t began = clock_ns();
    assert_int_equal(ready_wait(NULL, 0, A_WHILE_MS), 0);
    assert_true(clock_ns() - began >= A_WHILE_MS * UINT64_C(1000000));
}

static void a_closed_descriptor_is_told_among_others(void **state)
{
    int ends[2];
    (void)state;
    connect_pair(ends);
    struct ready_item items[3] = {
        {ends[0], READY_READ | READY_WRITE, 0}, {ends[1], READY_READ, 0}, {-1, READY_READ, 0}};
    net_close_copy(ends[1]);
    assert_true(ready_wait(items, 3, PATIENCE_MS) > 0);
    assert_int_equal(items[1].found, READY_INVALID);
    assert_true((items[0].found & READY_WRITE) != 0);
    assert_int_equal(items[2].found, 0);
    net_close(ends[0]);
}

static void a_poller_names_the_owner(void **state)
{
    int ends[2];
    int owners[2] = {0, 0};
    struct poller_event event;
    const struct net_slice slices[2] = {{"ab", 2}, {"c", 1}};
    char bytes[8];
    (void)state;
    connect_pair(ends);
    struct poller *poller = poller_new();
    assert_non_null(poller);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(poller_add(poller, ends[i], READY_READ, &owners[i]), 0);
    }
    assert_int_equal(poller_wait(poller, &event, 1, 0), 0);
    assert_int_equal(net_write(ends[0], slices, 2), 3);
    assert_int_equal(poller_wait(poller, &event, 1, PATIENCE_MS), 1);
    assert_ptr_equal(event.owner, &owners[1]);
    assert_int_equal(event.found, READY_READ);
    assert_int_equal(net_read(ends[1], bytes, sizeof bytes), 3);
    assert_memory_equal(bytes, "abc", 3);
    assert_int_equal(net_read(ends[1], bytes, sizeof bytes), 0);
    assert_int_equal(poller_change(poller, ends[0], READY_WRITE, &owners[0]), 0);
    assert_int_equal(poller_wait(poller, &event, 1, PATIENCE_MS), 1);
    assert_ptr_equal(event.owner, &owners[0]);
    assert_int_equal(event.found, READY_WRITE);
    poller_remove(poller, ends[0]);
    assert_int_equal(poller_wait(poller, &event, 1, 0), 0);
    poller_free(poller);
    net_close(ends[0]);
    net_close(ends[1]);
}

static void a_port_that_is_taken_is_refused_with_the_reason(void **state)
{
    int listener;
    int other;
    int port = 0;
    (void)state;
    assert_int_equal(net_listen_tcp("127.0.0.1", &port, &listener), 0);
    assert_int_equal(net_listen_tcp("127.0.0.1", &port, &other), ERR_IO);
    assert_non_null(strstr(system_reason(), "in use"));
    net_close(listener);
    assert_int_equal(net_connect_tcp("127.0.0.1", port, PATIENCE_MS, NULL, &other), ERR_REFUSED);
}

/* What a thread and its maker share. */
struct meeting {
    struct mutex *mutex;
    struct condition *changed;
    uintptr_t thread;
};

static void come(void *meeting_pointer)
{
    struct meeting *meeting = meeting_pointer;
    mutex_lock(meeting->mutex);
    meeting->thread = thread_number();
    condition_tell_all(meeting->changed);
    mutex_unlock(meeting->mutex);
}

static void a_thread_runs_beside_its_maker(void **state)
{
    struct meeting meeting = {mutex_new(), condition_new(), 0};
    const uint64_t deadline = clock_ns() + PATIENCE_MS * UINT64_C(1000000);
    (void)state;
    mutex_lock(meeting.mutex);
    condition_wait(meeting.changed, meeting.mutex, clock_ns() + 1000000); /* nobody comes */
    assert_int_equal(thread_start(come, &meeting), 0);
    while (meeting.thread == 0 && clock_ns() < deadline) {
        condition_wait(meeting.changed, meeting.mutex, deadline);
    }
    assert_true(meeting.thread != 0 && meeting.thread != thread_number());
    mutex_unlock(meeting.mutex);
    condition_free(meeting.changed);
    mutex_free(meeting.mutex);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_waker_is_readable_until_it_is_cleared),
        cmocka_unit_test(a_wait_is_not_shorter_than_its_time),
        cmocka_unit_test(a_closed_descriptor_is_told_among_others),
        cmocka_unit_test(a_poller_names_the_owner),
        cmocka_unit_test(a_port_that_is_taken_is_refused_with_the_reason),
        cmocka_unit_test(a_thread_runs_beside_its_maker),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
