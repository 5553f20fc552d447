/*
 * Subscriptions, message instances and who owns the data (T70 to T83).
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void expect_capture(const char *expected, const char *place)
{
    const char *found = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    expect_text(found, expected, place, "the warnings");
}

static void capture_warnings(void)
{
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
}

CHECK(handlers_are_called_in_the_order_of_subscription)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "a");
    IPC_subscribe("m", note_b, "b");
    IPC_subscribe("m", note_c, "c");
    settle();
    publish_int("m", 1);
    listen_until(3);
    EXPECT_TEXT(recorded(), "a1 b1 c1 ");
    IPC_unsubscribe("m", note_a);
    IPC_subscribe("m", note_a, "a");
    settle();
    publish_int("m", 2);
    listen_until(3);
    EXPECT_TEXT(recorded(), "b2 c2 a2 ");
}

CHECK(subscribing_again_only_replaces_the_client_data)
{
    char warning[100];
    char expected[300];
    connected();
    define_int("m");
    snprintf(warning, sizeof warning, "Resetting client data for handler HND-m%lu\n",
             (unsigned long)(uintptr_t)note_a);
    snprintf(expected, sizeof expected, "%s%s", warning, warning);
    IPC_subscribe("m", note_a, "one");
    capture_warnings();
    IPC_subscribe("m", note_a, "two");
    IPC_subscribe("m", note_a, "two");
    IPC_subscribe("m", note_a, NULL);
    expect_capture(expected, PLACE);
    capture_warnings();
    IPC_subscribe("m", note_a, "two");
    expect_capture(warning, PLACE);
    EXPECT_INT(IPC_numHandlers("m"), 1);
    settle();
    publish_int("m", 1);
    listen_until(1);
    listen_for(50);
    EXPECT_TEXT(recorded(), "two1 ");
}

CHECK(one_handler_of_two_messages_has_client_data_for_each)
{
    connected();
    define_int("m");
    define_int("n");
    IPC_subscribe("m", note_a, "m");
    IPC_subscribe("n", note_a, "n");
    settle();
    publish_int("m", 1);
    publish_int("n", 2);
    listen_until(2);
    EXPECT_TEXT(recorded(), "m1 n2 ");
}

CHECK(a_message_may_be_subscribed_to_before_it_is_defined)
{
    connected();
    EXPECT_OK(IPC_subscribe("m", note_a, "m"));
    EXPECT_INT(IPC_isMsgDefined("m"), 0);
    EXPECT_INT(IPC_numHandlers("m"), 1);
    define_int("m");
    settle();
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}

CHECK_NEW(unsubscribing_no_handler_means_all_of_them)
{
    connected();
    define_int("m");
    define_int("n");
    IPC_subscribe("m", note_a, "a");
    IPC_subscribe("m", note_b, "b");
    IPC_subscribe("n", note_a, "n");
    EXPECT_OK(IPC_unsubscribe("m", NULL));
    EXPECT_INT(IPC_numHandlers("m"), 0);
    EXPECT_INT(IPC_numHandlers("n"), 1);
    publish_int("m", 1);
    publish_int("n", 2);
    listen_until(1);
    EXPECT_TEXT(recorded(), "n2 ");
}

CHECK(unsubscribing_an_unknown_handler_is_no_error)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "a");
    capture_warnings();
    EXPECT_QUIET(IPC_unsubscribe("m", note_b), IPC_OK);
    EXPECT_QUIET(IPC_unsubscribe("unknown", note_a), IPC_OK);
    expect_capture("", PLACE);
    EXPECT_INT(IPC_numHandlers("m"), 1);
}

static void note_and_unsubscribe(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    note_a(instance, content, "once");
    IPC_unsubscribe("m", (HANDLER_TYPE)(uintptr_t)client_data);
}

CHECK(messages_that_wait_for_a_removed_handler_are_dropped_with_a_warning)
{
    char warning[200];
    char expected[500];
    connected();
    define_int("m");
    IPC_setCapacity(5);
    IPC_subscribe("m", note_and_unsubscribe, (void *)(uintptr_t)note_and_unsubscribe);
    settle();
    for (int i = 0; i < 3; i++) {
        publish_int("m", i);
    }
    let_arrive();
    capture_warnings();
    IPC_listenWait(100);
    snprintf(warning, sizeof warning,
             "WARNING: Message 'm' received but not processed: Handler 'HND-m%lu' not registered\n",
             (unsigned long)(uintptr_t)note_and_unsubscribe);
    snprintf(expected, sizeof expected, "%s%s", warning, warning);
    expect_capture(expected, PLACE);
    EXPECT_INT(n_recorded(), 1);
}

CHECK(a_handler_may_unsubscribe_another_one)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_and_unsubscribe, (void *)(uintptr_t)note_b);
    IPC_subscribe("m", note_b, "b");
    settle();
    publish_int("m", 1);
    listen_for(100);
    EXPECT_TEXT(recorded(), "once1 ");
}

static void note_client_data(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    record("%d with %ld ", *(int *)content, (long)(intptr_t)client_data);
    IPC_freeByteArray(content);
}

CHECK_NEW(any_pointer_may_be_client_data)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_client_data, (void *)(intptr_t)-1);
    publish_int("m", 7);
    listen_until(1);
    EXPECT_TEXT(recorded(), "7 with -1 ");
}

/* ------------------------------------------------------------------------- data */

static void note_raw(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const unsigned char *bytes = content;
    (void)client_data;
    record("raw %u:", IPC_dataLength(instance));
    for (unsigned int i = 0; i < IPC_dataLength(instance); i++) {
        record(" %02x", bytes[i]);
    }
    record("; ");
    free(content);
}

static void note_string(MSG_INSTANCE instance, void *data, void *client_data)
{
    (void)client_data;
    record("data %u: %s; ", IPC_dataLength(instance), *(char **)data);
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
}

CHECK(a_handler_gets_bytes_or_data_as_it_subscribed)
{
    char *text = "hello";
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "string");
    IPC_subscribe("m", note_raw, NULL);
    IPC_subscribeData("m", note_string, NULL);
    settle();
    EXPECT_OK(IPC_publishData("m", &text));
    listen_until(2);
    listen_for(30);
    EXPECT_TEXT(recorded(), "raw 9: 05 00 00 00 68 65 6c 6c 6f; data 9: hello; ");
}

CHECK(the_last_kind_of_a_subscription_counts)
{
    char *text = "hello";
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "string");
    IPC_subscribe("m", note_string, NULL);
    IPC_subscribeData("m", note_string, NULL);
    IPC_subscribeData("m", note_raw, NULL);
    IPC_subscribe("m", note_raw, NULL);
    EXPECT_INT(IPC_numHandlers("m"), 2);
    settle();
    EXPECT_OK(IPC_publishData("m", &text));
    listen_for(100);
    EXPECT_TEXT(recorded(), "data 9: hello; raw 9: 05 00 00 00 68 65 6c 6c 6f; ");
}

CHECK(data_of_a_message_without_format_are_the_bytes)
{
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, NULL);
    IPC_subscribeData("m", note_raw, NULL);
    settle();
    EXPECT_OK(IPC_publish("m", 3, "ab"));
    listen_for(60);
    EXPECT_TEXT(recorded(), "raw 3: 61 62 00; ");
}

static void free_plainly(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (*(int *)client_data)++;
    free(content);
}

static long resident_kilobytes(void)
{
    long pages[2] = {0, 0};
    FILE *file = fopen("/proc/self/statm", "r");
    if (file) {
        (void)!fscanf(file, "%ld %ld", &pages[0], &pages[1]);
        fclose(file);
    }
    return pages[1] * (sysconf(_SC_PAGESIZE) / 1024);
}

static void publish_many(int count, const int *seen)
{
    static char content[1000];
    for (int i = 0; i < count; i++) {
        EXPECT_OK(IPC_publish("m", sizeof content, content));
        while (*seen <= i - 20 || (i == count - 1 && *seen < count)) {
            IPC_listen(1000);
        }
    }
}

CHECK_NEW(handlers_may_free_bytes_plainly_and_nothing_grows)
{
    int seen = 0;
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, NULL);
    IPC_subscribe("m", free_plainly, &seen);
    IPC_setCapacity(20);
    publish_many(2000, &seen);
    const long before = resident_kilobytes();
    seen = 0;
    publish_many(10000, &seen);
    EXPECT_INT(seen, 10000);
#if !defined(__SANITIZE_ADDRESS__) /* which keeps what is freed for a while */
    EXPECT(resident_kilobytes() - before < 2000);
#else
    (void)before;
#endif
}

/* ------------------------------------------------------------------------ order */

PLAYER(sends_four)
{
    define_int("m");
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    player_say(0);
    player_wait();
    for (int i = 0; i < 4; i++) {
        publish_int("m", i);
    }
    player_say(IPC_isModuleConnected("A"));
    player_wait();
}

CHECK_NEW(the_first_messages_of_a_subscription_come_in_order)
{
    struct central *central = connected();
    struct module *module = module_start("sends_four", central);
    IPC_setCapacity(5);
    IPC_subscribe("m", note_a, "");
    module_tell(module, 1);
    EXPECT_INT(module_hear(module), 1);
    listen_until(4);
    EXPECT_TEXT(recorded(), "0 1 2 3 ");
}

/* -------------------------------------------------------------------- instances */

static MSG_INSTANCE kept;

static void keep_instance(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    kept = instance;
    EXPECT_TEXT(IPC_msgInstanceName(instance), "m");
    EXPECT_INT(IPC_dataLength(instance), 4);
    EXPECT(IPC_msgInstanceFormatter(instance) == IPC_msgFormatter("m"));
    record("x");
    IPC_freeByteArray(content);
}

CHECK_NEW(an_instance_is_recognised_as_stale_after_its_handler)
{
    int number = 1;
    connected();
    define_int("m");
    IPC_subscribe("m", keep_instance, NULL);
    publish_int("m", 1);
    listen_until(1);
    EXPECT(kept != NULL);
    EXPECT_NULL(IPC_msgInstanceName(kept), IPC_Argument_Out_Of_Range);
    EXPECT_NULL(IPC_dataLength(kept), IPC_Argument_Out_Of_Range);
    EXPECT_NULL(IPC_msgInstanceFormatter(kept), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_delayResponse(kept), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_respond(kept, "m", 4, &number), IPC_Argument_Out_Of_Range);
    MSG_INSTANCE old = kept;
    publish_int("m", 2);
    listen_until(2);
    EXPECT_NULL(IPC_msgInstanceName(old), IPC_Argument_Out_Of_Range);
}

static void expect_illegal(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_NULL(IPC_msgInstanceFormatter(instance), IPC_Illegal_Formatter);
    record("x");
    IPC_freeByteArray(content);
}

CHECK(the_formatter_of_an_instance_may_be_illegal)
{
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "never_defined");
    IPC_subscribe("m", expect_illegal, NULL);
    settle();
    IPC_publish("m", 1, "x");
    listen_until(1);
    EXPECT_INT(n_recorded(), 1);
}
