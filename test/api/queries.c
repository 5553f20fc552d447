/*
 * Queries and responses (T127 to T148).
 *
 * The query is q, an int; the response r, an int as well.
 */
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void define_query(void)
{
    define_int("q");
    define_int("r");
    define_int("m");
}

static int number_of(BYTE_ARRAY content)
{
    int number = 0;
    if (content) {
        memcpy(&number, content, sizeof number);
        IPC_freeByteArray(content);
    }
    return number;
}

static IPC_RETURN_TYPE respond_int(MSG_INSTANCE instance, int number)
{
    return IPC_respond(instance, "r", sizeof number, &number);
}

/* Asks and gives the number of the response, or -1000 - result. */
static int ask_for(const char *message, int number, unsigned int timeout)
{
    void *reply = &number;
    const IPC_RETURN_TYPE result =
        IPC_queryResponse(message, sizeof number, &number, &reply, timeout);
    if (result != IPC_OK) {
        EXPECT(reply == NULL);
        return -1000 - (int)result;
    }
    return number_of(reply);
}

static int ask(int number)
{
    return ask_for("q", number, 5000);
}

enum { TIMED_OUT = -1000 - IPC_Timeout, FAILED = -1000 - IPC_Error };

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_OK(respond_int(instance, number_of(content) + 100));
}

PLAYER(answerer)
{
    define_query();
    IPC_subscribe("q", answer, NULL);
    player_serve();
}

static struct central *connected_to(const char *player, struct module **module)
{
    struct central *central = connected();
    define_query();
    struct module *started = module_start(player, central);
    if (module) {
        *module = started;
    }
    return central;
}

/* ----------------------------------------------------------------------------- asking */

CHECK(a_query_is_answered_and_ordinary_subscribers_do_not_see_the_response)
{
    connected_to("answerer", NULL);
    IPC_subscribe("r", note_a, "r");
    settle();
    for (int i = 1; i <= 3; i++) {
        EXPECT_INT(ask_for("q", i, 5000), i + 100);
    }
    EXPECT_INT(ask_for("q", 4, IPC_WAIT_FOREVER), 104);
    listen_for(50);
    EXPECT_TEXT(recorded(), "");
}

static void answer_late(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const int number = number_of(content);
    (void)client_data;
    if (number == 1) {
        sleep_ms(600);
    }
    EXPECT_OK(respond_int(instance, number + 100));
}

PLAYER(late_answerer)
{
    define_query();
    IPC_subscribe("q", answer_late, NULL);
    player_serve();
}

CHECK(a_late_response_is_dropped)
{
    connected_to("late_answerer", NULL);
    EXPECT_INT(ask_for("q", 1, 300), TIMED_OUT);
    listen_for(600);
    EXPECT_INT(ask(2), 102);
}

CHECK(a_query_that_nobody_takes_times_out)
{
    connected();
    define_query();
    const long start = now_ms();
    EXPECT_INT(ask_for("q", 1, 300), TIMED_OUT);
    EXPECT(now_ms() - start >= 295);
    EXPECT_INT(ask_for("q", 1, 0), TIMED_OUT);
}

CHECK(a_query_waits_for_a_subscriber)
{
    struct central *central = connected();
    define_query();
    int number = 5;
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    module_start("answerer", central);
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply105 ");
}

CHECK_NEW(queries_that_wait_are_delivered_oldest_first)
{
    struct central *central = connected();
    define_query();
    for (int number = 1; number <= 3; number++) {
        EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, ""));
    }
    module_start("answerer", central);
    listen_until(3);
    EXPECT_TEXT(recorded(), "101 102 103 ");
}

/* ------------------------------------------------------------------ wrong numbers of answers */

static void answer_twice(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    char expected[200];
    const int number = number_of(content);
    (void)client_data;
    EXPECT_OK(respond_int(instance, number + 100));
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_ERROR(respond_int(instance, number + 200), IPC_Argument_Out_Of_Range);
    const char *found = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    int id = 0;
    (void)sscanf(found, "x_ipc_sendResponse: Already responed to instance %d", &id);
    snprintf(expected, sizeof expected,
             "x_ipc_sendResponse: Already responed to instance %d (q)\n\n"
             "ERROR: Argument out of range\n",
             id);
    EXPECT_TEXT(found, expected);
}

PLAYER(double_answerer)
{
    define_query();
    IPC_subscribe("q", answer_twice, NULL);
    player_serve();
}

CHECK_NEW(a_second_response_is_refused_and_the_first_one_counts)
{
    connected_to("double_answerer", NULL);
    EXPECT_INT(ask(1), 101);
    EXPECT_INT(ask(2), 102);
}

static int n_answers;

static void answer_and_count(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    n_answers++;
    answer(instance, content, client_data);
}

static void answer_and_count_too(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    answer_and_count(instance, content, client_data);
}

CHECK_NEW(a_query_goes_to_one_of_two_handlers)
{
    connected();
    define_query();
    IPC_subscribe("q", answer_and_count, NULL);
    IPC_subscribe("q", answer_and_count_too, NULL);
    EXPECT_INT(ask(1), 101);
    listen_for(50);
    EXPECT_INT(n_answers, 1);
}

CHECK_NEW(a_query_goes_to_one_of_two_modules)
{
    struct central *central = connected();
    define_query();
    module_start("answerer", central);
    module_start("answerer", central);
    for (int i = 0; i < 10; i++) {
        EXPECT_INT(ask(i), i + 100);
    }
}

static void only_note(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    player_say(number_of(content));
}

PLAYER(silent_one)
{
    define_query();
    IPC_subscribe("q", only_note, NULL);
    IPC_subscribe("m", only_note, NULL);
    player_serve();
}

CHECK(a_handler_that_does_not_answer_is_done)
{
    struct module *module;
    connected_to("silent_one", &module);
    EXPECT_INT(ask_for("q", 1, 200), TIMED_OUT);
    settle();
    EXPECT_OK(publish_int("m", 2));
    EXPECT_INT(module_hear(module), 1);
    EXPECT_INT(module_hear(module), 2);
}

CHECK(the_response_to_a_publication_reaches_nobody)
{
    connected_to("answerer", NULL);
    IPC_subscribe("r", note_a, "r");
    settle();
    EXPECT_OK(publish_int("q", 1));
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
    EXPECT_INT(ask(2), 102);
}

/* --------------------------------------------------------------------- queries inside queries */

static void ask_third(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_OK(respond_int(instance, ask_for("q2", number_of(content), 5000) + 1000));
}

PLAYER(asks_another)
{
    define_query();
    define_int("q2");
    IPC_subscribe("q", ask_third, NULL);
    player_serve();
}

PLAYER(second_answerer)
{
    define_query();
    define_int("q2");
    IPC_subscribe("q2", answer, NULL);
    player_serve();
}

CHECK(a_handler_of_a_query_may_ask_another_module)
{
    struct central *central = connected_to("second_answerer", NULL);
    module_start("asks_another", central);
    EXPECT_INT(ask(1), 1101);
}

CHECK(a_handler_of_a_query_may_ask_the_asker_back)
{
    struct central *central = connected();
    define_query();
    define_int("q2");
    IPC_subscribe("q2", answer, NULL);
    settle();
    module_start("asks_another", central);
    EXPECT_INT(ask(1), 1101);
}

CHECK(a_query_may_go_to_the_own_handler)
{
    connected();
    define_query();
    IPC_subscribe("q", answer, NULL);
    settle();
    EXPECT_INT(ask(1), 101);
}

static void note_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    record("%s ", (const char *)client_data);
}

CHECK(messages_and_timers_are_handled_while_a_query_waits)
{
    connected_to("late_answerer", NULL);
    IPC_subscribe("m", note_a, "m");
    settle();
    publish_int("m", 1);
    publish_int("m", 2);
    IPC_addOneShotTimer(100, note_timer, "timer");
    EXPECT_INT(ask(1), 101);
    EXPECT_TEXT(recorded(), "m1 m2 timer ");
}

/* ---------------------------------------------------------------------------- responses */

static void try_wrong_answers_first(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const int number = number_of(content);
    (void)client_data;
    EXPECT_ERROR(IPC_respond(instance, NULL, 4, (void *)&number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respondVC(instance, "r", NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respond(NULL, "r", 4, (void *)&number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_respond(instance, "unknown", 4, (void *)&number), IPC_Message_Not_Defined);
    EXPECT_ERROR(IPC_respond(instance, "fixed", 5, (void *)&number), IPC_Message_Lengths_Differ);
    EXPECT_OK(IPC_respond(instance, "fixed", 4, (void *)&number));
}

PLAYER(careless_answerer)
{
    define_query();
    IPC_defineMsg("fixed", 4, "int");
    IPC_subscribe("q", try_wrong_answers_first, NULL);
    player_serve();
}

CHECK(a_response_may_be_tried_until_it_is_right)
{
    connected_to("careless_answerer", NULL);
    EXPECT_INT(ask(1), 1);
}

static void answer_variously(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = number_of(content);
    IPC_VARCONTENT_TYPE nothing = {0, NULL};
    (void)client_data;
    switch (number) {
    case 0:
        EXPECT_OK(IPC_respond(instance, "r", 0, NULL));
        break;
    case 1:
        EXPECT_OK(IPC_respond(instance, "none", 0, NULL));
        break;
    case 2:
        EXPECT_OK(IPC_respondVC(instance, "r", &nothing));
        break;
    case 3:
        EXPECT_OK(IPC_respond(instance, "fixed", IPC_FIXED_LENGTH, &number));
        break;
    default:
        EXPECT_OK(IPC_respondData(instance, "r", &number));
        break;
    }
}

static void define_various(void)
{
    define_query();
    IPC_defineMsg("fixed", 4, "int");
    IPC_defineMsg("none", 0, NULL);
}

PLAYER(various_answerer)
{
    define_various();
    IPC_subscribe("q", answer_variously, NULL);
    player_serve();
}

CHECK(responses_may_be_empty_fixed_or_data)
{
    void *reply;
    connected_to("various_answerer", NULL);
    for (int number = 0; number < 3; number++) {
        reply = &number;
        EXPECT_OK(IPC_queryResponse("q", sizeof number, &number, &reply, 5000));
        EXPECT(reply == NULL);
    }
    EXPECT_INT(ask(3), 3);
    EXPECT_INT(ask(4), 4);
    EXPECT_OK(IPC_queryResponseData("q", &(int){3}, &reply, 5000));
    EXPECT_INT(*(int *)reply, 3);
    EXPECT_OK(IPC_freeData(IPC_msgFormatter("fixed"), reply));
}

CHECK_NEW(the_data_of_an_empty_response_are_null)
{
    connected_to("various_answerer", NULL);
    for (int number = 0; number < 3; number++) {
        void *reply = &number;
        EXPECT_OK(IPC_queryResponseData("q", &number, &reply, 5000));
        EXPECT(reply == NULL);
    }
}

CHECK(the_formatter_of_a_response_can_be_had)
{
    void *reply;
    int number = 3;
    FORMATTER_PTR formatter = NULL;
    connected_to("various_answerer", NULL);
    IPC_defineMsg("fixed", 4, "int");
    EXPECT_OK(_IPC_queryResponse("q", sizeof number, &number, &reply, &formatter, 5000));
    EXPECT(formatter == IPC_msgFormatter("fixed"));
    IPC_freeByteArray(reply);
    EXPECT_OK(_IPC_queryResponse("q", sizeof number, &number, &reply, NULL, 5000));
    IPC_freeByteArray(reply);
}

CHECK_NEW(a_failed_query_gives_no_reply)
{
    int number = 0;
    void *reply = &number;
    connected();
    define_query();
    EXPECT_ERROR(IPC_queryResponse("unknown", 4, &number, &reply, 100), IPC_Message_Not_Defined);
    EXPECT(reply == NULL);
    reply = &number;
    EXPECT_ERROR(IPC_queryResponseData("unknown", &number, &reply, 100), IPC_Message_Not_Defined);
    EXPECT(reply == NULL);
}

/* ------------------------------------------------------------------------- delayed responses */

enum { DELAYED = 4 };
static MSG_INSTANCE delayed[DELAYED];
static int n_delayed;

static void delay(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    EXPECT_OK(IPC_delayResponse(instance));
    delayed[n_delayed++] = instance;
    player_say(number_of(content));
}

static void answer_delayed(int fd, void *client_data)
{
    int which;
    (void)client_data;
    if (read(fd, &which, sizeof which) <= 0) {
        IPC_disconnect();
        exit(0);
    }
    EXPECT_TEXT(IPC_msgInstanceName(delayed[which]), "q");
    EXPECT_OK(respond_int(delayed[which], which + 100));
}

static void delay_answers(int capacity)
{
    define_query();
    IPC_setCapacity(capacity);
    IPC_subscribe("q", delay, NULL);
    IPC_subscribe("m", only_note, NULL);
    IPC_subscribeFD(player_control(), answer_delayed, NULL);
    settle();
    player_say(0);
    while (IPC_listen(IPC_WAIT_FOREVER) != IPC_Error) {
    }
}

PLAYER(delays_one)
{
    delay_answers(1);
}

PLAYER(delays_three)
{
    delay_answers(3);
}

CHECK(a_delayed_response_counts_as_being_handled)
{
    int number = 7;
    struct module *module;
    connected_to("delays_one", &module);
    IPC_listenClear(50);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    EXPECT_OK(publish_int("m", 8));
    EXPECT_INT(module_hear(module), 7);
    listen_for(300);
    EXPECT_TEXT(recorded(), "");
    module_tell(module, 0);
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply100 ");
    EXPECT_INT(module_hear(module), 8);
}

CHECK(delayed_responses_find_their_queries)
{
    int number = 1;
    struct module *module;
    connected_to("delays_three", &module);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "first"));
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "second"));
    EXPECT_INT(module_hear(module), 1);
    EXPECT_INT(module_hear(module), 1);
    module_tell(module, 1);
    listen_until(1);
    module_tell(module, 0);
    listen_until(2);
    EXPECT_TEXT(recorded(), "second101 first100 ");
}

static MSG_INSTANCE kept;

static void keep(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    IPC_freeByteArray(content);
    kept = instance;
    if (client_data) {
        EXPECT_OK(IPC_delayResponse(instance));
    }
    record("x");
}

CHECK_NEW(a_response_after_the_handler_needs_a_delay_and_comes_once)
{
    int number = 1;
    connected();
    define_query();
    IPC_subscribe("q", keep, NULL);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    listen_until(1);
    EXPECT_ERROR(respond_int(kept, 5), IPC_Argument_Out_Of_Range);
    IPC_subscribe("q", keep, "delay");
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    listen_until(2);
    recorded();
    EXPECT_OK(respond_int(kept, 6));
    EXPECT_ERROR(respond_int(kept, 7), IPC_Argument_Out_Of_Range);
    EXPECT_NULL(IPC_msgInstanceName(kept), IPC_Argument_Out_Of_Range);
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply6 ");
}

/* --------------------------------------------------------------------------- reply handlers */

static void expect_response(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    EXPECT_TEXT(IPC_msgInstanceName(instance), "r");
    EXPECT(IPC_msgInstanceFormatter(instance) == IPC_msgFormatter("r"));
    EXPECT(is_original() || IPC_dataLength(instance) == 4);
    record("%s%d ", (const char *)client_data, number_of(content));
}

CHECK(a_reply_handler_gets_the_response)
{
    int number = 3;
    IPC_VARCONTENT_TYPE content = {sizeof number, &number};
    connected_to("answerer", NULL);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, expect_response, "a"));
    listen_until(1);
    EXPECT_OK(IPC_queryNotifyVC("q", &content, expect_response, "b"));
    listen_until(2);
    EXPECT_OK(IPC_queryNotifyData("q", &number, expect_response, "c"));
    listen_until(3);
    EXPECT_TEXT(recorded(), "a103 b103 c103 ");
}

CHECK(a_reply_without_a_handler_is_thrown_away)
{
    int number = 3;
    connected_to("answerer", NULL);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, NULL, NULL));
    listen_for(100);
    EXPECT_INT(ask(1), 101);
}

CHECK_NEW(a_reply_handler_runs_only_while_listening)
{
    int number = 3;
    connected_to("answerer", NULL);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    sleep_ms(200);
    EXPECT_INT(IPC_isMsgDefined("other"), 0);
    EXPECT_TEXT(recorded(), "");
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply103 ");
}

/* --------------------------------------------------------------------- modules that go away */

PLAYER(asks_and_leaves)
{
    int number = 1;
    define_query();
    player_say(0);
    player_wait();
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, NULL, NULL));
    player_wait();
    IPC_disconnect();
    player_say(1);
}

static void answer_the_gone(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    struct module *asker = client_data;
    IPC_freeByteArray(content);
    module_tell(asker, 1);
    EXPECT_INT(module_hear(asker), 1);
    EXPECT_INT(module_end(asker), 0);
    record("%d ", (int)respond_int(instance, 1));
}

CHECK(responding_to_an_asker_that_has_gone_succeeds)
{
    struct central *central = connected();
    define_query();
    struct module *asker = module_start("asks_and_leaves", central);
    IPC_subscribe("q", answer_the_gone, asker);
    settle();
    module_tell(asker, 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "1 ");
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

static void die(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)content;
    (void)client_data;
    raise(SIGKILL);
}

PLAYER(dies_when_asked)
{
    define_query();
    IPC_subscribe("q", die, NULL);
    player_serve();
}

CHECK(an_answerer_that_dies_lets_the_asker_go_on)
{
    struct module *module;
    connected_to("dies_when_asked", &module);
    const int answered = ask_for("q", 1, 300);
    EXPECT(answered == TIMED_OUT || (!is_original() && answered == FAILED));
    EXPECT_INT(module_end(module), -SIGKILL);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

/* ---------------------------------------------------------------------------------- data */

static void answer_text(MSG_INSTANCE instance, void *data, void *client_data)
{
    char *text = "an answer";
    (void)client_data;
    if (*(int *)data == 1) {
        EXPECT_OK(IPC_respondData(instance, "text", &text));
    }
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
}

PLAYER(text_answerer)
{
    define_query();
    IPC_defineMsg("text", IPC_VARIABLE_LENGTH, "string");
    IPC_subscribeData("q", answer_text, NULL);
    player_serve();
}

CHECK(the_data_of_a_response_are_unmarshalled)
{
    int number = 1;
    void *reply = NULL;
    connected_to("text_answerer", NULL);
    EXPECT_OK(IPC_queryResponseData("q", &number, &reply, 5000));
    EXPECT(reply != NULL);
    EXPECT_TEXT(*(char **)reply, "an answer");
    EXPECT_OK(IPC_freeData(IPC_msgFormatter("text"), reply));
    number = 2;
    reply = &number;
    EXPECT_TIMEOUT(IPC_queryResponseData("q", &number, &reply, 200));
    EXPECT(reply == NULL);
}
