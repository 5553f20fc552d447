/*
 * What each call does in each state of the library, and what IPC_errno says then (T8 to T19).
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void on_fd(int fd, void *client_data)
{
    (void)fd;
    (void)client_data;
}

static void on_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
}

static void on_connect(const char *module, void *client_data)
{
    (void)module;
    (void)client_data;
}

static void on_change(const char *message, int count, void *client_data)
{
    (void)message;
    (void)count;
    (void)client_data;
}

static int count_descriptors(fd_set set)
{
    int count = 0;
    for (int fd = 0; fd < FD_SETSIZE; fd++) {
        count += FD_ISSET(fd, &set) != 0;
    }
    return count;
}

/* ------------------------------------------------------------ without a connection */

static void expect_calls_to_need_a_connection(void)
{
    int number = 1;
    IPC_VARCONTENT_TYPE content = {sizeof number, &number};
    BYTE_ARRAY reply;

    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_FAILURE(IPC_isModuleConnected("A"), -1, IPC_Not_Connected);
    EXPECT_ERROR(IPC_defineMsg("m", IPC_VARIABLE_LENGTH, NULL), IPC_Not_Connected);
    EXPECT_NULL(IPC_isMsgDefined("m"), IPC_Not_Connected);
    EXPECT_ERROR(IPC_publish("m", sizeof number, &number), IPC_Not_Connected);
    EXPECT_ERROR(IPC_publishVC("m", &content), IPC_Not_Connected);
    EXPECT_ERROR(IPC_publishFixed("m", &number), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribe("m", note_a, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribeData("m", note_a, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_unsubscribe("m", note_a), IPC_Not_Connected);
    EXPECT_ERROR(IPC_setCapacity(2), IPC_Not_Connected);
    EXPECT_ERROR(IPC_setMsgQueueLength("m", 2), IPC_Not_Connected);
    EXPECT_ERROR(IPC_setMsgPriority("m", 2), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribeConnect(on_connect, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribeDisconnect(on_connect, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_unsubscribeConnect(on_connect), IPC_Not_Connected);
    EXPECT_ERROR(IPC_unsubscribeDisconnect(on_connect), IPC_Not_Connected);
    EXPECT_ERROR(IPC_subscribeHandlerChange("m", on_change, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_unsubscribeHandlerChange("m", on_change), IPC_Not_Connected);
    EXPECT_FAILURE(IPC_numHandlers("m"), -1, IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryNotify("m", sizeof number, &number, note_a, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryNotifyVC("m", &content, note_a, NULL), IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryResponse("m", sizeof number, &number, &reply, 10), IPC_Not_Connected);
    EXPECT_ERROR(IPC_queryResponseVC("m", &content, &reply, 10), IPC_Not_Connected);
    EXPECT_ERROR(IPC_checkMsgFormats("m", "int"), IPC_Not_Connected);
    EXPECT_NULL(IPC_msgFormatter("m"), IPC_Not_Connected);
}

static void expect_listening_to_need_a_connection(void)
{
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    EXPECT_ERROR(IPC_listenClear(0), IPC_Not_Connected);
    EXPECT_ERROR(IPC_listenWait(0), IPC_Not_Connected);
    EXPECT_ERROR(IPC_dispatch(), IPC_Not_Connected);
}

static void expect_data_calls_to_fail(IPC_ERROR_TYPE error)
{
    int number = 1;
    void *reply;
    EXPECT_ERROR(IPC_publishData("m", &number), error);
    EXPECT_ERROR(IPC_queryNotifyData("m", &number, note_a, NULL), error);
    EXPECT_ERROR(IPC_queryResponseData("m", &number, &reply, 10), error);
}

static void expect_timers_to_be_accepted(void)
{
    TIMER_REF reference = NULL;
    EXPECT_QUIET(IPC_removeTimer(on_timer), IPC_OK);
    EXPECT_QUIET(IPC_addTimer(1000, 1, on_timer, NULL), IPC_OK);
    EXPECT_QUIET(IPC_addOneShotTimer(1000, on_timer, NULL), IPC_OK);
    EXPECT_QUIET(IPC_addPeriodicTimer(1000, on_timer, NULL), IPC_OK);
    EXPECT_QUIET(IPC_addTimerGetRef(1000, 1, on_timer, NULL, &reference), IPC_OK);
    EXPECT_QUIET(IPC_removeTimerByRef(reference), IPC_OK);
    EXPECT_QUIET(IPC_removeTimer(on_timer), IPC_OK);
}

static void expect_marshalling_to_fail(FORMATTER_PTR formatter, void *data)
{
    int number = 1;
    IPC_VARCONTENT_TYPE content;
    EXPECT_NULL(IPC_parseFormat("int"), IPC_Not_Initialized);
    EXPECT_ERROR(IPC_marshall(formatter, &number, &content), IPC_Not_Initialized);
    EXPECT_ERROR(IPC_unmarshall(formatter, &number, &data), IPC_Not_Initialized);
    EXPECT_ERROR(IPC_freeData(formatter, data), IPC_Not_Initialized);
    EXPECT_ERROR(IPC_freeDataElements(formatter, data), IPC_Not_Initialized);
    EXPECT_ERROR(IPC_printData(formatter, stdout, data), IPC_Not_Initialized);
    if (formatter) {
        EXPECT_ERROR(IPC_unmarshallData(formatter, &number, &number, sizeof number),
                     IPC_Not_Initialized);
    }
}

/* Calls that do the same whether initialised or not. */
static void expect_common_results(void)
{
    expect_calls_to_need_a_connection();
    expect_listening_to_need_a_connection();
    expect_timers_to_be_accepted();
    EXPECT_QUIET(IPC_setVerbosity(IPC_Silent), IPC_OK);
    EXPECT_ERROR(IPC_setContext(NULL), IPC_Null_Argument);
    IPC_freeByteArray(NULL);
    IPC_freeByteArray(malloc(1));
}

CHECK(a_fresh_library_refuses_what_needs_a_connection)
{
    IPC_setVerbosity(IPC_Silent);
    expect_common_results();
    expect_marshalling_to_fail(NULL, NULL);
    expect_data_calls_to_fail(IPC_Not_Initialized);
    EXPECT_ERROR(IPC_defineFormat("f", "int"), IPC_Not_Connected);
    EXPECT(IPC_getContext() == NULL);
    EXPECT_INT(count_descriptors(IPC_getConnections()), 0);
    EXPECT_QUIET(IPC_disconnect(), IPC_OK);
}

CHECK_NEW(a_fresh_library_accepts_descriptors_and_refuses_handle_message)
{
    int ends[2];
    EXPECT_INT(pipe(ends), 0);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_QUIET(IPC_subscribeFD(ends[0], on_fd, NULL), IPC_OK);
    EXPECT_INT(count_descriptors(IPC_getConnections()), 0);
    EXPECT_QUIET(IPC_unsubscribeFD(ends[0], on_fd), IPC_OK);
    EXPECT_ERROR(IPC_handleMessage(0), IPC_Not_Connected);
    EXPECT_INT(count_descriptors(*x_ipcGetConnections()), 0);
    EXPECT_INT(x_ipcGetServer(), -1);
}

CHECK(an_initialised_library_marshals_and_refuses_what_needs_a_connection)
{
    int number = 5;
    void *data = NULL;
    IPC_VARCONTENT_TYPE content;

    IPC_setVerbosity(IPC_Silent);
    EXPECT_QUIET(IPC_initialize(), IPC_OK);
    expect_common_results();
    expect_data_calls_to_fail(IPC_Not_Connected);
    FORMATTER_PTR formatter = IPC_parseFormat("int");
    EXPECT(formatter != NULL);
    EXPECT_QUIET(IPC_marshall(formatter, &number, &content), IPC_OK);
    EXPECT_INT(content.length, 4);
    EXPECT_QUIET(IPC_unmarshall(formatter, content.content, &data), IPC_OK);
    EXPECT_INT(*(int *)data, 5);
    number = 0;
    EXPECT_QUIET(IPC_unmarshallData(formatter, content.content, &number, sizeof number), IPC_OK);
    EXPECT_INT(number, 5);
    capture();
    EXPECT_QUIET(IPC_printData(formatter, stdout, data), IPC_OK);
    EXPECT_TEXT(captured_stdout(), "5\n");
    EXPECT_QUIET(IPC_freeDataElements(formatter, data), IPC_OK);
    EXPECT_QUIET(IPC_freeData(formatter, data), IPC_OK);
    IPC_freeByteArray(content.content);
    EXPECT_QUIET(IPC_defineFormat("pair", "{int, int}"), IPC_OK);
    EXPECT(IPC_parseFormat("pair") != NULL);
    EXPECT_QUIET(IPC_subscribeFD(0, on_fd, NULL), IPC_OK);
    EXPECT_QUIET(IPC_unsubscribeFD(0, on_fd), IPC_OK);
    EXPECT_QUIET(IPC_disconnect(), IPC_OK);
}

CHECK_NEW(an_initialised_library_has_no_context_and_no_descriptors)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    EXPECT(IPC_getContext() == NULL);
    IPC_subscribeFD(0, on_fd, NULL);
    EXPECT_INT(count_descriptors(IPC_getConnections()), 0);
    EXPECT_ERROR(IPC_handleMessage(0), IPC_Not_Connected);
}

CHECK_NEW(a_format_defined_before_connecting_is_told_to_central)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    IPC_defineFormat("early", "{int, int}");
    EXPECT_OK(IPC_connectModule("A", central->address));
    struct module *other = module_start("knows_early_format", central);
    EXPECT_INT(module_hear(other), 1);
}

PLAYER(knows_early_format)
{
    player_say(0);
    player_say(IPC_parseFormat("early") != NULL);
}

CHECK(a_disconnected_library_refuses_what_needs_a_connection)
{
    connected();
    FORMATTER_PTR formatter = IPC_parseFormat("int");
    int number = 3;
    EXPECT_QUIET(IPC_disconnect(), IPC_OK);
    expect_common_results();
    expect_marshalling_to_fail(formatter, &number);
    expect_data_calls_to_fail(IPC_Not_Initialized);
    EXPECT_ERROR(IPC_defineFormat("f", "int"), IPC_Not_Connected);
    EXPECT_QUIET(IPC_subscribeFD(0, on_fd, NULL), IPC_OK);
    EXPECT_QUIET(IPC_unsubscribeFD(0, on_fd), IPC_OK);
    EXPECT_INT(count_descriptors(IPC_getConnections()), 0);
    EXPECT_QUIET(IPC_disconnect(), IPC_OK);
}

CHECK_NEW(a_disconnected_library_has_no_context)
{
    connected();
    IPC_disconnect();
    EXPECT(IPC_getContext() == NULL);
    EXPECT_ERROR(IPC_handleMessage(0), IPC_Not_Connected);
}

CHECK(formatters_that_were_parsed_survive_a_new_connection)
{
    struct central *central = connected();
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string}");
    struct {
        int number;
        char *text;
    } value = {4, "four"};
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("A", central->address));
    capture();
    EXPECT_OK(IPC_printData(formatter, stdout, &value));
    EXPECT_TEXT(captured_stdout(), "{4, \"four\"}\n");
}

CHECK(initialising_twice_succeeds_and_does_not_connect)
{
    EXPECT_OK(IPC_initialize());
    EXPECT_OK(IPC_initialize());
    EXPECT_INT(IPC_isConnected(), 0);
}

CHECK(disconnecting_succeeds_in_every_state_without_a_word)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_OK(IPC_disconnect());
    EXPECT_OK(IPC_disconnect());
    IPC_initialize();
    EXPECT_OK(IPC_disconnect());
    EXPECT_OK(IPC_disconnect());
    EXPECT_TEXT(captured_stderr(), "");
    EXPECT_TEXT(captured_stdout(), "");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", central->address));
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_OK(IPC_disconnect());
    EXPECT_OK(IPC_disconnect());
    EXPECT_TEXT(captured_stderr(), "");
    EXPECT_TEXT(captured_stdout(), "");
    IPC_setVerbosity(IPC_Silent);
}

/* ----------------------------------------------------------------------- arguments */

static void expect_names_to_be_needed(const char *name)
{
    int number = 1;
    IPC_VARCONTENT_TYPE content = {sizeof number, &number};
    void *reply;

    EXPECT_FAILURE(IPC_isModuleConnected(name), -1, IPC_Null_Argument);
    EXPECT_ERROR(IPC_defineMsg(name, IPC_VARIABLE_LENGTH, NULL), IPC_Null_Argument);
    EXPECT_NULL(IPC_isMsgDefined(name), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publish(name, sizeof number, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publishVC(name, &content), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publishFixed(name, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publishData(name, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribe(name, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeData(name, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_unsubscribe(name, note_a), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeHandlerChange(name, on_change, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_unsubscribeHandlerChange(name, on_change), IPC_Null_Argument);
    EXPECT_FAILURE(IPC_numHandlers(name), -1, IPC_Null_Argument);
    EXPECT_ERROR(IPC_respond(NULL, name, sizeof number, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respondVC(NULL, name, &content), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respondData(NULL, name, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotify(name, sizeof number, &number, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotifyVC(name, &content, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotifyData(name, &number, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryResponse(name, sizeof number, &number, &reply, 10), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryResponseVC(name, &content, &reply, 10), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryResponseData(name, &number, &reply, 10), IPC_Null_Argument);
    EXPECT_ERROR(IPC_defineFormat(name, "int"), IPC_Null_Argument);
    EXPECT_ERROR(IPC_checkMsgFormats(name, "int"), IPC_Null_Argument);
    EXPECT_NULL(IPC_msgFormatter(name), IPC_Null_Argument);
}

CHECK(every_function_that_takes_a_name_refuses_null_and_the_empty_name)
{
    connected();
    expect_names_to_be_needed(NULL);
    expect_names_to_be_needed("");
}

CHECK_NEW(queue_control_refuses_null_and_the_empty_name)
{
    connected();
    EXPECT_ERROR(IPC_setMsgQueueLength(NULL, 1), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setMsgQueueLength("", 1), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setMsgPriority(NULL, 1), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setMsgPriority("", 1), IPC_Null_Argument);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

CHECK(arguments_are_checked_before_the_connection)
{
    IPC_VARCONTENT_TYPE content = {0, NULL};
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPC_publish(NULL, 0, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publishVC("m", NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotifyVC("m", NULL, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respondVC(NULL, "m", NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respondVC(NULL, "m", &content), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setCapacity(0), IPC_Argument_Out_Of_Range);
}

CHECK(calls_on_no_instance_report_a_null_argument)
{
    connected();
    EXPECT_NULL(IPC_msgInstanceName(NULL), IPC_Null_Argument);
    EXPECT_NULL(IPC_dataLength(NULL), IPC_Null_Argument);
    EXPECT_NULL(IPC_msgInstanceFormatter(NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_delayResponse(NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respond(NULL, "m", 0, NULL), IPC_Null_Argument);
}

CHECK_NEW(arguments_that_crashed_the_original_give_errors)
{
    connected();
    int number = 1;
    void *reply = &number;
    FORMATTER_PTR formatter = IPC_parseFormat("int");
    define_int("m");
    EXPECT_ERROR(IPC_subscribe("m", NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeData("m", NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeConnect(NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeDisconnect(NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeHandlerChange("m", NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_subscribeFD(-1, on_fd, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_subscribeFD(0, NULL, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_defineFormat("f", NULL), IPC_Null_Argument);
    EXPECT_QUIET(IPC_freeDataElements(NULL, NULL), IPC_OK);
    EXPECT_ERROR(IPC_printData(formatter, NULL, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_printData(NULL, stdout, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_marshall(formatter, NULL, &(IPC_VARCONTENT_TYPE){0, NULL}), IPC_Null_Argument);
    EXPECT_ERROR(IPC_unmarshallData(formatter, &number, NULL, sizeof number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_publishData("m", NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotifyData("m", NULL, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryResponseData("m", NULL, &reply, 10), IPC_Null_Argument);
    EXPECT(reply == NULL);
    EXPECT_ERROR(IPC_publish("m", 4, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_queryNotify("m", 4, NULL, note_a, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_setContext((IPC_CONTEXT_PTR)&number), IPC_Argument_Out_Of_Range);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

CHECK_NEW(printing_nothing_by_no_format_prints_null)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    capture();
    EXPECT_OK(IPC_printData(NULL, stdout, NULL));
    EXPECT_TEXT(captured_stdout(), "NULL\n");
}

CHECK_NEW(a_descriptor_that_is_not_open_is_refused)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    EXPECT_ERROR(IPC_subscribeFD(200, on_fd, NULL), IPC_Argument_Out_Of_Range);
}

/* ---------------------------------------------------------------------- IPC_errno */

CHECK(successful_calls_leave_the_error_number_alone)
{
    connected();
    IPC_publish(NULL, 0, NULL);
    EXPECT_INT(IPC_errno, IPC_Null_Argument);
    EXPECT_OK(define_int("m"));
    EXPECT_OK(IPC_subscribe("m", note_a, NULL));
    settle();
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    EXPECT_INT(IPC_isMsgDefined("unknown"), 0);
    EXPECT_INT(IPC_numHandlers("m"), 1);
    EXPECT_INT(IPC_numHandlers("unknown"), 0);
    EXPECT_OK(IPC_setCapacity(2));
    EXPECT(IPC_parseFormat("int") != NULL);
    listen_until(1);
    EXPECT_OK(IPC_addTimer(1000, 1, on_timer, NULL));
    EXPECT_OK(IPC_unsubscribe("m", note_a));
    EXPECT_INT(IPC_errno, IPC_Null_Argument);
}

CHECK(a_timeout_is_no_error)
{
    connected();
    IPC_listenClear(20);
    EXPECT_QUIET(IPC_listen(0), IPC_Timeout);
}

CHECK(parsing_no_format_is_no_error)
{
    connected();
    EXPECT_QUIET(IPC_parseFormat(NULL), 0);
    EXPECT_QUIET(IPC_parseFormat(""), 0);
}
