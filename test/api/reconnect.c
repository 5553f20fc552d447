/*
 * Coming back after the loss of central, for programs that have chosen it.
 */
#include "check.h"

#include <ipcx.h>

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LONG_MS = 20000 }; /* for what is awaited and comes */

static struct central *central;
static IPC_CONTEXT_PTR own_context;

static void start(IPCX_RECONNECT mode)
{
    central = connected();
    own_context = IPC_getContext();
    EXPECT_OK(IPCx_setReconnect(mode));
    EXPECT_OK(define_int("m"));
    EXPECT_OK(IPC_subscribe("m", note_a, "m"));
}

static void await_connection(int wanted)
{
    const long end = now_ms() + LONG_MS;
    while (IPC_isConnected() != wanted && now_ms() < end) {
        IPC_listen(20);
    }
    EXPECT_INT(IPC_isConnected(), wanted);
}

static void lose_central(void)
{
    central_kill(central);
    await_connection(0);
}

static void start_central_again(void)
{
    central = central_start_on(central->port, NULL);
}

static void *start_central_later(void *argument)
{
    (void)argument;
    sleep_ms(300);
    start_central_again();
    return NULL;
}

/* Central comes back while the rest of the check runs. */
static pthread_t central_soon(void)
{
    pthread_t thread;
    EXPECT_INT(pthread_create(&thread, NULL, start_central_later, NULL), 0);
    return thread;
}

static void come_back(void)
{
    start_central_again();
    await_connection(1);
}

static void expect_message(int number)
{
    char expected[32];
    recorded();
    EXPECT_OK(publish_int("m", number));
    listen_until(1);
    snprintf(expected, sizeof expected, "m%d ", number);
    EXPECT_TEXT(recorded(), expected);
}

/* ------------------------------------------------------------------------------ what is restored */

CHECK_NEW(messages_and_subscriptions_come_back_again_and_again)
{
    start(IPCX_RECONNECT_FAIL);
    for (int i = 1; i <= 4; i++) {
        lose_central();
        EXPECT(IPC_getContext() == own_context);
        come_back();
        EXPECT(IPC_getContext() == own_context);
        EXPECT_INT(IPC_isModuleConnected("A"), 1);
        EXPECT_INT(IPC_numHandlers("m"), 1);
        expect_message(i);
    }
}

CHECK_NEW(choosing_changes_nothing_while_central_is_there)
{
    start(IPCX_RECONNECT_WAIT);
    expect_message(1);
    EXPECT_TIMEOUT(IPC_listen(20));
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

static void publish_and_expect(const char *expected, int count)
{
    recorded();
    EXPECT_OK(publish_int("m", 1));
    listen_until(count);
    listen_for(30);
    EXPECT_TEXT(recorded(), expected);
}

CHECK_NEW(handlers_keep_their_order_and_their_data)
{
    start(IPCX_RECONNECT_FAIL);
    IPC_subscribe("m", note_b, "b");
    IPC_subscribe("m", note_c, "c");
    IPC_unsubscribe("m", note_a);
    IPC_subscribe("m", note_a, "a");
    IPC_subscribe("gone", note_a, "gone");
    IPC_unsubscribe("gone", note_a);
    publish_and_expect("b1 c1 a1 ", 3);
    lose_central();
    come_back();
    publish_and_expect("b1 c1 a1 ", 3);
    EXPECT_INT(IPC_numHandlers("gone"), 0);
    EXPECT_OK(IPC_subscribe("m", note_b, "b"));
    EXPECT_OK(IPC_unsubscribe("m", note_c));
    EXPECT_OK(IPC_subscribe("gone", note_a, "again"));
    publish_and_expect("b1 a1 ", 2);
    EXPECT_OK(define_int("gone"));
    EXPECT_OK(publish_int("gone", 5));
    listen_until(1);
    EXPECT_TEXT(recorded(), "again5 ");
}

PLAYER(asker_for_a_format)
{
    FORMATTER_PTR formatter = IPC_msgFormatter("pair");
    int *data = NULL;
    int pair[2] = {1, 2};
    IPC_VARCONTENT_TYPE content;
    EXPECT(formatter != NULL);
    EXPECT_OK(IPC_marshall(formatter, pair, &content));
    EXPECT_INT(content.length, sizeof pair);
    EXPECT_OK(IPC_unmarshall(formatter, content.content, (void **)&data));
    EXPECT(data != NULL && data[1] == 2);
    IPC_freeData(formatter, data);
    IPC_freeByteArray(content.content);
    EXPECT(IPC_parseFormat("named") != NULL);
    EXPECT(IPC_msgFormatter("old") != NULL);
    player_say(0);
    player_wait();
}

CHECK_NEW(named_formats_and_formats_of_messages_come_back)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(IPC_defineFormat("named", "{int, int}"));
    EXPECT_OK(IPC_defineMsg("old", IPC_VARIABLE_LENGTH, "string"));
    EXPECT_OK(IPC_defineMsg("pair", IPC_VARIABLE_LENGTH, "double"));
    EXPECT_OK(IPC_defineMsg("pair", 2 * sizeof(int), "named"));
    lose_central();
    come_back();
    module_start("asker_for_a_format", central);
}

CHECK_NEW(lengths_and_priorities_hold_for_the_new_central)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(define_int("n"));
    EXPECT_OK(IPC_subscribe("n", note_b, "n"));
    EXPECT_OK(IPC_setMsgQueueLength("m", 2));
    EXPECT_OK(IPC_setMsgPriority("m", 1));
    EXPECT_OK(IPC_setMsgPriority("n", 2));
    lose_central();
    come_back();
    EXPECT(IPC_msgFormatter("m") != NULL && IPC_msgFormatter("n") != NULL);
    for (int i = 0; i < 8; i++) {
        EXPECT_OK(publish_int("m", i));
    }
    EXPECT_OK(publish_int("n", 9));
    let_arrive();
    listen_for(200);
    const char *text = recorded();
    EXPECT(strstr(text, "m6 m7 ") != NULL && strstr(text, "m5") == NULL);
    EXPECT(strstr(text, "n9 m6") != NULL);
}

static void note_module(const char *name, void *client_data)
{
    record("%s%s ", (const char *)client_data, name);
}

static void note_change(const char *name, int count, void *client_data)
{
    record("%s%s:%d ", (const char *)client_data, name, count);
}

PLAYER(subscriber)
{
    EXPECT_OK(IPC_subscribe("m", note_a, ""));
    player_serve();
}

CHECK_NEW(notifications_come_back)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(IPC_subscribeConnect(note_module, "+"));
    EXPECT_OK(IPC_subscribeDisconnect(note_module, "-"));
    EXPECT_OK(IPC_subscribeHandlerChange("m", note_change, "="));
    lose_central();
    come_back();
    listen_for(50);
    recorded();
    struct module *other = module_start("subscriber", central);
    listen_until(2);
    EXPECT_TEXT(recorded(), "+subscriber =m:2 ");
    module_kill(other);
    listen_until(2);
    listen_for(30);
    const char *text = recorded();
    EXPECT(strstr(text, "-subscriber ") != NULL && strstr(text, "=m:1 ") != NULL);
    EXPECT_OK(IPC_unsubscribeConnect(note_module));
    EXPECT_OK(IPC_unsubscribeHandlerChange("m", note_change));
}

CHECK_NEW(a_module_that_does_not_listen_comes_back_by_its_calls)
{
    central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModuleNoListen("A", central->address));
    EXPECT_OK(IPCx_setReconnect(IPCX_RECONNECT_FAIL));
    EXPECT_OK(define_int("m"));
    central_kill(central);
    start_central_again();
    const long end = now_ms() + LONG_MS;
    int n_failed = 0;
    while (publish_int("m", 1) != IPC_OK || IPC_isModuleConnected("A") != 1) {
        n_failed++;
        if (!EXPECT(now_ms() < end)) {
            break;
        }
        sleep_ms(5);
    }
    EXPECT(n_failed > 0);
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
}

CHECK_NEW(a_module_that_only_asks_whether_it_is_connected_comes_back)
{
    start(IPCX_RECONNECT_FAIL);
    lose_central();
    start_central_again();
    const long end = now_ms() + LONG_MS;
    while (!IPC_isConnected() && EXPECT(now_ms() < end)) {
        sleep_ms(5);
    }
    expect_message(1);
}

PLAYER(definer)
{
    EXPECT_OK(IPC_defineMsg("theirs", IPC_VARIABLE_LENGTH, "{int, string}"));
    EXPECT_OK(IPC_defineMsg("unused", IPC_VARIABLE_LENGTH, "int"));
    player_say(0);
    player_wait();
}

CHECK_NEW(what_another_module_had_defined_is_defined_when_it_is_used)
{
    struct {
        int number;
        char *text;
    } value = {4, "four"};
    start(IPCX_RECONNECT_FAIL);
    module_start("definer", central);
    EXPECT_OK(IPC_publishData("theirs", &value));
    EXPECT_OK(IPC_publish("unused", 0, NULL));
    lose_central();
    come_back();
    EXPECT_INT(IPC_isMsgDefined("theirs"), 0);
    EXPECT_INT(IPC_isMsgDefined("unused"), 0);
    EXPECT_OK(IPC_publishData("theirs", &value));
    EXPECT_INT(IPC_isMsgDefined("theirs"), 1);
    EXPECT_INT(IPC_isMsgDefined("unused"), 0);
    EXPECT_ERROR(publish_int("never", 1), IPC_Message_Not_Defined);
}

PLAYER(direct_receiver)
{
    EXPECT_OK(IPC_subscribe("m", note_a, "direct"));
    player_say(0);
    listen_until(1);
    EXPECT_TEXT(recorded(), "direct7 ");
    player_say(1);
    player_wait();
}

CHECK_NEW(a_central_that_wants_direct_links_gets_them)
{
    start(IPCX_RECONNECT_FAIL);
    expect_message(1);
    for (int i = 0; i < 2; i++) {
        lose_central();
        central = central_start_on(central->port, i == 0 ? "-c" : NULL);
        await_connection(1);
        struct module *receiver = module_start("direct_receiver", central);
        EXPECT_OK(publish_int("m", 7));
        EXPECT_INT(module_hear(receiver), 1);
        module_tell(receiver, 0);
        EXPECT_INT(module_end(receiver), 0);
        listen_until(1);
        EXPECT_TEXT(recorded(), "m7 ");
    }
}

/* -------------------------------------------------------------------------- while central is away */

static void note_any(MSG_INSTANCE instance, void *data, void *client_data)
{
    (void)instance;
    (void)data;
    (void)client_data;
    EXPECT_THAT("nobody answers");
}

CHECK_NEW(calls_in_between_fail)
{
    int number = 1;
    void *reply = NULL;
    start(IPCX_RECONNECT_FAIL);
    lose_central();
    EXPECT_ERROR(publish_int("m", 1), IPC_Not_Connected);
    EXPECT_ERROR(IPC_publishData("m", &number), IPC_Not_Connected);
    EXPECT_ERROR(define_int("n"), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribe("n", note_a, ""), IPC_Not_Connected);
    EXPECT_ERROR(IPC_unsubscribe("m", note_a), IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryNotify("m", sizeof number, &number, note_any, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryResponse("m", sizeof number, &number, &reply, 1000), IPC_Not_Connected);
    EXPECT_ERROR(IPC_setCapacity(2), IPC_Not_Connected);
    EXPECT_ERROR(IPC_setMsgPriority("m", 2), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribeConnect(note_module, ""), IPC_Not_Connected);
    EXPECT_FAILURE(IPC_isModuleConnected("A"), -1, IPC_Not_Connected);
    EXPECT_FAILURE(IPC_numHandlers("m"), -1, IPC_Not_Connected);
    EXPECT_FAILURE(IPC_isMsgDefined("m"), 0, IPC_Not_Connected);
    EXPECT_NULL(IPC_msgFormatter("m"), IPC_Not_Connected);
    EXPECT_OK(IPC_defineFormat("meanwhile", "int"));
    EXPECT_QUIET(IPCx_tryConnect("A", central->address), IPC_Timeout);
    EXPECT(IPC_getContext() == own_context);
    come_back();
    EXPECT_QUIET(IPCx_tryConnect("A", central->address), IPC_OK);
    EXPECT(IPC_getContext() == own_context);
    EXPECT_INT(IPC_isMsgDefined("n"), 0);
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    expect_message(1);
}

CHECK_NEW(the_call_that_finds_the_loss_fails_alike)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(publish_int("m", 0));
    central_kill(central);
    IPC_RETURN_TYPE result = IPC_OK;
    IPC_errno = IPC_No_Error;
    for (int i = 0; i < 200 && result == IPC_OK; i++) {
        result = publish_int("m", i);
        sleep_ms(2);
    }
    EXPECT_INT(result, IPC_Error);
    EXPECT_INT(IPC_errno, IPC_Not_Connected);
}

CHECK_NEW(the_loss_and_the_return_are_printed_at_errors)
{
    char expected[320];
    start(IPCX_RECONNECT_FAIL);
    snprintf(expected, sizeof expected,
             "Closed Connection Detected from: Central Server %s\n\n"
             "Connected again to: Central Server %s\n\n",
             central->address, central->address);
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    lose_central();
    come_back();
    EXPECT_TEXT(captured_stderr(), expected);
    EXPECT_TEXT(captured_stdout(), "");
    IPC_setVerbosity(IPC_Silent);
}

static void exit_procedure(void)
{
    EXPECT_THAT("the process stays");
}

CHECK_NEW(the_exit_procedure_is_not_called)
{
    start(IPCX_RECONNECT_FAIL);
    x_ipcRegisterExitProc(exit_procedure);
    IPC_setVerbosity(IPC_Exit_On_Errors);
    capture();
    lose_central();
    come_back();
    captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    expect_message(1);
}

static void note_timer(void *client_data, unsigned long now, unsigned long due)
{
    (void)now;
    (void)due;
    record("%s ", (const char *)client_data);
    EXPECT(IPC_getContext() == own_context);
}

static void note_fd(int fd, void *client_data)
{
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    record("%s%c ", (const char *)client_data, byte);
}

CHECK_NEW(timers_and_descriptors_go_on)
{
    int ends[2];
    start(IPCX_RECONNECT_FAIL);
    EXPECT_INT(pipe(ends), 0);
    EXPECT_OK(IPC_subscribeFD(ends[0], note_fd, "fd"));
    lose_central();
    recorded();
    EXPECT_INT(write(ends[1], "1", 1), 1);
    EXPECT_OK(IPC_listen(LONG_MS));
    EXPECT_TEXT(recorded(), "fd1 ");
    EXPECT_OK(IPC_addTimer(1, 3, note_timer, "timer"));
    listen_until(3);
    EXPECT_TEXT(recorded(), "timer timer timer ");
    EXPECT_TIMEOUT(IPC_listen(20));
    EXPECT_TIMEOUT(IPC_handleMessage(20));
    EXPECT_TIMEOUT(IPC_listenClear(20));
    const fd_set set = IPC_getConnections();
    EXPECT(FD_ISSET(ends[0], &set));
    come_back();
    EXPECT_INT(write(ends[1], "2", 1), 1);
    EXPECT_OK(IPC_listen(LONG_MS));
    EXPECT_TEXT(recorded(), "fd2 ");
    expect_message(3);
}

/* One call listens from before the loss until after the return. */
CHECK_NEW(the_loss_does_not_end_a_listening_call)
{
    start(IPCX_RECONNECT_FAIL);
    central_kill(central);
    EXPECT_TIMEOUT(IPC_listen(100));
    const pthread_t thread = central_soon();
    EXPECT_TIMEOUT(IPC_listen(1500));
    pthread_join(thread, NULL);
    await_connection(1);
    expect_message(1);
}

static void note_content(MSG_INSTANCE instance, void *data, void *client_data)
{
    record("%s%s ", (const char *)client_data, *(char **)data);
    EXPECT_TEXT(IPC_msgInstanceName(instance), "text");
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
}

CHECK_NEW(what_has_arrived_is_handled_all_the_same)
{
    char *text = "word";
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(IPC_setCapacity(2));
    EXPECT_OK(IPC_defineMsg("text", IPC_VARIABLE_LENGTH, "string"));
    EXPECT_OK(IPC_subscribeData("text", note_content, "text"));
    EXPECT_OK(IPC_publishData("text", &text));
    EXPECT_OK(publish_int("m", 1));
    let_arrive();
    lose_central();
    EXPECT_TEXT(recorded(), "textword m1 ");
    come_back();
    EXPECT_OK(IPC_publishData("text", &text));
    listen_until(1);
    EXPECT_TEXT(recorded(), "textword ");
}

CHECK_NEW(another_event_loop_brings_the_connection_back)
{
    start(IPCX_RECONNECT_FAIL);
    struct pollfd item = {IPCx_fd(), POLLIN, 0};
    central_kill(central);
    EXPECT_INT(poll(&item, 1, LONG_MS), 1);
    EXPECT_TIMEOUT(IPCx_process());
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT(IPCx_nextTimeout() >= 0 && IPCx_nextTimeout() <= 2000);
    start_central_again();
    const long end = now_ms() + LONG_MS;
    int n_turns = 0;
    while (!IPC_isConnected() && EXPECT(now_ms() < end)) {
        EXPECT(poll(&item, 1, (int)IPCx_nextTimeout()) >= 0);
        IPCx_process();
        n_turns++;
    }
    EXPECT(n_turns < 200);
    EXPECT_INT(IPCx_nextTimeout(), -1);
    EXPECT_OK(publish_int("m", 6));
    EXPECT_INT(poll(&item, 1, LONG_MS), 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m6 ");
}

CHECK_NEW(connecting_to_the_same_server_waits_for_the_context)
{
    start(IPCX_RECONNECT_FAIL);
    const char *address = central->address;
    lose_central();
    EXPECT_ERROR(IPC_connectModule("A", address), IPC_Not_Connected);
    EXPECT(IPC_getContext() == own_context);
    const pthread_t thread = central_soon();
    EXPECT_OK(IPC_connectModule("A", address));
    pthread_join(thread, NULL);
    EXPECT(IPC_getContext() == own_context);
    expect_message(1);
}

/* -------------------------------------------------------------------------------- calls that wait */

CHECK_NEW(publications_wait)
{
    int number = 2;
    start(IPCX_RECONNECT_WAIT);
    lose_central();
    const pthread_t thread = central_soon();
    EXPECT_OK(publish_int("m", 1));
    EXPECT_OK(IPC_publishData("m", &number));
    pthread_join(thread, NULL);
    EXPECT_INT(IPC_isConnected(), 1);
    listen_until(2);
    EXPECT_TEXT(recorded(), "m1 m2 ");
}

CHECK_NEW(a_publication_over_a_broken_connection_waits)
{
    start(IPCX_RECONNECT_WAIT);
    expect_message(0);
    central_kill(central);
    const pthread_t thread = central_soon();
    EXPECT_OK(publish_int("m", 1));
    pthread_join(thread, NULL);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}

static void note_length(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    record("%u ", IPC_dataLength(instance));
    IPC_freeByteArray(content);
}

static void *kill_and_start_central(void *argument)
{
    sleep_ms(200);
    central_kill(central);
    return start_central_later(argument);
}

CHECK_NEW(a_publication_that_is_being_written_is_sent_again)
{
    enum { LENGTH = 8000000 }; /* more than the kernel takes */
    pthread_t thread;
    char *content = calloc(1, LENGTH);
    start(IPCX_RECONNECT_WAIT);
    EXPECT_OK(IPC_defineMsg("long", IPC_VARIABLE_LENGTH, NULL));
    EXPECT_OK(IPC_subscribe("long", note_length, NULL));
    EXPECT_INT(IPC_isMsgDefined("long"), 1);
    central_stop(central);
    EXPECT_INT(pthread_create(&thread, NULL, kill_and_start_central, NULL), 0);
    EXPECT_OK(IPC_publish("long", LENGTH, content));
    pthread_join(thread, NULL);
    listen_until(1);
    EXPECT_TEXT(recorded(), "8000000 ");
    free(content);
}

CHECK_NEW(definitions_subscriptions_and_questions_wait)
{
    start(IPCX_RECONNECT_WAIT);
    lose_central();
    const pthread_t thread = central_soon();
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_OK(define_int("n"));
    EXPECT_OK(IPC_subscribe("n", note_b, "n"));
    EXPECT_OK(IPC_setMsgPriority("n", 1));
    EXPECT_INT(IPC_numHandlers("n"), 1);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    pthread_join(thread, NULL);
    EXPECT_OK(publish_int("n", 1));
    listen_until(1);
    EXPECT_TEXT(recorded(), "n1 ");
}

CHECK_NEW(a_question_that_central_takes_with_it_is_asked_again)
{
    pthread_t thread;
    start(IPCX_RECONNECT_WAIT);
    central_stop(central);
    EXPECT_INT(pthread_create(&thread, NULL, kill_and_start_central, NULL), 0);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    pthread_join(thread, NULL);
}

CHECK_NEW(a_subscription_that_central_takes_with_it_is_made_once)
{
    pthread_t thread;
    start(IPCX_RECONNECT_WAIT);
    central_stop(central);
    EXPECT_INT(pthread_create(&thread, NULL, kill_and_start_central, NULL), 0);
    EXPECT_OK(IPC_subscribe("m", note_b, "b"));
    pthread_join(thread, NULL);
    EXPECT_INT(IPC_numHandlers("m"), 2);
    publish_and_expect("m1 b1 ", 2);
}

static void use_by_environment(void)
{
    setenv("IPC_RECONNECT", "wait", 1);
    central = connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    central_kill(central);
    const pthread_t thread = central_soon();
    EXPECT_OK(publish_int("m", 1));
    pthread_join(thread, NULL);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}

CHECK_NEW(the_environment_chooses_for_programs_that_do_not)
{
    use_by_environment();
}

static void lose_by_default(void)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_connectModule("A", central->address);
    kill(central->pid, SIGKILL);
    IPC_listen(LONG_MS);
}

CHECK_NEW(without_a_choice_the_loss_ends_the_process)
{
    central = central_start(NULL);
    EXPECT_INT(run_apart(lose_by_default).status, 255);
    waitpid(central->pid, NULL, 0);
    central->pid = 0;
    setenv("IPC_RECONNECT", "perhaps", 1);
    central = central_start(NULL);
    EXPECT_INT(run_apart(lose_by_default).status, 255);
    waitpid(central->pid, NULL, 0);
    central->pid = 0;
}

/* ------------------------------------------------------------------------------------- queries */

static void *kill_central_later(void *argument)
{
    (void)argument;
    sleep_ms(200);
    central_kill(central);
    return NULL;
}

static void never_called(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)content;
    (void)client_data;
    EXPECT_THAT("the query is not answered");
}

static void expect_query_to_fail(IPCX_RECONNECT mode)
{
    pthread_t thread;
    int number = 1;
    void *reply = NULL;
    start(mode);
    define_int("asked");
    EXPECT_OK(IPC_queryNotify("asked", sizeof number, &number, never_called, NULL));
    EXPECT_INT(pthread_create(&thread, NULL, kill_central_later, NULL), 0);
    EXPECT_ERROR(IPC_queryResponse("asked", sizeof number, &number, &reply, LONG_MS),
                 IPC_Not_Connected);
    EXPECT(reply == NULL);
    pthread_join(thread, NULL);
    come_back();
    expect_message(1);
}

CHECK_NEW(queries_under_way_fail)
{
    expect_query_to_fail(IPCX_RECONNECT_FAIL);
}

CHECK_NEW(queries_under_way_fail_also_where_calls_wait)
{
    expect_query_to_fail(IPCX_RECONNECT_WAIT);
}

static MSG_INSTANCE kept;

static void lose_in_handler(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = 1;
    (void)client_data;
    lose_central();
    EXPECT_TEXT(IPC_msgInstanceName(instance), "asked");
    EXPECT_ERROR(IPC_respond(instance, "m", sizeof number, &number), IPC_Not_Connected);
    come_back();
    EXPECT_TEXT(IPC_msgInstanceName(instance), "asked");
    EXPECT_ERROR(IPC_respond(instance, "m", sizeof number, &number), IPC_Not_Connected);
    EXPECT_OK(publish_int("m", 8));
    EXPECT_OK(IPC_delayResponse(instance));
    kept = instance;
    IPC_freeByteArray(content);
    record("handler ");
}

static void ask_itself(HANDLER_TYPE handler)
{
    int number = 1;
    define_int("asked");
    IPC_subscribe("asked", handler, NULL);
    EXPECT_OK(IPC_queryNotify("asked", sizeof number, &number, never_called, NULL));
}

CHECK_NEW(a_handler_outlives_the_connection_of_its_message)
{
    int number = 1;
    start(IPCX_RECONNECT_FAIL);
    ask_itself(lose_in_handler);
    listen_until(2);
    listen_for(30);
    EXPECT_TEXT(recorded(), "handler m8 ");
    EXPECT_ERROR(IPC_respond(kept, "m", sizeof number, &number), IPC_Argument_Out_Of_Range);
    expect_message(1);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

static void delay(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_OK(IPC_delayResponse(instance));
    kept = instance;
    IPC_freeByteArray(content);
    record("delayed ");
}

CHECK_NEW(a_delayed_response_comes_too_late)
{
    int number = 1;
    start(IPCX_RECONNECT_FAIL);
    ask_itself(delay);
    listen_until(1);
    EXPECT_TEXT(recorded(), "delayed ");
    lose_central();
    EXPECT_ERROR(IPC_respond(kept, "m", sizeof number, &number), IPC_Argument_Out_Of_Range);
    come_back();
    EXPECT_ERROR(IPC_respond(kept, "m", sizeof number, &number), IPC_Argument_Out_Of_Range);
    /* It does not count against the capacity any more. */
    expect_message(1);
}

CHECK_NEW(a_query_that_waits_for_its_handler_is_dropped)
{
    start(IPCX_RECONNECT_FAIL);
    ask_itself(never_called);
    EXPECT_OK(publish_int("m", 2));
    let_arrive();
    central_kill(central);
    EXPECT_FAILURE(IPC_isModuleConnected("A"), -1, IPC_Not_Connected);
    listen_for(30);
    come_back();
    expect_message(1);
}

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = 5;
    (void)client_data;
    EXPECT_OK(IPC_respond(instance, "m", sizeof number, &number));
    IPC_freeByteArray(content);
}

CHECK_NEW(queries_work_after_the_return)
{
    int number = 1;
    int *reply = NULL;
    start(IPCX_RECONNECT_WAIT);
    define_int("asked");
    IPC_subscribe("asked", answer, NULL);
    lose_central();
    const pthread_t thread = central_soon();
    EXPECT_OK(IPC_queryResponse("asked", sizeof number, &number, (void **)&reply, LONG_MS));
    pthread_join(thread, NULL);
    EXPECT(reply != NULL && *reply == 5);
    IPC_freeByteArray(reply);
}

/* -------------------------------------------------------------------------------- being told of it */

static void note_connection(int now_connected, void *client_data)
{
    EXPECT(IPC_getContext() == own_context);
    EXPECT_INT(IPC_isConnected(), now_connected);
    if (now_connected) {
        EXPECT_OK(publish_int("m", 3));
    } else {
        EXPECT_ERROR(publish_int("m", 2), IPC_Not_Connected);
    }
    record("%s%d ", (const char *)client_data, now_connected);
}

static void note_connection_too(int now_connected, void *client_data)
{
    record("%s%d ", (const char *)client_data, now_connected);
}

CHECK_NEW(a_handler_is_told_of_the_loss_and_of_the_return)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(IPCx_subscribeConnection(note_connection, "old"));
    EXPECT_OK(IPCx_subscribeConnection(note_connection, "new"));
    central_kill(central);
    EXPECT_OK(IPC_listen(LONG_MS));
    EXPECT_TEXT(recorded(), "new0 ");
    start_central_again();
    listen_until(2);
    EXPECT_TEXT(recorded(), "new1 m3 ");
    EXPECT_OK(IPCx_unsubscribeConnection(note_connection));
    EXPECT_OK(IPCx_subscribeConnection(note_connection_too, "too"));
    lose_central();
    come_back();
    listen_until(2);
    EXPECT_TEXT(recorded(), "too0 too1 ");
}

static void leave_when_lost(int now_connected, void *client_data)
{
    (void)client_data;
    record("%d ", now_connected);
    EXPECT_OK(IPC_disconnect());
}

CHECK_NEW(a_handler_may_disconnect)
{
    start(IPCX_RECONNECT_FAIL);
    EXPECT_OK(IPCx_subscribeConnection(leave_when_lost, NULL));
    central_kill(central);
    EXPECT_OK(IPC_listen(LONG_MS));
    EXPECT_TEXT(recorded(), "0 ");
    EXPECT(IPC_getContext() == NULL);
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
}

/* ------------------------------------------------------------------------------------ ending it */

CHECK_NEW(arguments_are_checked)
{
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPCx_setReconnect(IPCX_RECONNECT_FAIL), IPC_Not_Connected);
    EXPECT_ERROR(IPCx_subscribeConnection(note_connection, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPCx_unsubscribeConnection(note_connection), IPC_Not_Connected);
    connected();
    EXPECT_ERROR(IPCx_setReconnect((IPCX_RECONNECT)3), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPCx_setReconnect((IPCX_RECONNECT)-1), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPCx_subscribeConnection(NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPCx_unsubscribeConnection(NULL), IPC_Null_Argument);
    EXPECT_OK(IPCx_unsubscribeConnection(note_connection));
}

static void expect_no_return(void)
{
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT(IPC_getContext() == NULL);
    start_central_again();
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    sleep_ms(300);
    EXPECT_ERROR(publish_int("m", 1), IPC_Not_Connected);
    EXPECT_OK(IPC_connectModule("B", central->address));
    EXPECT(IPC_getContext() != own_context);
    EXPECT_INT(IPC_isModuleConnected("A"), 0);
    EXPECT_INT(IPC_isMsgDefined("m"), 0);
    EXPECT_INT(IPC_isConnected(), 1);
}

CHECK_NEW(disconnecting_ends_it)
{
    start(IPCX_RECONNECT_FAIL);
    lose_central();
    EXPECT_OK(IPC_disconnect());
    expect_no_return();
}

CHECK_NEW(disconnecting_after_a_loss_that_nobody_has_noticed_is_silent)
{
    start(IPCX_RECONNECT_FAIL);
    central_kill(central);
    IPC_setVerbosity(IPC_Exit_On_Errors);
    capture();
    EXPECT_OK(IPC_disconnect());
    EXPECT_TEXT(captured_stderr(), "");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT(IPC_getContext() == NULL);
}

CHECK_NEW(choosing_otherwise_ends_it)
{
    start(IPCX_RECONNECT_FAIL);
    lose_central();
    EXPECT_OK(IPCx_setReconnect(IPCX_RECONNECT_NEVER));
    expect_no_return();
}

static void *publish_apart(void *argument)
{
    (void)argument;
    return (void *)(intptr_t)publish_int("m", 1);
}

static void expect_waiting_call_to_fail(IPC_RETURN_TYPE (*end)(void))
{
    pthread_t thread;
    void *result;
    start(IPCX_RECONNECT_WAIT);
    lose_central();
    EXPECT_INT(pthread_create(&thread, NULL, publish_apart, NULL), 0);
    sleep_ms(150);
    EXPECT_OK(end());
    pthread_join(thread, &result);
    EXPECT_INT((intptr_t)result, IPC_Error);
}

static IPC_RETURN_TYPE fail_from_now_on(void)
{
    return IPCx_setReconnect(IPCX_RECONNECT_FAIL);
}

CHECK_NEW(disconnecting_ends_calls_that_wait)
{
    expect_waiting_call_to_fail(IPC_disconnect);
    EXPECT_INT(IPC_isConnected(), 0);
}

CHECK_NEW(choosing_otherwise_ends_calls_that_wait)
{
    expect_waiting_call_to_fail(fail_from_now_on);
    come_back();
    expect_message(1);
}

/* ------------------------------------------------------------------------- contexts and threads */

static int n_losses;

static void count_loss(void)
{
    n_losses++;
}

CHECK_NEW(each_context_goes_its_own_way)
{
    struct central *first = connected();
    struct central *second = central_start(NULL);
    struct central *third = central_start(NULL);
    IPC_CONTEXT_PTR contexts[3] = {IPC_getContext(), NULL, NULL};
    x_ipcRegisterExitProc(count_loss);
    EXPECT_OK(IPCx_setReconnect(IPCX_RECONNECT_FAIL));
    define_int("m");
    IPC_subscribe("m", note_a, "first");
    EXPECT_OK(IPC_connectModule("A", second->address));
    contexts[1] = IPC_getContext();
    EXPECT_OK(IPCx_setReconnect(IPCX_RECONNECT_WAIT));
    define_int("m");
    IPC_subscribe("m", note_a, "second");
    EXPECT_OK(IPC_connectModule("A", third->address));
    contexts[2] = IPC_getContext();

    central_kill(first);
    central_kill(third);
    EXPECT_OK(IPC_listen(LONG_MS)); /* a loss as always counts as an event */
    EXPECT_INT(n_losses, 1);
    EXPECT(IPC_getContext() == NULL);
    IPC_setContext(contexts[0]);
    await_connection(0);
    EXPECT_ERROR(publish_int("m", 1), IPC_Not_Connected);
    IPC_setContext(contexts[1]);
    EXPECT_OK(publish_int("m", 2));
    listen_until(1);
    EXPECT_TEXT(recorded(), "second2 ");

    central_kill(second);
    central = second;
    const pthread_t thread = central_soon();
    EXPECT_OK(publish_int("m", 3));
    pthread_join(thread, NULL);
    listen_until(1);
    EXPECT_TEXT(recorded(), "second3 ");
    IPC_setContext(contexts[0]);
    EXPECT_ERROR(publish_int("m", 4), IPC_Not_Connected);
    central = first;
    come_back();
    EXPECT_OK(publish_int("m", 5));
    listen_until(1);
    EXPECT_TEXT(recorded(), "first5 ");
    EXPECT_INT(n_losses, 1);
}

enum { THREADS = 3, EACH = 60 };

static void *publish_often(void *argument)
{
    IPC_setVerbosity(IPC_Silent);
    for (int i = 0; i < EACH; i++) {
        EXPECT_OK(publish_int("m", *(int *)argument));
        sleep_ms(10);
    }
    return NULL;
}

static void *listen_apart(void *argument)
{
    pthread_mutex_t *ends = argument;
    while (pthread_mutex_trylock(ends) != 0) {
        IPC_listen(20);
    }
    pthread_mutex_unlock(ends);
    return NULL;
}

/* Two threads listen, others publish, and central comes and goes. */
CHECK_NEW(threads_wait_for_central_together)
{
    pthread_t publishers[THREADS];
    pthread_t listener;
    int numbers[THREADS] = {1, 2, 3};
    pthread_mutex_t ends = PTHREAD_MUTEX_INITIALIZER;
    start(IPCX_RECONNECT_WAIT);
    pthread_mutex_lock(&ends);
    EXPECT_INT(pthread_create(&listener, NULL, listen_apart, &ends), 0);
    for (int i = 0; i < THREADS; i++) {
        EXPECT_INT(pthread_create(&publishers[i], NULL, publish_often, &numbers[i]), 0);
    }
    for (int i = 0; i < 3; i++) {
        listen_for(100);
        central_kill(central);
        listen_for(50);
        start_central_again();
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(publishers[i], NULL);
    }
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    listen_for(100);
    pthread_mutex_unlock(&ends);
    pthread_join(listener, NULL);
    recorded();
    expect_message(9);
}
