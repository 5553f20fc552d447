/*
 * What is printed at which verbosity, word for word, and when the process ends (T20 to T29; T30 is
 * that no other check may print anything).
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>

static const char *address;

static IPC_RETURN_TYPE connect_at(IPC_VERBOSITY_TYPE verbosity)
{
    IPC_setVerbosity(IPC_Silent);
    const IPC_RETURN_TYPE result = IPC_connectModule("A", address);
    IPC_setVerbosity(verbosity);
    return result;
}

CHECK(the_verbosity_is_checked_and_can_be_read)
{
    ipcVerbosity = IPC_Silent;
    EXPECT_ERROR(IPC_setVerbosity((IPC_VERBOSITY_TYPE)-1), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPC_setVerbosity((IPC_VERBOSITY_TYPE)4), IPC_Argument_Out_Of_Range);
    EXPECT_INT(ipcVerbosity, IPC_Silent);
    for (int verbosity = 0; verbosity <= 3; verbosity++) {
        EXPECT_OK(IPC_setVerbosity((IPC_VERBOSITY_TYPE)verbosity));
        EXPECT_INT(ipcVerbosity, verbosity);
    }
}

CHECK(errors_end_the_process_by_default)
{
    EXPECT_INT(ipcVerbosity, IPC_Exit_On_Errors);
    EXPECT_INT(IPC_errno, IPC_No_Error);
}

CHECK(assigning_the_verbosity_variable_has_an_effect)
{
    ipcVerbosity = IPC_Print_Errors;
    capture();
    IPC_publish(NULL, 0, NULL);
    EXPECT_TEXT(captured_stderr(), "ERROR: Argument is (unexpectedly) NULL\n");
    ipcVerbosity = IPC_Silent;
    capture();
    IPC_publish(NULL, 0, NULL);
    EXPECT_TEXT(captured_stderr(), "");
}

CHECK(perror_prints_the_text_of_every_error)
{
    capture();
    for (int error = 0; error < NUM_ERRORS; error++) {
        IPC_errno = (IPC_ERROR_TYPE)error;
        IPC_perror("p");
    }
    IPC_perror(NULL);
    IPC_perror("");
    EXPECT_INT(IPC_errno, IPC_Communication_Error);
    EXPECT_TEXT(captured_stderr(), "p: No IPC error\n"
                                   "p: Not connected to IPC central\n"
                                   "p: IPC not initialized\n"
                                   "p: IPC message not defined\n"
                                   "p: Message is not fixed length\n"
                                   "p: Fixed length of message differs from length argument\n"
                                   "p: Argument out of range\n"
                                   "p: Argument is (unexpectedly) NULL\n"
                                   "p: Illegal format string\n"
                                   "p: Format string does not match that of registered message\n"
                                   "p: Size of byte array does not match dataSize argument\n"
                                   "p: Low level communication (socket) error\n"
                                   "Low level communication (socket) error\n"
                                   "Low level communication (socket) error\n");
}

CHECK(the_texts_of_errors_are_a_table_for_programs)
{
    EXPECT_TEXT(ipcErrorStrings[IPC_No_Error], "No IPC error");
    EXPECT_TEXT(ipcErrorStrings[IPC_Not_Connected], "Not connected to IPC central");
    EXPECT_TEXT(ipcErrorStrings[IPC_Communication_Error], "Low level communication (socket) error");
}

CHECK_NEW(perror_names_a_number_that_is_no_error)
{
    IPC_errno = (IPC_ERROR_TYPE)12;
    capture();
    IPC_perror("p");
    IPC_errno = (IPC_ERROR_TYPE)-3;
    IPC_perror(NULL);
    EXPECT_TEXT(captured_stderr(), "p: Unknown IPC error 12\nUnknown IPC error -3\n");
}

/* ------------------------------------------------------------------- connecting */

static void expect_banner(const char *text)
{
    int major, minor, micro, end = 0;
    char date[32];
    (void)sscanf(text, "NMP IPC Version %d.%d.%d (%31[^)])\n%n", &major, &minor, &micro, date,
                 &end);
    expect(end > 0 && text[end] == '\0', PLACE, "one banner", "\"%s\"", text);
}

CHECK(connecting_prints_nothing_when_silent)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    capture();
    EXPECT_OK(IPC_connectModule("A", central->address));
    EXPECT_TEXT(captured_stderr(), "");
    EXPECT_TEXT(captured_stdout(), "");
}

CHECK(connecting_prints_banner_and_port_otherwise)
{
    struct central *central = central_start(NULL);
    char expected[64];
    snprintf(expected, sizeof expected, "... IPC Connected on port %d\n", central->port);
    for (int verbosity = 1; verbosity <= 3; verbosity++) {
        IPC_setVerbosity((IPC_VERBOSITY_TYPE)verbosity);
        capture();
        EXPECT_OK(IPC_connectModule("A", central->address));
        EXPECT_TEXT(captured_stderr(), expected);
        expect_banner(captured_stdout());
        IPC_setVerbosity(IPC_Silent);
        IPC_disconnect();
    }
}

/* ----------------------------------------------------------------------- errors */

static void fail_at(IPC_VERBOSITY_TYPE verbosity)
{
    connect_at(verbosity);
    if (IPC_publish(NULL, 0, NULL) != IPC_Error) {
        exit(1);
    }
    IPC_setVerbosity(IPC_Silent);
    IPC_disconnect();
}

static void fail_silently(void)
{
    fail_at(IPC_Silent);
}

static void fail_with_warnings(void)
{
    fail_at(IPC_Print_Warnings);
}

static void fail_with_errors(void)
{
    fail_at(IPC_Print_Errors);
}

static void fail_and_exit(void)
{
    fail_at(IPC_Exit_On_Errors);
}

CHECK(an_error_is_printed_from_the_third_level_on_and_ends_at_the_fourth)
{
    address = central_start(NULL)->address;
    struct {
        check_function *function;
        int status;
        const char *err;
    } table[] = {
        {fail_silently, 0, ""},
        {fail_with_warnings, 0, ""},
        {fail_with_errors, 0, "ERROR: Argument is (unexpectedly) NULL\n"},
        {fail_and_exit, 255, "ERROR: Argument is (unexpectedly) NULL\n"},
    };
    for (int i = 0; i < 4; i++) {
        const struct outcome outcome = run_apart(table[i].function);
        EXPECT_INT(outcome.status, table[i].status);
        EXPECT_TEXT(outcome.err, table[i].err);
        EXPECT_TEXT(outcome.out, "");
    }
}

CHECK(a_fresh_library_never_ends_the_process)
{
    capture();
    EXPECT_ERROR(IPC_publish("m", 0, NULL), IPC_Not_Connected);
    EXPECT_TEXT(captured_stderr(), "ERROR: Not connected to IPC central\n");
    IPC_setVerbosity(IPC_Silent);
}

static void fail_when_initialised(void)
{
    IPC_initialize();
    IPC_publish("m", 0, NULL);
}

CHECK(an_initialised_library_ends_the_process)
{
    const struct outcome outcome = run_apart(fail_when_initialised);
    EXPECT_INT(outcome.status, 255);
    EXPECT_TEXT(outcome.err, "ERROR: Not connected to IPC central\n");
}

static void on_disconnect(const char *module, void *client_data)
{
    (void)client_data;
    record("%s gone ", module);
}

static void say_at_exit(void)
{
    player_say(42);
}

PLAYER(ends_by_an_error)
{
    atexit(say_at_exit);
    player_say(0);
    player_wait();
    IPC_setVerbosity(IPC_Exit_On_Errors);
    fclose(stderr);
    IPC_publish(NULL, 0, NULL);
    player_say(7);
}

CHECK(a_module_that_ends_by_an_error_disconnects_and_runs_exit_functions)
{
    struct central *central = connected();
    EXPECT_OK(IPC_subscribeDisconnect(on_disconnect, NULL));
    settle();
    struct module *module = module_start("ends_by_an_error", central);
    module_tell(module, 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "ends_by_an_error gone ");
    EXPECT_INT(module_hear(module), 42);
    EXPECT_INT(module_end(module), 255);
}

/* -------------------------------------------------------------------- publishing */

CHECK(publishing_an_unknown_message_ends_with_the_text_of_the_error)
{
    struct central *central = central_start(NULL);
    address = central->address;
    connect_at(IPC_Silent);
    capture();
    EXPECT_ERROR(IPC_publish("unknown", 0, NULL), IPC_Message_Not_Defined);
    IPC_setVerbosity(IPC_Print_Warnings);
    EXPECT_ERROR(IPC_publish("unknown", 0, NULL), IPC_Message_Not_Defined);
    EXPECT_TEXT(captured_stderr(), "");
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_ERROR(IPC_publish("unknown", 0, NULL), IPC_Message_Not_Defined);
    EXPECT_TEXT(captured_stderr(),
                "ERROR: x_ipc_msgFind: Query for message unknown returned NULL.\n\n"
                "ERROR: IPC message not defined\n");
    IPC_setVerbosity(IPC_Silent);
}

CHECK(a_wrong_length_of_a_fixed_message_is_warned_of)
{
    connected();
    int number = 0;
    IPC_defineMsg("fixed", sizeof number, "int");
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_ERROR(IPC_publish("fixed", 5, &number), IPC_Message_Lengths_Differ);
    EXPECT_TEXT(captured_stderr(), "Illegal length argument 5 for fixed-length message fixed\n");
    IPC_setVerbosity(IPC_Silent);
}
