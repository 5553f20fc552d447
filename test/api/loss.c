/*
 * The loss of central, and exit procedures (T176 to T184).
 */
#include "check.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct central *central;
static IPC_VERBOSITY_TYPE verbosity;
static char loss_text[160];

static void start(void)
{
    central = central_start(NULL);
    snprintf(loss_text, sizeof loss_text, "Closed Connection Detected from: Central Server %s\n\n",
             central->address);
}

static void join(void)
{
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", central->address));
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    IPC_listenClear(20);
}

/* Central ends a little later, by the hand of another process. */
static void end_central_soon(void)
{
    if (fork() == 0) {
        sleep_ms(200);
        kill(central->pid, SIGKILL);
        _exit(0);
    }
}

static void forget_central(void)
{
    waitpid(central->pid, NULL, 0);
    central->pid = 0;
}

/* ----------------------------------------------------------------- without an exit procedure */

static void wait_by_listen(void)
{
    IPC_listen(5000);
}

static void wait_by_listen_clear(void)
{
    IPC_listenClear(5000);
}

static void wait_by_listen_wait(void)
{
    IPC_listenWait(5000);
}

static void wait_by_handle_message(void)
{
    IPC_handleMessage(5000);
}

static void wait_by_dispatch(void)
{
    IPC_dispatch();
}

static void wait_by_query(void)
{
    int number = 1;
    void *reply;
    define_int("unheard");
    IPC_queryResponse("unheard", sizeof number, &number, &reply, 5000);
}

/* Central is stopped, so that the question is not answered before it ends. */
static void wait_by_round_trip(void)
{
    kill(central->pid, SIGSTOP);
    IPC_isModuleConnected("B");
}

static check_function *const waits[] = {
    wait_by_listen,   wait_by_listen_clear, wait_by_listen_wait, wait_by_handle_message,
    wait_by_dispatch, wait_by_query,        wait_by_round_trip};
static check_function *chosen;

static void lose_central(void)
{
    join();
    IPC_setVerbosity(verbosity);
    end_central_soon();
    chosen();
}

static void expect_end_of_process(check_function *wait)
{
    chosen = wait;
    for (int level = 0; level <= 3; level++) {
        start();
        verbosity = (IPC_VERBOSITY_TYPE)level;
        const struct outcome outcome = run_apart(lose_central);
        forget_central();
        EXPECT_INT(outcome.status, 255);
        if (!is_original() || wait != wait_by_round_trip) { /* where it says more */
            EXPECT_TEXT(outcome.err, level >= IPC_Print_Errors ? loss_text : "");
        }
        EXPECT_TEXT(outcome.out, "");
    }
}

CHECK(losing_central_in_listen_ends_the_process)
{
    expect_end_of_process(waits[0]);
}

CHECK(losing_central_in_listen_clear_ends_the_process)
{
    expect_end_of_process(waits[1]);
}

CHECK(losing_central_in_listen_wait_ends_the_process)
{
    expect_end_of_process(waits[2]);
}

CHECK(losing_central_in_handle_message_ends_the_process)
{
    expect_end_of_process(waits[3]);
}

CHECK(losing_central_in_dispatch_ends_the_process)
{
    expect_end_of_process(waits[4]);
}

CHECK(losing_central_in_a_query_ends_the_process)
{
    expect_end_of_process(waits[5]);
}

CHECK(losing_central_in_a_round_trip_ends_the_process)
{
    expect_end_of_process(waits[6]);
}

/* ------------------------------------------------------------------- with an exit procedure */

static IPC_CONTEXT_PTR own_context;
static int n_calls;

static void count_loss(void)
{
    n_calls++;
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT(IPC_getContext() == own_context);
}

static void join_with_procedure(void (*procedure)(void))
{
    start();
    join();
    own_context = IPC_getContext();
    x_ipcRegisterExitProc(procedure);
}

static void expect_one_loss(IPC_VERBOSITY_TYPE level)
{
    join_with_procedure(count_loss);
    IPC_setVerbosity(level);
    capture();
    end_central_soon();
    const IPC_RETURN_TYPE result = IPC_listen(5000);
    const char *text = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(result, IPC_OK);
    EXPECT_TEXT(text, level >= IPC_Print_Errors ? loss_text : "");
    EXPECT_INT(n_calls, 1);
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    EXPECT_INT(n_calls, 1);
    forget_central();
}

CHECK(an_exit_procedure_takes_the_place_of_the_exit)
{
    expect_one_loss(IPC_Silent);
}

CHECK(an_exit_procedure_is_called_once_after_the_text)
{
    expect_one_loss(IPC_Print_Errors);
}

CHECK_NEW(an_exit_procedure_is_called_once_where_errors_end_the_process)
{
    expect_one_loss(IPC_Exit_On_Errors);
}

CHECK_NEW(without_a_connection_there_is_no_context_after_the_exit_procedure)
{
    join_with_procedure(count_loss);
    central_kill(central);
    EXPECT_OK(IPC_listen(5000));
    EXPECT(IPC_getContext() == NULL);
}

CHECK_NEW(a_round_trip_fails_when_the_exit_procedure_returns)
{
    join_with_procedure(count_loss);
    end_central_soon();
    central_stop(central);
    EXPECT_FAILURE(IPC_isModuleConnected("B"), -1, IPC_Not_Connected);
    EXPECT_INT(n_calls, 1);
    forget_central();
}

CHECK_NEW(a_query_fails_when_the_exit_procedure_returns)
{
    int number = 1;
    void *reply = &number;
    join_with_procedure(count_loss);
    define_int("unheard");
    end_central_soon();
    EXPECT_ERROR(IPC_queryResponse("unheard", sizeof number, &number, &reply, 5000),
                 IPC_Not_Connected);
    EXPECT(reply == NULL);
    EXPECT_INT(n_calls, 1);
    forget_central();
}

static void count_call(void)
{
    n_calls++;
}

CHECK(an_error_closes_the_connection_before_the_exit_procedure)
{
    start();
    join();
    x_ipcRegisterExitProc(count_call);
    IPC_setVerbosity(IPC_Exit_On_Errors);
    capture();
    const IPC_RETURN_TYPE result = IPC_publish(NULL, 0, NULL);
    EXPECT_TEXT(captured_stderr(), "ERROR: Argument is (unexpectedly) NULL\n");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(result, IPC_Error);
    EXPECT_INT(n_calls, 1);
    EXPECT_INT(IPC_isConnected(), 0);
}

static void fail_in_procedure(void)
{
    n_calls++;
    EXPECT_ERROR(IPC_publish(NULL, 0, NULL), IPC_Null_Argument);
}

CHECK_NEW(an_exit_procedure_is_never_called_inside_itself)
{
    start();
    join();
    x_ipcRegisterExitProc(fail_in_procedure);
    IPC_setVerbosity(IPC_Exit_On_Errors);
    capture();
    EXPECT_INT(IPC_publish(NULL, 0, NULL), IPC_Error);
    EXPECT_TEXT(captured_stderr(), "ERROR: Argument is (unexpectedly) NULL\n"
                                   "ERROR: Argument is (unexpectedly) NULL\n");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(n_calls, 1);
}

static void fail_after_beginning_anew(void)
{
    join();
    x_ipcRegisterExitProc(count_call);
    IPC_disconnect();
    join();
    IPC_setVerbosity(IPC_Exit_On_Errors);
    IPC_publish(NULL, 0, NULL);
}

CHECK(a_new_initialisation_forgets_the_exit_procedure)
{
    start();
    EXPECT_INT(run_apart(fail_after_beginning_anew).status, 255);
}

/* ------------------------------------------------------------------------------ reconnecting */

static int port; /* of all centrals */

static void reconnect(void)
{
    n_calls++;
    IPC_disconnect();
    while (IPC_connectModule("A", central->address) != IPC_OK) {
    }
    EXPECT_OK(define_int("m"));
    EXPECT_OK(IPC_subscribe("m", note_a, "again"));
    x_ipcRegisterExitProc(reconnect);
}

/* Central is killed, and a new one is there at once. */
static struct central *replace_central(void)
{
    central_kill(central);
    return central_start_on(port, NULL);
}

static void expect_messages(int number)
{
    char expected[32];
    recorded();
    EXPECT_OK(publish_int("m", number));
    listen_until(1);
    snprintf(expected, sizeof expected, "again%d ", number);
    EXPECT_TEXT(recorded(), expected);
}

CHECK_NEW(an_exit_procedure_may_reconnect_again_and_again)
{
    join_with_procedure(reconnect);
    port = central->port;
    for (int i = 1; i <= 3; i++) {
        central = replace_central();
        EXPECT_OK(IPC_listen(5000));
        EXPECT_INT(n_calls, i);
        EXPECT_INT(IPC_isConnected(), 1);
        expect_messages(i);
    }
}

static void *start_central_later(void *argument)
{
    (void)argument;
    sleep_ms(2000);
    central_start_on(port, NULL);
    return NULL;
}

CHECK_NEW(an_exit_procedure_may_wait_until_central_is_there_again)
{
    pthread_t thread;
    join_with_procedure(reconnect);
    port = central->port;
    central_kill(central);
    const long start_of_loss = now_ms();
    EXPECT_INT(pthread_create(&thread, NULL, start_central_later, NULL), 0);
    EXPECT_OK(IPC_listen(5000));
    EXPECT(now_ms() - start_of_loss >= 1900);
    pthread_join(thread, NULL);
    EXPECT_INT(n_calls, 1);
    expect_messages(1);
}

static void lose_in_handler(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    record("handler ");
    central = replace_central();
    EXPECT_OK(IPC_listen(5000));
    EXPECT_INT(IPC_isConnected(), 1);
    IPC_freeByteArray(content);
}

CHECK_NEW(an_exit_procedure_may_reconnect_inside_a_handler)
{
    join_with_procedure(reconnect);
    port = central->port;
    define_int("outer");
    IPC_subscribe("outer", lose_in_handler, NULL);
    publish_int("outer", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "handler ");
    EXPECT_INT(n_calls, 1);
    expect_messages(5);
}

CHECK_NEW(a_round_trip_after_the_loss_fails_and_the_next_call_finds_the_new_connection)
{
    join_with_procedure(reconnect);
    port = central->port;
    central = replace_central();
    EXPECT_INT(IPC_isModuleConnected("A"), -1);
    EXPECT_INT(n_calls, 1);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    expect_messages(1);
}

CHECK_NEW(a_loss_in_one_of_two_contexts_leaves_the_other_alone)
{
    struct central *other = central_start(NULL);
    join_with_procedure(count_loss);
    EXPECT_OK(IPC_connectModule("B", other->address));
    IPC_CONTEXT_PTR second = IPC_getContext();
    define_int("m");
    IPC_subscribe("m", note_b, "other");
    central_kill(central);
    EXPECT_OK(IPC_listen(5000));
    EXPECT_INT(n_calls, 1);
    EXPECT(IPC_getContext() == second);
    EXPECT_INT(IPC_isConnected(), 1);
    publish_int("m", 4);
    listen_until(1);
    EXPECT_TEXT(recorded(), "other4 ");
}

/* ------------------------------------------------------------------------------------ writing */

CHECK_NEW(a_write_that_fails_marks_the_connection_as_lost)
{
    int n_ok = 0;
    join_with_procedure(count_call);
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    central_kill(central);
    IPC_errno = IPC_No_Error;
    while (n_ok < 100 && publish_int("m", 1) == IPC_OK) {
        n_ok++;
        sleep_ms(5);
    }
    EXPECT(n_ok < 100);
    EXPECT(IPC_errno == IPC_Communication_Error || IPC_errno == IPC_Not_Connected);
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_ERROR(publish_int("m", 2), IPC_Not_Connected);
    IPC_listen(0);
    EXPECT_INT(n_calls, 1);
    EXPECT_ERROR(IPC_listen(0), IPC_Not_Connected);
    EXPECT_INT(n_calls, 1);
}

CHECK_NEW(notices_that_cannot_be_sent_are_errors)
{
    join_with_procedure(count_call);
    central_kill(central);
    sleep_ms(50);
    int n_ok = 0;
    while (n_ok < 100 && IPC_setCapacity(n_ok + 1) == IPC_OK) {
        n_ok++;
        sleep_ms(5);
    }
    EXPECT(n_ok < 100);
    EXPECT_INT(IPC_isConnected(), 0);
}

CHECK_NEW(disconnecting_after_the_loss_succeeds_silently)
{
    start();
    join();
    central_kill(central);
    IPC_setVerbosity(IPC_Exit_On_Errors);
    capture();
    EXPECT_OK(IPC_disconnect());
    EXPECT_TEXT(captured_stderr(), "");
    EXPECT_TEXT(captured_stdout(), "");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(IPC_isConnected(), 0);
}

static volatile sig_atomic_t n_signals;

static void count_signal(int number)
{
    (void)number;
    n_signals++;
}

static void expect_no_signal(void (*disposition)(int))
{
    struct sigaction action = {.sa_handler = disposition};
    struct sigaction found;
    sigaction(SIGPIPE, &action, NULL);
    join_with_procedure(count_call);
    central_kill(central);
    capture();
    for (int i = 0; i < 5; i++) {
        publish_int("m", i);
        sleep_ms(5);
    }
    EXPECT_TEXT(captured_stderr(), "");
    sigaction(SIGPIPE, NULL, &found);
    EXPECT(found.sa_handler == disposition);
    EXPECT_INT(n_signals, 0);
}

CHECK_NEW(an_ignored_signal_stays_ignored)
{
    expect_no_signal(SIG_IGN);
}

CHECK_NEW(an_own_signal_handler_stays_and_is_not_called)
{
    expect_no_signal(count_signal);
}

CHECK_NEW(the_default_of_the_signal_does_not_end_the_process)
{
    expect_no_signal(SIG_DFL);
}
