/*
 * The functions of ipcx.h that end waits and that tell of byte arrays.
 */
#include "check.h"

#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>

/* Declared here, weakly, because CMU IPC has neither the header nor the functions. */
__attribute__((weak)) void IPCx_setGiveUp(int (*giveUp)(void));
__attribute__((weak)) IPC_RETURN_TYPE IPCx_arrayInfo(BYTE_ARRAY byteArray, unsigned int *length,
                                                     int *isBigEndian);
typedef enum { IPCX_TEXT_BANNER, IPCX_TEXT_WARNING, IPCX_TEXT_ERROR } IPCX_TEXT;
__attribute__((weak)) void IPCx_setTextHandler(void (*handler)(IPCX_TEXT kind, const char *text));

/* ------------------------------------------------------------------- giving up */

static volatile sig_atomic_t is_enough;

static void on_alarm(int number)
{
    (void)number;
    is_enough = 1;
}

static int give_up(void)
{
    return is_enough;
}

/* From now on waits end as soon as a signal comes, which is soon. */
static void give_up_soon(void)
{
    struct sigaction action = {.sa_handler = on_alarm};
    struct itimerval soon = {{0, 0}, {0, 50000}};
    is_enough = 0;
    sigaction(SIGALRM, &action, NULL);
    IPCx_setGiveUp(give_up);
    setitimer(ITIMER_REAL, &soon, NULL);
}

static void ignore(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
}

CHECK_NEW(a_signal_ends_every_listening_call_if_the_program_wishes)
{
    BYTE_ARRAY reply = NULL;
    connected();
    define_int("query");
    IPC_subscribe("query", ignore, NULL);
    IPC_listenClear(20);
    const long start = now_ms();
    give_up_soon();
    EXPECT_TIMEOUT(IPC_listen(IPC_WAIT_FOREVER));
    give_up_soon();
    EXPECT_TIMEOUT(IPC_listenClear(IPC_WAIT_FOREVER));
    give_up_soon();
    EXPECT_TIMEOUT(IPC_listenWait(IPC_WAIT_FOREVER));
    give_up_soon();
    EXPECT_TIMEOUT(IPC_handleMessage(IPC_WAIT_FOREVER));
    give_up_soon();
    EXPECT_TIMEOUT(IPC_dispatch());
    give_up_soon();
    EXPECT_TIMEOUT(IPC_queryResponse("query", 4, "abcd", &reply, IPC_WAIT_FOREVER));
    EXPECT(now_ms() - start < 30000);
    IPCx_setGiveUp(NULL);
    EXPECT_TIMEOUT(IPC_listen(10));
}

/* Central tells all modules of each first and last subscription to a message: none of their handlers. */
PLAYER(restless)
{
    char byte;
    define_int("restless");
    player_say(0);
    while (recv(player_control(), &byte, 1, MSG_DONTWAIT) < 0) {
        IPC_subscribe("restless", ignore, NULL);
        IPC_unsubscribe("restless", ignore);
    }
    IPC_disconnect();
}

static long give_up_at;

static int give_up_in_time(void)
{
    return now_ms() >= give_up_at;
}

CHECK_NEW(a_wait_is_given_up_though_something_comes_all_the_time)
{
    BYTE_ARRAY reply = NULL;
    struct central *central = connected();
    define_int("query");
    IPC_subscribe("query", ignore, NULL);
    IPC_listenClear(20);
    module_start("restless", central);
    give_up_at = now_ms() + 500;
    IPCx_setGiveUp(give_up_in_time);
    EXPECT_TIMEOUT(IPC_queryResponse("query", 4, "abcd", &reply, IPC_WAIT_FOREVER));
    IPCx_setGiveUp(NULL);
}

static void enough(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    ignore(instance, content, client_data);
    is_enough = 1;
}

static void enough_time(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    is_enough = 1;
}

CHECK_NEW(so_does_a_handler)
{
    BYTE_ARRAY reply = NULL;
    connected();
    define_int("m");
    IPC_subscribe("m", enough, NULL);
    IPC_listenClear(20);
    IPCx_setGiveUp(give_up);
    publish_int("m", 1);
    EXPECT_OK(IPC_dispatch());
    is_enough = 0;
    publish_int("m", 1);
    EXPECT_TIMEOUT(IPC_queryResponse("m", 4, "abcd", &reply, IPC_WAIT_FOREVER));
    is_enough = 0;
    IPC_listenClear(20);
    is_enough = 0;
    IPC_addOneShotTimer(20, enough_time, NULL);
    EXPECT_TIMEOUT(IPC_listen(IPC_WAIT_FOREVER));
}

CHECK_NEW(connecting_can_be_given_up)
{
    capture();
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    const long start = now_ms();
    give_up_soon();
    EXPECT_ERROR(IPC_connectModule("check", "localhost:1"), IPC_Not_Connected);
    EXPECT(now_ms() - start < 3000);
    (void)captured_stderr();
}

/* ----------------------------------------------------------------- byte arrays */

static void ask(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    unsigned int length = 0;
    int is_big_endian = -1;
    const int one = 1;
    char first;
    memcpy(&first, &one, 1);
    EXPECT_OK(IPCx_arrayInfo(content, &length, &is_big_endian));
    EXPECT_INT(length, IPC_dataLength(instance));
    EXPECT_INT(is_big_endian, first == 0);
    *(BYTE_ARRAY *)client_data = content;
}

CHECK_NEW(the_library_tells_of_arrays_that_it_gave)
{
    char own[4] = "abc";
    BYTE_ARRAY kept = NULL;
    unsigned int length = 0;
    int is_big_endian = -1;
    connected();
    define_int("m");
    IPC_subscribe("m", ask, &kept);
    IPC_listenClear(20);
    publish_int("m", 1);
    IPC_listen(5000);
    EXPECT(kept != NULL);
    EXPECT_OK(IPCx_arrayInfo(kept, &length, &is_big_endian));
    EXPECT_INT(length, 4);
    IPC_freeByteArray(kept);
    capture();
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPCx_arrayInfo(own, &length, &is_big_endian), IPC_Argument_Out_Of_Range);
    EXPECT_ERROR(IPCx_arrayInfo(NULL, &length, &is_big_endian), IPC_Null_Argument);
    (void)captured_stderr();
}

/* ----------------------------------------------------------------------- texts */

static char texts[3][4096]; /* by their kind */

static void keep_text(IPCX_TEXT kind, const char *text)
{
    strncat(texts[kind], text, sizeof texts[kind] - strlen(texts[kind]) - 1);
}

CHECK_NEW(texts_of_the_library_go_to_the_programs_function)
{
    static char long_name[500];
    memset(long_name, 'n', sizeof long_name - 1);
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    IPCx_setTextHandler(keep_text);
    EXPECT_OK(IPC_connectModule("A", central->address));
    EXPECT_ERROR(IPC_publish(long_name, 0, NULL), IPC_Message_Not_Defined);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPC_publish("unknown", 0, NULL), IPC_Message_Not_Defined);
    IPC_setVerbosity(IPC_Print_Errors);
    IPCx_setTextHandler(NULL);
    EXPECT_ERROR(IPC_publish("later", 0, NULL), IPC_Message_Not_Defined);
    EXPECT_TEXT(captured_stderr(),
                "ERROR: x_ipc_msgFind: Query for message later returned NULL.\n\n"
                "ERROR: IPC message not defined\n");
    EXPECT_TEXT(captured_stdout(), "");
    EXPECT(strstr(texts[IPCX_TEXT_BANNER], "IPC Version") != NULL);
    EXPECT(strstr(texts[IPCX_TEXT_WARNING], "IPC Connected on port") != NULL);
    EXPECT(strstr(texts[IPCX_TEXT_ERROR], long_name) != NULL);
    EXPECT(strstr(texts[IPCX_TEXT_ERROR], "ERROR: IPC message not defined\n") != NULL);
    EXPECT(strstr(texts[IPCX_TEXT_ERROR], "unknown") == NULL);
}
