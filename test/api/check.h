/*
 * Checks of the API: small programs that use the library and say what they found.
 *
 * A program holds many checks; each runs in a process of its own, which is how it gets a library in
 * state fresh.  A check starts the centrals it needs, and other modules as players: functions of
 * the same program that run in processes of their own.  It goes on after a failed expectation, and
 * has passed when there was none and when all its centrals are still alive.  What a check or the
 * library prints outside capture() counts as a failure.
 *
 * test_api.py runs the programs; it finds the checks by the lines that begin with CHECK.
 */
#ifndef IPC_TEST_CHECK_H
#define IPC_TEST_CHECK_H

#include <ipc.h>

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef void check_function(void);

void check_register(const char *name, check_function *function);

/* CHECK(what_is_asserted) { ... } */
#define CHECK(name)                                                                                \
    static void name(void);                                                                        \
    __attribute__((constructor)) static void register_##name(void)                                 \
    {                                                                                              \
        check_register(#name, name);                                                               \
    }                                                                                              \
    static void name(void)

/* A check of what CMU IPC does not do, or does differently; skipped when it is under test. */
#define CHECK_NEW(name) CHECK(name)

/* The part of another module in a check. */
#define PLAYER(name) CHECK(name)

/* ------------------------------------------------------------- expectations */

bool expect(bool holds, const char *place, const char *expectation, const char *format, ...);
void expect_text(const char *text, const char *expected, const char *place, const char *what);
void expect_result(intptr_t result, intptr_t expected, int error, const char *place,
                   const char *what);

#define CHECK_TEXT_(x) #x
#define CHECK_TEXT(x) CHECK_TEXT_(x)
#define PLACE __FILE__ ":" CHECK_TEXT(__LINE__)

/* For what has turned out not to be so. */
#define EXPECT_THAT(text) expect(false, PLACE, text, "something else")
#define EXPECT(condition) expect((condition), PLACE, #condition, "false")
#define EXPECT_INT(expression, value)                                                              \
    expect_result((intptr_t)(expression), (value), -1, PLACE, #expression)
#define EXPECT_TEXT(expression, value) expect_text((expression), (value), PLACE, #expression)
#define EXPECT_OK(expression) EXPECT_INT(expression, IPC_OK)
#define EXPECT_TIMEOUT(expression) EXPECT_INT(expression, IPC_Timeout)

/* The call gives that result and sets IPC_errno to that value. */
#define EXPECT_FAILURE(expression, result, error)                                                  \
    do {                                                                                           \
        IPC_errno = IPC_No_Error;                                                                  \
        expect_result((intptr_t)(expression), (intptr_t)(result), (int)(error), PLACE,             \
                      #expression);                                                                \
    } while (0)
#define EXPECT_ERROR(expression, error) EXPECT_FAILURE(expression, IPC_Error, error)
#define EXPECT_NULL(expression, error) EXPECT_FAILURE(expression, 0, error)

/* The call gives that result and leaves IPC_errno alone. */
#define EXPECT_QUIET(expression, result) EXPECT_FAILURE(expression, result, IPC_No_Error)

/* ------------------------------------------------------------------ centrals */

struct central {
    pid_t pid; /* 0: ended by the check */
    int port;
    char address[64];
};

/* A central on a port of its own; option (may be NULL) is added to its command line. */
struct central *central_start(const char *option);
/* A central on that port, which nobody uses. */
struct central *central_start_on(int port, const char *option);
void central_kill(struct central *central);
void central_stop(struct central *central);
void central_continue(struct central *central);
int free_port(void);

/* A central and a silent connection to it under the name "A". */
struct central *connected(void);

/* Whether the library under test is CMU IPC. */
bool is_original(void);
/* What this module has published, at the first central, has come back to it and waits unread. */
void let_arrive(void);
/* Lets an original notice who subscribes to what, which it does while it listens. */
void settle(void);

/* ------------------------------------------------------------- other modules */

struct module {
    pid_t pid;
    int control;
};

/* Starts a player, connected to central under its name if central is not NULL, and waits until it
 * says player_ready(). */
struct module *module_start(const char *player, const struct central *central);
/* Lets player_wait() return, or its control handler be called, with that number. */
void module_tell(struct module *module, int number);
/* The number of the player's next player_say(). */
int module_hear(struct module *module);
/* Waits until the player has ended; returns its exit status, or minus the signal. */
int module_end(struct module *module);
void module_kill(struct module *module);

void player_say(int number);
/* What module_tell() says, -1 when the check has ended. */
int player_wait(void);
int player_control(void);
const char *player_address(void);
/* Tells the check that the player is ready, and listens until it has ended. */
void player_serve(void);

/* ------------------------------------------------------- output and processes */

/* From here on what is written to the two streams is collected. */
void capture(void);
/* Ends capture() and gives what came; the texts are valid until the next capture(). */
const char *captured_stderr(void);
const char *captured_stdout(void);

struct outcome {
    int status; /* exit status, or minus the signal */
    char out[4096];
    char err[4096];
};

/* Runs a function in a copy of this process, which has not used the library yet. */
struct outcome run_apart(check_function *function);
/* Two parts of run_apart(), to run several at once. */
struct apart {
    pid_t pid;
    FILE *out;
    FILE *err;
};
struct apart apart_start(check_function *function);
struct outcome apart_end(struct apart *apart);

/* ------------------------------------------------------------------ helpers */

/* Adds to what recorded() gives; one record counts as one event. */
void record(const char *format, ...);
/* What has been recorded since the last call. */
const char *recorded(void);
int n_recorded(void);

/* Listens until that many records have been made since recorded() was called, at most five seconds.
 */
void listen_until(int count);
/* Listens so long, whatever comes. */
void listen_for(unsigned int milliseconds);

/* Handlers for messages whose content is an int; they record client data as text, then the number.
 */
void note_a(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data);
void note_b(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data);
void note_c(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data);

IPC_RETURN_TYPE define_int(const char *message);
IPC_RETURN_TYPE publish_int(const char *message, int number);

long now_ms(void);
void sleep_ms(long milliseconds);

/* ------------------------------------- symbols that programs declare by hand */

extern IPC_VERBOSITY_TYPE ipcVerbosity;
extern const char *ipcErrorStrings[NUM_ERRORS];
void x_ipcRegisterExitProc(void (*procedure)(void));
fd_set *x_ipcGetConnections(void);
int x_ipcGetMaxConnection(void);
int x_ipcGetServer(void);
unsigned long x_ipc_timeInMsecs(void);
void x_ipcCloseInternal(int informServer);
void x_ipcClose(void);
void *x_ipcMalloc(size_t size);
void x_ipcFree(void *block);
IPC_RETURN_TYPE _IPC_subscribe(const char *msgName, const char *hndName, HANDLER_TYPE handler,
                               void *clientData, int autoUnmarshall);
IPC_RETURN_TYPE _IPC_unsubscribe(const char *msgName, const char *hndName);
IPC_RETURN_TYPE _IPC_queryResponse(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                   BYTE_ARRAY *replyHandle, FORMATTER_PTR *replyFormatter,
                                   unsigned int timeoutMsecs);
IPC_RETURN_TYPE _IPC_connect(const char *taskName, const char *serverName, int willListen,
                             int isLispModule);
IPC_RETURN_TYPE _IPC_initialize(int isLispModule);
void ipcSetError(IPC_ERROR_TYPE error);
unsigned int maxTriggers(TIMER_REF timerRef);
FORMATTER_PTR ParseFormatString(const char *formatString);
int x_ipc_dataStructureSize(FORMATTER_PTR formatter);
int x_ipc_bufferSize(FORMATTER_PTR formatter, const void *data);
int x_ipc_sameFixedSizeDataBuffer(FORMATTER_PTR formatter);
int formatContainsPointers(FORMATTER_PTR formatter);

#endif
