/*
 * Capacity, queue lengths and priorities (T158, T159).
 */
#include "check.h"

#include <string.h>

CHECK(queue_control_checks_its_arguments)
{
    connected();
    EXPECT_ERROR(IPC_setCapacity(0), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_setCapacity(-1), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_setMsgQueueLength("m", 0), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_setMsgPriority("m", -1), IPC_Argument_Out_Of_Range);
    EXPECT_OK(IPC_setCapacity(1));
    EXPECT_OK(IPC_setMsgQueueLength("undefined", 1));
    EXPECT_OK(IPC_setMsgPriority("undefined", 0));
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

/* ------------------------------------------------------------------- one message, a length */

static void handle_eight(int capacity, int length)
{
    connected();
    define_int("m");
    if (capacity > 0) {
        IPC_setCapacity(capacity);
    }
    if (length > 0) {
        IPC_setMsgQueueLength("m", length);
    }
    IPC_subscribe("m", note_a, "");
    settle();
    EXPECT(IPC_msgFormatter("m") != NULL);
    for (int i = 0; i < 8; i++) {
        EXPECT_OK(publish_int("m", i));
    }
    let_arrive();
    listen_for(200);
}

CHECK(without_a_length_every_message_waits)
{
    handle_eight(0, 0);
    EXPECT_TEXT(recorded(), "0 1 2 3 4 5 6 7 ");
}

CHECK(with_length_two_the_newest_two_wait)
{
    handle_eight(1, 2);
    EXPECT_TEXT(recorded(), "0 6 7 ");
}

CHECK(with_length_one_the_newest_waits)
{
    handle_eight(1, 1);
    EXPECT_TEXT(recorded(), "0 7 ");
}

CHECK(the_length_holds_for_the_queue_in_the_module_too)
{
    handle_eight(4, 2);
    EXPECT_TEXT(recorded(), "2 3 6 7 ");
}

CHECK(dropping_in_the_module_is_warned_of)
{
    connected();
    define_int("m");
    IPC_setCapacity(4);
    IPC_setMsgQueueLength("m", 2);
    IPC_subscribe("m", note_a, "");
    settle();
    EXPECT(IPC_msgFormatter("m") != NULL);
    for (int i = 0; i < 4; i++) {
        publish_int("m", i);
    }
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    let_arrive();
    listen_for(100);
    const char *warnings = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    EXPECT_TEXT(warnings, "WARNING: Removing a m message from queue (has 2)\n"
                          "WARNING: Removing a m message from queue (has 2)\n");
    EXPECT_TEXT(recorded(), "2 3 ");
}

/* --------------------------------------------------------------- three messages, priorities */

static void prepare_three(int capacity)
{
    connected();
    define_int("lo");
    define_int("mid");
    define_int("hi");
    IPC_setCapacity(capacity);
    IPC_subscribe("lo", note_a, "lo");
    IPC_subscribe("mid", note_b, "mid");
    IPC_subscribe("hi", note_c, "hi");
    settle();
    publish_int("lo", 9);
    listen_until(1); /* an original learns what it has subscribed to with the first message */
    publish_int("mid", 9);
    listen_until(2);
    publish_int("hi", 9);
    listen_until(3);
    EXPECT_TEXT(recorded(), "lo9 mid9 hi9 ");
}

static void handle_burst(void)
{
    settle();
    EXPECT_OK(publish_int("lo", 0));
    EXPECT_OK(publish_int("lo", 1));
    EXPECT_OK(publish_int("hi", 0));
    EXPECT_OK(publish_int("mid", 0));
    EXPECT_OK(publish_int("lo", 2));
    EXPECT_OK(publish_int("hi", 1));
    EXPECT_OK(publish_int("mid", 1));
    let_arrive();
    listen_for(200);
}

CHECK(messages_of_higher_priority_overtake_at_central)
{
    prepare_three(1);
    IPC_setMsgPriority("hi", 10);
    IPC_setMsgPriority("mid", 5);
    handle_burst();
    EXPECT_TEXT(recorded(), "lo0 hi0 hi1 mid0 mid1 lo1 lo2 ");
}

CHECK(messages_of_higher_priority_overtake_in_the_module)
{
    prepare_three(10);
    IPC_setMsgPriority("hi", 10);
    IPC_setMsgPriority("mid", 5);
    handle_burst();
    EXPECT_TEXT(recorded(), "hi0 hi1 mid0 mid1 lo0 lo1 lo2 ");
}

CHECK(priority_zero_is_above_no_priority)
{
    prepare_three(1);
    IPC_setMsgPriority("hi", 0);
    handle_burst();
    EXPECT_TEXT(recorded(), "lo0 hi0 hi1 lo1 mid0 lo2 mid1 ");
}

CHECK(a_newer_message_takes_the_place_of_the_newest_of_its_kind)
{
    prepare_three(1);
    IPC_setMsgQueueLength("lo", 1);
    handle_burst();
    EXPECT_TEXT(recorded(), "lo0 lo2 hi0 mid0 hi1 mid1 ");
}
