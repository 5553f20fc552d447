/*
 * Defining and publishing messages (T49 to T69).
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <unistd.h>

static void note_name(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    record("%s ", IPC_msgInstanceName(instance));
    IPC_freeByteArray(content);
}

static void note_length(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)client_data;
    record("%s%u ", content ? "" : "NULL ", IPC_dataLength(instance));
    IPC_freeByteArray(content);
}

/* --------------------------------------------------------------------- defining */

CHECK(a_length_that_does_not_fit_the_format_is_refused)
{
    connected();
    EXPECT_ERROR(IPC_defineMsg("x", 8, "int"), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_defineMsg("x", 0, "int"), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_defineMsg("x", 4, "<int:1>"), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_defineMsg("x", 4, "unknown"), IPC_Mismatched_Formatter);
    EXPECT_INT(IPC_isMsgDefined("x"), 0);
}

CHECK(lengths_and_formats_that_fit_are_accepted)
{
    connected();
    EXPECT_QUIET(IPC_defineMsg("variable", IPC_VARIABLE_LENGTH, "{int, string}"), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("bytes", IPC_VARIABLE_LENGTH, NULL), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("fixed", 4, "int"), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("structure", 16, "{int, double}"), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("fixed bytes", 7, NULL), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("nothing", 0, NULL), IPC_OK);
    EXPECT_QUIET(IPC_defineMsg("empty format", IPC_VARIABLE_LENGTH, ""), IPC_OK);
    EXPECT_INT(IPC_isMsgDefined("structure"), 1);
    EXPECT(IPC_msgFormatter("empty format") == NULL);
}

CHECK_NEW(lengths_that_killed_central_are_refused)
{
    connected();
    EXPECT_ERROR(IPC_defineMsg("x", IPC_FIXED_LENGTH, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_defineMsg("x", 0x80000000u, NULL), IPC_Argument_Out_Of_Range);
    EXPECT_INT(IPC_isMsgDefined("x"), 0);
}

CHECK_NEW(a_format_that_does_not_parse_is_refused)
{
    connected();
    EXPECT_ERROR(IPC_defineMsg("x", IPC_VARIABLE_LENGTH, "{int"), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_defineMsg("x", IPC_VARIABLE_LENGTH, "[int]"), IPC_Illegal_Formatter);
    EXPECT_INT(IPC_isMsgDefined("x"), 0);
}

CHECK(a_named_format_may_be_defined_after_the_message)
{
    connected();
    int pair[2] = {1, 2};
    IPC_VARCONTENT_TYPE content;
    EXPECT_OK(IPC_defineMsg("x", IPC_VARIABLE_LENGTH, "later"));
    EXPECT_OK(IPC_defineFormat("later", "{int, int}"));
    EXPECT_OK(IPC_marshall(IPC_msgFormatter("x"), pair, &content));
    EXPECT_INT(content.length, 8);
    IPC_freeByteArray(content.content);
}

PLAYER(subscriber)
{
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    player_serve();
}

PLAYER(definer)
{
    EXPECT_OK(define_int("m"));
    player_say(0);
    player_wait();
    settle();
    EXPECT_OK(publish_int("m", 3));
    player_say(1);
}

CHECK(modules_may_define_the_same_message_alike)
{
    struct central *central = connected();
    EXPECT_QUIET(define_int("m"), IPC_OK);
    EXPECT_QUIET(define_int("m"), IPC_OK);
    IPC_subscribe("m", note_a, "m");
    struct module *other = module_start("definer", central);
    module_tell(other, 1);
    EXPECT_INT(module_hear(other), 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m3 ");
}

PLAYER(redefiner)
{
    double real = 1.5;
    player_say(0);
    player_wait();
    EXPECT_OK(IPC_defineMsg("m", 8, "double"));
    player_say(IPC_isMsgDefined("m"));
    player_wait();
    settle();
    EXPECT_OK(IPC_publish("m", sizeof real, &real));
    player_say(1);
}

PLAYER(late_comer)
{
    player_say(0);
    player_say(IPC_checkMsgFormats("m", "double") == IPC_OK);
}

static void note_data(MSG_INSTANCE instance, void *data, void *client_data)
{
    (void)client_data;
    record("data ");
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
}

CHECK(a_redefinition_counts_for_modules_that_ask_later)
{
    struct central *central = connected();
    define_int("m");
    EXPECT_OK(IPC_checkMsgFormats("m", "int"));
    struct module *other = module_start("redefiner", central);
    module_tell(other, 1);
    EXPECT_INT(module_hear(other), 1);
    struct module *late = module_start("late_comer", central);
    EXPECT_INT(module_hear(late), 1);
    EXPECT_OK(IPC_checkMsgFormats("m", "int"));
    module_kill(other);
}

CHECK_NEW(data_of_another_definition_are_never_read_beyond_their_end)
{
    struct central *central = connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "{int, string}");
    IPC_subscribeData("m", note_data, NULL);
    struct module *other = module_start("redefiner", central);
    module_tell(other, 1);
    EXPECT_INT(module_hear(other), 1);
    module_tell(other, 2);
    EXPECT_INT(module_hear(other), 1);
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

CHECK_NEW(a_redefinition_is_warned_of_with_both_formats)
{
    connected();
    define_int("m");
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    EXPECT_OK(IPC_checkMsgFormats("m", "int"));
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "double"));
    const char *warning = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    expect(strncmp(warning, "WARNING: Redefining message m", 29) == 0, PLACE, "a warning", "\"%s\"",
           warning);
    EXPECT(strstr(warning, "int") && strstr(warning, "double"));
    EXPECT_OK(IPC_checkMsgFormats("m", "double"));
}

/* --------------------------------------------------------------------- lengths */

struct length_case {
    const char *message;
    unsigned int length;
    IPC_ERROR_TYPE error;
    const char *warning;
};

static void expect_lengths(const struct length_case *table, size_t count)
{
    char content[16] = "";
    for (size_t i = 0; i < count; i++) {
        const struct length_case *row = &table[i];
        IPC_errno = IPC_No_Error;
        IPC_setVerbosity(IPC_Print_Warnings);
        capture();
        const IPC_RETURN_TYPE result = IPC_publish(row->message, row->length, content);
        const char *warning = captured_stderr();
        IPC_setVerbosity(IPC_Silent);
        expect(result == (row->error ? IPC_Error : IPC_OK) && IPC_errno == row->error, PLACE,
               "the result of the table", "%d, IPC_errno %d for %s, %u", (int)result,
               (int)IPC_errno, row->message, row->length);
        EXPECT_TEXT(warning, row->warning);
    }
}

static void define_all_kinds(void)
{
    IPC_defineMsg("none", 0, NULL);
    IPC_defineMsg("fixed", 4, NULL);
    IPC_defineMsg("variable", IPC_VARIABLE_LENGTH, NULL);
}

CHECK(every_kind_of_message_checks_its_length)
{
    static const struct length_case table[] = {
        {"none", 0, IPC_No_Error, ""},
        {"none", IPC_FIXED_LENGTH, IPC_No_Error, ""},
        {"fixed", 4, IPC_No_Error, ""},
        {"fixed", IPC_FIXED_LENGTH, IPC_No_Error, ""},
        {"fixed", 5, IPC_Message_Lengths_Differ,
         "Illegal length argument 5 for fixed-length message fixed\n"},
        {"fixed", 0, IPC_Message_Lengths_Differ,
         "Illegal length argument 0 for fixed-length message fixed\n"},
        {"variable", 0, IPC_No_Error, ""},
        {"variable", 16, IPC_No_Error, ""},
        {"variable", IPC_VARIABLE_LENGTH, IPC_Message_Lengths_Differ,
         "Illegal length argument -1 for variable-length message variable\n"},
    };
    connected();
    define_all_kinds();
    expect_lengths(table, sizeof table / sizeof *table);
}

CHECK_NEW(lengths_differ_from_the_original_where_the_manual_says_so)
{
    static const struct length_case table[] = {
        {"none", 3, IPC_Message_Lengths_Differ,
         "Illegal length argument 3 for zero-length message\n none\n"},
        {"variable", IPC_FIXED_LENGTH, IPC_Not_Fixed_Length,
         "Illegal length argument -2 for variable-length message variable\n"},
        {"variable", 0x7fffffff, IPC_Argument_Out_Of_Range, ""},
    };
    connected();
    define_all_kinds();
    expect_lengths(table, sizeof table / sizeof *table);
}

CHECK(messages_without_data_arrive_as_null_of_length_zero)
{
    IPC_VARCONTENT_TYPE nothing = {0, NULL};
    connected();
    define_all_kinds();
    IPC_subscribe("none", note_length, NULL);
    IPC_subscribe("variable", note_length, NULL);
    settle();
    EXPECT_OK(IPC_publish("none", 0, NULL));
    EXPECT_OK(IPC_publishFixed("none", NULL));
    EXPECT_OK(IPC_publishVC("none", &nothing));
    EXPECT_OK(IPC_publish("variable", 0, NULL));
    EXPECT_OK(IPC_publishVC("variable", &nothing));
    listen_until(5);
    EXPECT_TEXT(recorded(), "NULL 0 NULL 0 NULL 0 NULL 0 NULL 0 ");
}

static void check_big(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const unsigned char *bytes = content;
    const unsigned int length = IPC_dataLength(instance);
    unsigned int intact = 0;
    (void)client_data;
    while (intact < length && bytes[intact] == intact % 251) {
        intact++;
    }
    record("%u of %u intact", intact, length);
    IPC_freeByteArray(content);
}

CHECK(twenty_million_bytes_arrive_whole)
{
    const unsigned int length = 20000000;
    connected();
    define_all_kinds();
    IPC_subscribe("variable", check_big, NULL);
    settle();
    unsigned char *bytes = malloc(length);
    for (unsigned int i = 0; i < length; i++) {
        bytes[i] = (unsigned char)(i % 251);
    }
    EXPECT_OK(IPC_publish("variable", length, bytes));
    free(bytes);
    listen_until(1);
    EXPECT_TEXT(recorded(), "20000000 of 20000000 intact");
}

/* ------------------------------------------------------------- who hears of what */

static void publish_until_told(IPC_RETURN_TYPE connection)
{
    struct timeval nothing = {0, 0};
    fd_set set;
    int number = 0;
    EXPECT_OK(connection);
    define_int("m");
    player_say(0);
    do {
        EXPECT_OK(publish_int("m", number++));
        sleep_ms(20);
        FD_ZERO(&set);
        FD_SET(player_control(), &set);
    } while (select(player_control() + 1, &set, NULL, NULL, &nothing) == 0);
    player_wait();
    EXPECT_OK(publish_int("m", -1));
    player_say(number);
}

PLAYER(publisher_that_never_listens)
{
    publish_until_told(IPC_OK);
}

PLAYER(publisher_that_promised_not_to_listen)
{
    IPC_disconnect();
    publish_until_told(IPC_connectModuleNoListen("P", player_address()));
}

static void note_number(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int *numbers = client_data; /* first, last, count */
    (void)instance;
    const int number = *(int *)content;
    if (number >= 0) {
        numbers[0] = numbers[2] == 0 ? number : numbers[0];
        numbers[1] = number;
        numbers[2]++;
    }
    record("x");
    IPC_freeByteArray(content);
}

/* Everything that is published after a subscription arrives, whatever the publisher does otherwise.
 */
static void expect_all_from(const char *player)
{
    int numbers[3] = {0, 0, 0};
    struct central *central = connected();
    struct module *publisher = module_start(player, central);
    sleep_ms(200);
    IPC_subscribe("m", note_number, numbers);
    listen_until(10);
    module_tell(publisher, 1);
    const int published = module_hear(publisher);
    recorded();
    const long end = now_ms() + 3000;
    while (numbers[1] < published - 1 && now_ms() < end) {
        IPC_listen(50);
    }
    EXPECT_INT(numbers[1], published - 1);
    EXPECT_INT(numbers[2], numbers[1] - numbers[0] + 1);
    EXPECT(numbers[2] >= 10);
}

CHECK_NEW(a_publisher_that_never_listens_reaches_later_subscribers)
{
    expect_all_from("publisher_that_never_listens");
}

CHECK(a_publisher_that_promised_not_to_listen_reaches_later_subscribers)
{
    expect_all_from("publisher_that_promised_not_to_listen");
}

CHECK_NEW(a_message_published_right_after_subscribing_arrives)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    EXPECT_OK(publish_int("m", 1));
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}

CHECK_NEW(names_differ_in_case_only_are_one_message_spelled_as_defined)
{
    connected();
    define_int("Foo");
    IPC_subscribe("FOO", note_name, NULL);
    publish_int("Foo", 1);
    publish_int("foo", 2);
    publish_int("FOO", 3);
    listen_until(3);
    EXPECT_TEXT(recorded(), "Foo Foo Foo ");
}

static void expect_name_to_work(const char *name)
{
    char expected[400];
    EXPECT_OK(define_int(name));
    EXPECT_OK(IPC_subscribe(name, note_name, NULL));
    settle();
    EXPECT_OK(publish_int(name, 1));
    listen_until(1);
    snprintf(expected, sizeof expected, "%s ", name);
    EXPECT_TEXT(recorded(), expected);
}

CHECK(names_may_hold_blanks_and_signs)
{
    connected();
    expect_name_to_work("two words");
    expect_name_to_work("a/path");
    expect_name_to_work("one:two");
    expect_name_to_work("%d%s%n");
}

CHECK_NEW(names_may_hold_letters_of_any_language)
{
    connected();
    expect_name_to_work("gr\xc3\xb6\xc3\x9f"
                        "e");
    expect_name_to_work("\xe6\xb8\xac\xe5\xae\x9a");
    expect_name_to_work("\xff\x80");
}

CHECK_NEW(two_handlers_of_a_message_with_a_long_name_are_two)
{
    char name[251];
    memset(name, 'n', 250);
    name[250] = '\0';
    connected();
    define_int(name);
    IPC_subscribe(name, note_a, "a");
    IPC_subscribe(name, note_b, "b");
    publish_int(name, 1);
    listen_until(2);
    EXPECT_TEXT(recorded(), "a1 b1 ");
}

/* ------------------------------------------------------------- order and patience */

static int depth;

static void publish_again(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const int number = *(int *)content;
    (void)instance;
    (void)client_data;
    depth++;
    record("%d(%d) ", number, depth);
    if (number < 4) {
        EXPECT_OK(publish_int("m", number + 1));
    }
    depth--;
    IPC_freeByteArray(content);
}

CHECK(a_message_published_by_its_own_handler_is_handled_after_it)
{
    connected();
    define_int("m");
    IPC_subscribe("m", publish_again, NULL);
    settle();
    publish_int("m", 1);
    listen_until(4);
    EXPECT_TEXT(recorded(), "1(1) 2(1) 3(1) 4(1) ");
}

static void check_next(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int *next = client_data;
    (void)instance;
    *next = *(int *)content == *next ? *next + 1 : -1000;
    record("x");
    IPC_freeByteArray(content);
}

static void continue_later(struct central *central)
{
    if (fork() == 0) {
        sleep_ms(1000);
        central_continue(central);
        _exit(0);
    }
}

CHECK(messages_published_while_central_is_stopped_arrive_in_order)
{
    int content[250] = {0};
    int next = 0;
    struct central *central = connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, NULL);
    IPC_subscribe("m", check_next, &next);
    settle();
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    central_stop(central);
    continue_later(central);
    for (int i = 0; i < 200; i++) {
        content[0] = i;
        EXPECT_OK(IPC_publish("m", sizeof content, content));
    }
    listen_until(200);
    EXPECT_INT(next, 200);
}

CHECK_NEW(data_of_an_illegal_format_are_not_published)
{
    int number = 1;
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "unknown_format");
    IPC_subscribe("m", note_a, "m");
    EXPECT_ERROR(IPC_publishData("m", &number), IPC_Illegal_Formatter);
    listen_for(50);
    EXPECT_TEXT(recorded(), "");
}

CHECK(published_data_without_a_format_are_nothing)
{
    int number = 1;
    connected();
    IPC_defineMsg("variable", IPC_VARIABLE_LENGTH, NULL);
    IPC_defineMsg("fixed", 4, NULL);
    IPC_subscribe("variable", note_length, NULL);
    settle();
    EXPECT_OK(IPC_publishData("variable", &number));
    EXPECT_ERROR(IPC_publishData("fixed", &number), IPC_Message_Lengths_Differ);
    listen_until(1);
    EXPECT_TEXT(recorded(), "NULL 0 ");
}
