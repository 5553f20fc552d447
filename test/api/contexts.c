/*
 * Several contexts (T167 to T175).  All contexts are listened to, and every handler runs in the one
 * that it belongs to; the checks of that are of our library only.
 */
#include "check.h"

#include <string.h>
#include <unistd.h>

static struct central *centrals[2];
static IPC_CONTEXT_PTR contexts[2];

/* Two centrals and a context with each; the second is current. */
static void two_contexts(void)
{
    IPC_setVerbosity(IPC_Silent);
    for (int i = 0; i < 2; i++) {
        centrals[i] = central_start(NULL);
        EXPECT_OK(IPC_connectModule("A", centrals[i]->address));
        contexts[i] = IPC_getContext();
        define_int("m");
        IPC_subscribe("m", i == 0 ? note_a : note_b, i == 0 ? "first" : "second");
        settle();
    }
}

static int context_number(void)
{
    IPC_CONTEXT_PTR context = IPC_getContext();
    return context == contexts[0] ? 1 : context == contexts[1] ? 2 : 0;
}

CHECK(there_is_a_context_once_connected)
{
    EXPECT(IPC_getContext() == NULL);
    connected();
    EXPECT(IPC_getContext() != NULL);
}

CHECK(a_second_server_is_a_second_context)
{
    two_contexts();
    EXPECT(contexts[0] != contexts[1]);
    EXPECT_INT(context_number(), 2);
    publish_int("m", 2);
    listen_until(1);
    EXPECT_TEXT(recorded(), "second2 ");
    EXPECT_OK(IPC_setContext(contexts[0]));
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "first1 ");
}

CHECK_NEW(messages_of_all_contexts_are_handled)
{
    two_contexts();
    IPC_setContext(contexts[0]);
    publish_int("m", 1);
    IPC_setContext(contexts[1]);
    publish_int("m", 2);
    listen_until(2);
    EXPECT_INT(n_recorded(), 2);
    const char *found = recorded();
    EXPECT(strstr(found, "first1 ") && strstr(found, "second2 "));
    EXPECT_INT(context_number(), 2);
}

CHECK_NEW(waiting_in_one_context_ends_with_a_message_in_another)
{
    two_contexts();
    IPC_setContext(contexts[0]);
    publish_int("m", 1);
    IPC_setContext(contexts[1]);
    EXPECT_OK(IPC_listen(5000));
    EXPECT_TEXT(recorded(), "first1 ");
}

static void publish_in_second(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_INT(context_number(), 1);
    EXPECT_OK(IPC_setContext(contexts[1]));
    EXPECT_INT(context_number(), 2);
    EXPECT_OK(publish_int("m", *(int *)content + 10));
    EXPECT_TEXT(IPC_msgInstanceName(instance), "bridged");
    record("bridged ");
    IPC_freeByteArray(content);
}

CHECK(a_handler_may_publish_in_another_context)
{
    two_contexts();
    IPC_setContext(contexts[0]);
    define_int("bridged");
    IPC_subscribe("bridged", publish_in_second, NULL);
    settle();
    publish_int("bridged", 1);
    listen_until(1);
    EXPECT_INT(context_number(), 1);
    IPC_setContext(contexts[1]);
    listen_until(2);
    EXPECT_TEXT(recorded(), "bridged second11 ");
}

/* ------------------------------------------------ timers, descriptors, notifications, replies */

static void set_second_in_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    record("timer in %d; ", context_number());
    IPC_setContext(contexts[1]);
}

static void set_second_in_fd(int fd, void *client_data)
{
    char byte;
    (void)client_data;
    EXPECT_INT(read(fd, &byte, 1), 1);
    record("fd in %d; ", context_number());
    IPC_setContext(contexts[1]);
}

CHECK_NEW(timers_and_descriptors_run_in_their_context_and_restore_the_current_one)
{
    int ends[2];
    two_contexts();
    EXPECT_INT(pipe(ends), 0);
    IPC_setContext(contexts[0]);
    IPC_addOneShotTimer(20, set_second_in_timer, NULL);
    IPC_subscribeFD(ends[0], set_second_in_fd, NULL);
    listen_until(1);
    EXPECT_TEXT(recorded(), "timer in 1; ");
    EXPECT_INT(context_number(), 1);
    EXPECT_INT(write(ends[1], "x", 1), 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "fd in 1; ");
    EXPECT_INT(context_number(), 1);
    IPC_addOneShotTimer(20, set_second_in_timer, NULL);
    IPC_setContext(contexts[1]);
    EXPECT_INT(write(ends[1], "x", 1), 1);
    listen_until(2);
    const char *found = recorded();
    EXPECT(strstr(found, "timer in 1; ") && strstr(found, "fd in 1; "));
    EXPECT_INT(context_number(), 2);
}

static void note_context_of_connect(const char *module, void *client_data)
{
    (void)client_data;
    record("%s in %d; ", module, context_number());
}

static void note_context_of_reply(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    record("reply in %d; ", context_number());
    IPC_freeByteArray(content);
}

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_OK(IPC_respond(instance, "m", 4, content));
    IPC_freeByteArray(content);
}

PLAYER(somebody)
{
    player_say(0);
    player_wait();
}

CHECK_NEW(notifications_and_replies_run_in_their_context)
{
    int number = 1;
    two_contexts();
    IPC_setContext(contexts[0]);
    IPC_subscribeConnect(note_context_of_connect, NULL);
    define_int("q");
    IPC_subscribe("q", answer, NULL);
    IPC_queryNotify("q", sizeof number, &number, note_context_of_reply, NULL);
    IPC_setContext(contexts[1]);
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply in 1; ");
    module_start("somebody", centrals[0]);
    listen_until(1);
    EXPECT_TEXT(recorded(), "somebody in 1; ");
    EXPECT_INT(context_number(), 2);
}

static MSG_INSTANCE kept;

static void delay(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    kept = instance;
    EXPECT_OK(IPC_delayResponse(instance));
    record("delayed ");
    IPC_freeByteArray(content);
}

CHECK_NEW(a_response_goes_to_the_context_of_its_query)
{
    int number = 8;
    two_contexts();
    IPC_setContext(contexts[0]);
    define_int("q");
    define_int("only first");
    IPC_subscribe("q", delay, NULL);
    IPC_queryNotify("q", sizeof number, &number, note_c, "reply");
    listen_until(1);
    IPC_setContext(contexts[1]);
    EXPECT_OK(IPC_respond(kept, "only first", sizeof number, &number));
    listen_until(2);
    EXPECT_TEXT(recorded(), "delayed reply8 ");
}

/* ------------------------------------------------------------------------ ends and failures */

CHECK(disconnecting_closes_the_current_context_only)
{
    two_contexts();
    EXPECT_OK(IPC_disconnect());
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    EXPECT_OK(IPC_setContext(contexts[0]));
    EXPECT_INT(IPC_isConnected(), 1);
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "first1 ");
}

static void note_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    record("timer ");
}

CHECK(a_closed_context_may_be_followed_by_a_new_one)
{
    two_contexts();
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("A", centrals[1]->address));
    EXPECT_INT(IPC_isConnected(), 1);
    define_int("m");
    IPC_subscribe("m", note_c, "third");
    settle();
    publish_int("m", 3);
    listen_until(1);
    EXPECT_TEXT(recorded(), "third3 ");
    EXPECT_OK(IPC_setContext(contexts[0]));
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "first1 ");
}

CHECK_NEW(timers_are_kept_while_a_context_is_connected)
{
    two_contexts();
    IPC_addPeriodicTimer(20, note_timer, NULL);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("A", centrals[1]->address));
    listen_until(2);
    EXPECT(n_recorded() >= 2);
}

CHECK_NEW(a_second_connect_that_fails_changes_nothing)
{
    char absent[64];
    snprintf(absent, sizeof absent, "localhost:%d", free_port());
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    IPC_CONTEXT_PTR context = IPC_getContext();
    EXPECT_ERROR(IPC_connectModule("B", absent), IPC_Not_Connected);
    EXPECT(IPC_getContext() == context);
    EXPECT_INT(IPC_isConnected(), 1);
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}

CHECK_NEW(only_contexts_that_were_handed_out_can_be_set)
{
    struct central *central = connected();
    int foreign = 0;
    IPC_CONTEXT_PTR old = IPC_getContext();
    EXPECT_ERROR(IPC_setContext(NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setContext((IPC_CONTEXT_PTR)&foreign), IPC_Argument_Out_Of_Range);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("A", central->address));
    IPC_CONTEXT_PTR current = IPC_getContext();
    EXPECT(current != old);
    EXPECT_OK(IPC_setContext(old));
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_ERROR(IPC_publish("m", 0, NULL), IPC_Not_Connected);
    EXPECT_OK(IPC_setContext(current));
    EXPECT_INT(IPC_isConnected(), 1);
}

CHECK_NEW(not_listening_is_a_property_of_one_context)
{
    IPC_setVerbosity(IPC_Silent);
    for (int i = 0; i < 2; i++) {
        centrals[i] = central_start(NULL);
        EXPECT_OK(i == 0 ? IPC_connectModule("A", centrals[i]->address)
                         : IPC_connectModuleNoListen("A", centrals[i]->address));
        contexts[i] = IPC_getContext();
    }
    IPC_setVerbosity(IPC_Print_Warnings);
    IPC_setContext(contexts[0]);
    capture();
    IPC_subscribe("m", note_a, NULL);
    EXPECT_TEXT(captured_stderr(), "");
    IPC_setContext(contexts[1]);
    capture();
    IPC_subscribe("m", note_a, NULL);
    EXPECT_TEXT(captured_stderr(), "WARNING: Subscribing to m, but have connected no-listen\n");
    IPC_setVerbosity(IPC_Silent);
}

CHECK_NEW(messages_of_one_name_are_different_messages_in_different_contexts)
{
    two_contexts();
    IPC_setContext(contexts[0]);
    IPC_defineMsg("x", 4, "int");
    IPC_setContext(contexts[1]);
    IPC_defineMsg("x", 8, "double");
    EXPECT_OK(IPC_checkMsgFormats("x", "double"));
    EXPECT_OK(IPC_setContext(contexts[0]));
    EXPECT_OK(IPC_checkMsgFormats("x", "int"));
    EXPECT_ERROR(IPC_publish("x", 8, "1234567"), IPC_Message_Lengths_Differ);
}
