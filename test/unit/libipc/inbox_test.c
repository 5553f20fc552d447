/*
 * The inbox: order, priorities, and fair limits.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "libipc/closing.h"
#include "libipc/inbox.h"
#include "libipc/report.h"

struct fixture {
    struct library *library;
    struct _X_IPC_CONTEXT *context;
};

/* A context over memory, as if connected; the lock is held throughout. */
static int set_up(void **state)
{
    struct fixture *fixture = malloc(sizeof *fixture);
    fixture->library = library_enter();
    library_initialise(fixture->library);
    fixture->context = context_new(fixture->library, -1, "module", "server", 1381, true);
    fixture->context->state = CONTEXT_CONNECTED;
    ipcVerbosity = IPC_Silent;
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    closing_end(fixture->context, CONTEXT_CLOSED);
    library_leave(fixture->library);
    free(fixture);
    return 0;
}

/* Names like "A0": message A, instance 0, which is also its dispatch number. */
static void add(struct fixture *fixture, const char *name)
{
    char message[2] = {name[0], '\0'};
    struct instance *instance = instance_new(fixture->context, INSTANCE_DELIVERY);
    instance->message = registry_get(fixture->context, message);
    instance->dispatch = name[1] - '0';
    fixture->context->unfinished++;
    inbox_add(instance);
}

static void add_all(struct fixture *fixture, const char *names)
{
    for (; *names != '\0'; names += 3) {
        add(fixture, names);
        if (names[2] == '\0') {
            break;
        }
    }
}

static void assert_order(struct fixture *fixture, const char *expected)
{
    char got[128] = "";
    struct instance *instance = inbox_take(fixture->context);
    while (instance != NULL) {
        const size_t length = strlen(got);
        snprintf(got + length, sizeof got - length, "%s%s%d", length > 0 ? " " : "",
                 instance->message->name, (int)instance->dispatch);
        instance_free(instance);
        instance = inbox_take(fixture->context);
    }
    assert_string_equal(got, expected);
    assert_int_equal(fixture->context->n_inbox, 0);
    assert_int_equal(fixture->context->inbox_bytes, 0);
}

static void messages_keep_their_order(void **state)
{
    add_all(*state, "A0 B1 A2 C3");
    assert_order(*state, "A0 B1 A2 C3");
}

static void higher_priorities_come_first_and_equal_ones_in_order(void **state)
{
    struct fixture *fixture = *state;
    registry_get(fixture->context, "L")->priority = 1;
    registry_get(fixture->context, "H")->priority = 9;
    add_all(fixture, "N0 N1 L2 H3 N4 L5 H6");
    assert_order(fixture, "H3 H6 L2 L5 N0 N1 N4");
}

static void priority_zero_is_above_none(void **state)
{
    struct fixture *fixture = *state;
    registry_get(fixture->context, "B")->priority = 0;
    add_all(fixture, "A1 B2 C3 B4");
    assert_order(fixture, "B2 B4 A1 C3");
}

static void a_limited_message_keeps_its_turns_among_others(void **state)
{
    struct fixture *fixture = *state;
    registry_get(fixture->context, "L")->queue_limit = 2;
    add_all(fixture, "L1 M2 L3 M4 L5");
    assert_order(fixture, "L3 M2 L5 M4");
    add_all(fixture, "L3 M2 L5 M4 L6");
    assert_order(fixture, "L5 M2 L6 M4");
}

static void neighbours_of_one_message_move_up(void **state)
{
    struct fixture *fixture = *state;
    registry_get(fixture->context, "L")->queue_limit = 3;
    add_all(fixture, "L1 L2 L3 M4 L5 L6");
    assert_order(fixture, "L3 L5 L6 M4");
}

static void a_dropped_instance_is_acknowledged_once(void **state)
{
    struct fixture *fixture = *state;
    struct buffer out;
    buffer_init(&out);
    registry_get(fixture->context, "L")->queue_limit = 1;
    add_all(fixture, "L1 L2");
    assert_int_equal(link_take(&fixture->context->link, &out), 0);
    assert_int_equal(out.length, FRAME_HEADER_SIZE);
    struct frame frame;
    frame_read_header(&frame, out.bytes);
    assert_int_equal(frame.class, CLASS_SUCCESS);
    assert_int_equal(frame.dispatch, 1);
    assert_int_equal(frame.parent, 1);
    assert_int_equal(frame.intent, NO_ID);
    assert_int_equal(frame.reference, NO_ID);
    assert_int_equal(fixture->context->unfinished, 1);
    buffer_fini(&out);
}

static void a_handle_is_stale_when_its_instance_has_gone(void **state)
{
    struct fixture *fixture = *state;
    struct instance *instance = instance_new(fixture->context, INSTANCE_DELIVERY);
    const MSG_INSTANCE first = instance_handle(instance);
    assert_ptr_equal(instance_find(fixture->library, first), instance);
    instance_free(instance);
    assert_null(instance_find(fixture->library, first));
    instance = instance_new(fixture->context, INSTANCE_DELIVERY);
    assert_null(instance_find(fixture->library, first));
    assert_ptr_equal(instance_find(fixture->library, instance_handle(instance)), instance);
    assert_null(instance_find(fixture->library, (MSG_INSTANCE)(uintptr_t)0x7fff12345678u));
    assert_null(instance_find(fixture->library, NULL));
    instance_free(instance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(messages_keep_their_order, set_up, tear_down),
        cmocka_unit_test_setup_teardown(higher_priorities_come_first_and_equal_ones_in_order,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(priority_zero_is_above_none, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_limited_message_keeps_its_turns_among_others, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(neighbours_of_one_message_move_up, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_dropped_instance_is_acknowledged_once, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_handle_is_stale_when_its_instance_has_gone, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
