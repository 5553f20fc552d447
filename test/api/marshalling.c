/*
 * Formats and marshalling as a program sees them (T149 to T155).  What bytes there are is the
 * matter of the tests of the layer below.
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>

struct mixed {
    int number;
    char *text;
    double real;
};

static void initialise(void)
{
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
}

/* ------------------------------------------------------------------------- marshalling */

CHECK(marshalling_by_no_format_gives_nothing)
{
    int number = 1;
    IPC_VARCONTENT_TYPE content = {7, &number};
    void *data = &number;
    initialise();
    EXPECT_OK(IPC_marshall(NULL, &number, &content));
    EXPECT_INT(content.length, 0);
    EXPECT(content.content == NULL);
    EXPECT_OK(IPC_unmarshall(NULL, &number, &data));
    EXPECT(data == NULL);
    EXPECT_ERROR(IPC_marshall(NULL, &number, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_marshall(IPC_parseFormat("int"), &number, NULL), IPC_Null_Argument);
}

CHECK(data_come_back_equal)
{
    struct mixed value = {1, "two", 3.5};
    struct mixed *back = NULL;
    IPC_VARCONTENT_TYPE content;
    initialise();
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string, double}");
    EXPECT_OK(IPC_marshall(formatter, &value, &content));
    EXPECT_INT(content.length, 4 + 4 + 3 + 8);
    EXPECT_OK(IPC_unmarshall(formatter, content.content, (void **)&back));
    memset(content.content, 0xee, content.length);
    IPC_freeByteArray(content.content);
    EXPECT_INT(back->number, 1);
    EXPECT_TEXT(back->text, "two");
    EXPECT(back->real > 3.49 && back->real < 3.51);
    EXPECT_OK(IPC_freeData(formatter, back));
}

CHECK(data_may_be_unmarshalled_into_a_variable)
{
    struct mixed value = {1, "two", 3.5};
    struct mixed back;
    IPC_VARCONTENT_TYPE content;
    initialise();
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string, double}");
    EXPECT_OK(IPC_marshall(formatter, &value, &content));
    EXPECT_ERROR(IPC_unmarshallData(formatter, content.content, &back, 3), IPC_Wrong_Buffer_Length);
    EXPECT_ERROR(IPC_unmarshallData(NULL, content.content, &back, sizeof back), IPC_Null_Argument);
    EXPECT_OK(IPC_unmarshallData(formatter, content.content, &back, sizeof back));
    EXPECT_INT(back.number, 1);
    EXPECT_TEXT(back.text, "two");
    EXPECT_OK(IPC_freeDataElements(formatter, &back));
    IPC_freeByteArray(content.content);
}

CHECK(marshalled_flat_data_are_a_copy)
{
    int number = 5;
    IPC_VARCONTENT_TYPE content;
    initialise();
    EXPECT_OK(IPC_marshall(IPC_parseFormat("int"), &number, &content));
    EXPECT(content.content != &number);
    number = 6;
    EXPECT_INT(*(int *)content.content, 5);
    free(content.content);
}

CHECK(top_level_blocks_may_be_freed_plainly)
{
    int number = 5;
    int *back = NULL;
    IPC_VARCONTENT_TYPE content;
    initialise();
    FORMATTER_PTR formatter = IPC_parseFormat("int");
    EXPECT_OK(IPC_marshall(formatter, &number, &content));
    EXPECT_OK(IPC_unmarshall(formatter, content.content, (void **)&back));
    EXPECT_INT(*back, 5);
    free(content.content);
    free(back);
    x_ipcFree(x_ipcMalloc(100));
    x_ipcFree(NULL);
}

CHECK(freeing_asks_for_formatter_and_data_or_neither)
{
    int number = 1;
    initialise();
    FORMATTER_PTR formatter = IPC_parseFormat("int");
    EXPECT_QUIET(IPC_freeData(NULL, NULL), IPC_OK);
    EXPECT_ERROR(IPC_freeData(formatter, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_freeData(NULL, &number), IPC_Null_Argument);
    EXPECT_ERROR(IPC_freeDataElements(formatter, NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_freeDataElements(NULL, &number), IPC_Null_Argument);
    IPC_freeByteArray(NULL);
}

static void free_plainly(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    record("x");
    free(content);
}

/* The allocator gives the block of a message again; what is in it now is the program's own. */
CHECK_NEW(own_data_at_the_address_of_freed_bytes_are_unmarshalled)
{
    char text[32];
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "string");
    IPC_subscribe("m", free_plainly, NULL);
    FORMATTER_PTR formatter = IPC_parseFormat("string");
    for (int i = 0; i < 20; i++) {
        char *back = NULL;
        char *value = text;
        IPC_VARCONTENT_TYPE content;
        strcpy(text, "short");
        EXPECT_OK(IPC_publishData("m", &value));
        listen_until(i + 1);
        snprintf(text, sizeof text, "something longer %d", i);
        EXPECT_OK(IPC_marshall(formatter, &value, &content));
        void *own = malloc(content.length);
        memcpy(own, content.content, content.length);
        EXPECT_OK(IPC_unmarshallData(formatter, own, &back, sizeof back));
        EXPECT_TEXT(back, text);
        free(back);
        free(own);
        IPC_freeByteArray(content.content);
    }
}

/* --------------------------------------------------------------------------- printing */

static void expect_print(const char *format, void *data, const char *expected)
{
    FORMATTER_PTR formatter = IPC_parseFormat(format);
    capture();
    const IPC_RETURN_TYPE result = IPC_printData(formatter, stdout, data);
    const char *printed = captured_stdout();
    EXPECT_INT(result, IPC_OK);
    expect_text(printed, expected, PLACE, format);
}

struct list {
    int number;
    struct list *next;
};

CHECK(every_type_is_printed_as_the_manual_says)
{
    int three[] = {1, 2, 3};
    int six[] = {1, 2, 3, 4, 5, 6};
    char *text = "hi there";
    char *nothing = NULL;
    int number = -5;
    int *pointer = &number;
    int *null = NULL;
    struct mixed mixed = {1, "two", 3.0};
    struct {
        int count;
        int *items;
    } array = {3, three}, empty = {0, NULL};
    struct list second = {2, NULL};
    struct list first = {1, &second};
    initialise();
    expect_print("int", &number, "-5\n");
    expect_print("short", &(short){-3}, "-3\n");
    expect_print("long", &(long){-7}, "-7\n");
    expect_print("char", &(char){'a'}, "a\n");
    expect_print("uint", &(unsigned int){4000000000u}, "4000000000\n");
    expect_print("ushort", &(unsigned short){60000}, "60000\n");
    expect_print("ulong", &(unsigned long){4000000000u}, "4000000000\n");
    expect_print("float", &(float){1.5f}, "1.50\n");
    expect_print("double", &(double){3.14159}, "3.14\n");
    expect_print("string", &text, "\"hi there\"\n");
    expect_print("string", &nothing, "\"NULL\"\n");
    expect_print("boolean", &(int){1}, "True\n");
    expect_print("boolean", &(int){0}, "False\n");
    expect_print("{enum : 3}", &(int){2}, "2\n");
    expect_print("{enum A,B,C}", &(int){2}, "C\n");
    expect_print("{enum A,B,C}", &(int){7}, "7\n");
    expect_print("{int, string, double}", &mixed, "{1, \"two\", 3.00}\n");
    expect_print("[int:2,3]", six, "[[1, 2, 3], [4, 5, 6]]\n");
    expect_print("{int, <int:1>}", &array, "{3, <1, 2, 3>}\n");
    expect_print("{int, <int:1>}", &empty, "{0, NULL}\n");
    expect_print("*int", &pointer, "*-5\n");
    expect_print("*int", &null, "NULL\n");
    expect_print("{int, *!}", &first, "{1, *{2, NULL}}\n");
    expect_print("[char:5]", "abcde", "[a, b, c, d, e]\n");
}

CHECK_NEW(bytes_are_printed_in_two_digits)
{
    initialise();
    expect_print("byte", &(char){0x61}, "0x61\n");
    expect_print("ubyte", &(unsigned char){200}, "0xc8\n");
}

CHECK(printing_to_a_stream_that_cannot_be_written_is_no_error)
{
    initialise();
    FILE *stream = fopen("/dev/null", "r");
    EXPECT_OK(IPC_printData(IPC_parseFormat("int"), stream, &(int){1}));
    fclose(stream);
}

CHECK_NEW(what_was_printed_can_be_read)
{
    struct mixed value = {-4, "four words in quotes", 2.25};
    struct mixed *back = NULL;
    initialise();
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string, double}");
    FILE *stream = tmpfile();
    EXPECT_OK(IPC_printData(formatter, stream, &value));
    rewind(stream);
    EXPECT_OK(IPC_readData(formatter, stream, (void **)&back));
    fclose(stream);
    EXPECT_INT(back->number, -4);
    EXPECT_TEXT(back->text, "four words in quotes");
    EXPECT(back->real > 2.24 && back->real < 2.26);
    EXPECT_OK(IPC_freeData(formatter, back));
}

CHECK_NEW(what_is_not_a_value_of_the_format_cannot_be_read)
{
    void *back = &back;
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPC_readData(NULL, stdin, &back), IPC_Not_Initialized);
    EXPECT(back == NULL);
    IPC_initialize();
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string}");
    FILE *stream = tmpfile();
    fputs("{4 \"no comma\"}\n", stream);
    rewind(stream);
    back = &back;
    EXPECT_FAILURE(IPC_readData(formatter, stream, &back), IPC_Error, IPC_Mismatched_Formatter);
    EXPECT(back == NULL);
    EXPECT_ERROR(IPC_readData(formatter, NULL, &back), IPC_Null_Argument);
    EXPECT_ERROR(IPC_readData(formatter, stream, NULL), IPC_Null_Argument);
    fclose(stream);
}

/* --------------------------------------------------------------------------- parsing */

CHECK_NEW(malformed_formats_give_an_error_and_nothing_worse)
{
    static const char *const malformed[] = {"{int",      "{int,int",   "[int]",
                                            "[int:]",    "[int:a]",    "{int,,int}",
                                            "<int:1>",   "*",          "!",
                                            "*!",        "{enum}",     "{enum :}",
                                            "{enum A,}", "@",          "{",
                                            "}",         ",",          "<",
                                            "[",         "[int:-1]",   "{int,<int>}",
                                            "  ",        "unknown",    "{int,<int:2>}",
                                            "[:3]",      "{enum A B}", "[int:99999999999]",
                                            "\xff"};
    initialise();
    for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++) {
        IPC_errno = IPC_No_Error;
        FORMATTER_PTR formatter = IPC_parseFormat(malformed[i]);
        expect(!formatter && IPC_errno == IPC_Illegal_Formatter, PLACE, "an illegal formatter",
               "another result for %s, IPC_errno %d", malformed[i], (int)IPC_errno);
    }
}

CHECK(odd_formats_that_are_accepted)
{
    static const char *const accepted[] = {
        "{}",       "[int:0]",        "{*!}",     " int ", "{ int , string }",
        "{int,*!}", "{int, <int:1>}", "{enum A}", "5"};
    initialise();
    for (size_t i = 0; i < sizeof accepted / sizeof *accepted; i++) {
        IPC_errno = IPC_No_Error;
        expect(IPC_parseFormat(accepted[i]) != NULL && IPC_errno == IPC_No_Error, PLACE,
               "a formatter", "an error for %s", accepted[i]);
    }
}

CHECK(text_after_a_format_is_accepted)
{
    static const char *const accepted[] = {"int int", "{int}}", "int,"};
    initialise();
    for (size_t i = 0; i < sizeof accepted / sizeof *accepted; i++) {
        EXPECT(IPC_parseFormat(accepted[i]) != NULL);
        EXPECT_INT(x_ipc_dataStructureSize(IPC_parseFormat(accepted[i])), 4);
    }
}

CHECK_NEW(a_malformed_format_is_shown_with_the_place_of_the_error)
{
    initialise();
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_NULL(IPC_parseFormat("{int,,int}"), IPC_Illegal_Formatter);
    const char *warning = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    const char *second = strchr(warning, '\n');
    expect(strncmp(warning, "Format Parsing Error: Expected ", 31) == 0 && second &&
               strncmp(second, "\n{int,,int}\n     ^\n", 20) == 0,
           PLACE, "three lines", "\"%s\"", warning);
}

CHECK(an_illegal_formatter_is_refused_by_every_call)
{
    int number = 1;
    void *data;
    IPC_VARCONTENT_TYPE content;
    initialise();
    FORMATTER_PTR illegal = ParseFormatString("{enum}");
    EXPECT(illegal != NULL);
    EXPECT_ERROR(IPC_marshall(illegal, &number, &content), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_unmarshall(illegal, &number, &data), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_unmarshallData(illegal, &number, &number, 4), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_freeData(illegal, &number), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_freeDataElements(illegal, &number), IPC_Illegal_Formatter);
    EXPECT_ERROR(IPC_printData(illegal, stdout, &number), IPC_Illegal_Formatter);
}

/* ------------------------------------------------------------------- formats of messages */

CHECK(formats_are_compared_by_structure)
{
    connected();
    IPC_defineMsg("d", IPC_VARIABLE_LENGTH, "double");
    IPC_defineMsg("none", IPC_VARIABLE_LENGTH, NULL);
    IPC_defineFormat("real", "double");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_checkMsgFormats("d", "double"));
    EXPECT_OK(IPC_checkMsgFormats("d", " double "));
    EXPECT_OK(IPC_checkMsgFormats("d", "real"));
    EXPECT_ERROR(IPC_checkMsgFormats("d", "{double}"), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_checkMsgFormats("d", NULL), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_checkMsgFormats("d", "{enum}"), IPC_Mismatched_Formatter);
    EXPECT_OK(IPC_checkMsgFormats("none", NULL));
    EXPECT_OK(IPC_checkMsgFormats("none", ""));
    EXPECT_ERROR(IPC_checkMsgFormats("none", "int"), IPC_Mismatched_Formatter);
    EXPECT_ERROR(IPC_checkMsgFormats("unknown", "int"), IPC_Message_Not_Defined);
}

CHECK(the_formatter_of_a_message_is_always_the_same)
{
    connected();
    define_int("m");
    IPC_defineMsg("none", IPC_VARIABLE_LENGTH, NULL);
    IPC_defineMsg("illegal", IPC_VARIABLE_LENGTH, "never_defined");
    EXPECT(IPC_msgFormatter("m") != NULL);
    EXPECT(IPC_msgFormatter("m") == IPC_msgFormatter("m"));
    EXPECT_QUIET(IPC_msgFormatter("none"), 0);
    EXPECT_NULL(IPC_msgFormatter("unknown"), IPC_Message_Not_Defined);
    EXPECT_NULL(IPC_msgFormatter("illegal"), IPC_Illegal_Formatter);
}

PLAYER(redefines_format)
{
    EXPECT_OK(IPC_defineFormat("shared", "{int, int, int}"));
    player_say(0);
    player_wait();
}

CHECK(a_format_that_another_module_has_defined_is_found)
{
    struct central *central = connected();
    module_start("redefines_format", central);
    EXPECT_INT(x_ipc_dataStructureSize(IPC_parseFormat("shared")), 12);
    EXPECT_NULL(IPC_parseFormat("Shared"), IPC_Illegal_Formatter);
}

CHECK(facts_about_formats_can_be_asked_for)
{
    struct mixed value = {1, "two", 3.5};
    initialise();
    FORMATTER_PTR mixed = IPC_parseFormat("{int, string, double}");
    FORMATTER_PTR flat = IPC_parseFormat("{int, int}");
    EXPECT_INT(x_ipc_dataStructureSize(NULL), 0);
    EXPECT_INT(x_ipc_dataStructureSize(mixed), sizeof value);
    EXPECT_INT(x_ipc_bufferSize(mixed, &value), 19);
    EXPECT_INT(formatContainsPointers(mixed), 1);
    EXPECT_INT(formatContainsPointers(flat), 0);
    EXPECT_INT(x_ipc_sameFixedSizeDataBuffer(flat), 1);
    EXPECT_INT(x_ipc_sameFixedSizeDataBuffer(mixed), 0);
}
