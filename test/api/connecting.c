/*
 * Connecting and disconnecting (T31 to T48).
 */
#include "check.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <netinet/in.h>
#include <arpa/inet.h>
#include <unistd.h>

/* CMU IPC has neither the header nor the function. */
__attribute__((weak)) IPC_RETURN_TYPE IPCx_tryConnect(const char *taskName, const char *serverName);

enum { TRIES = 5 };

static const char *server;

/* Puts that many trials of function in front of each line's text. */
static void repeat(char *text, size_t size, const char *line, int times)
{
    text[0] = '\0';
    for (int i = 0; i < times; i++) {
        strncat(text, line, size - strlen(text) - 1);
    }
}

static bool is_banner(const char *text, size_t *length)
{
    const char *end = strchr(text, '\n');
    *length = end ? (size_t)(end - text) + 1 : 0;
    return end && strncmp(text, "NMP IPC Version ", 16) == 0;
}

/* ---------------------------------------------------------------- no server there */

static void connect_at(IPC_VERBOSITY_TYPE verbosity)
{
    IPC_setVerbosity(verbosity);
    EXPECT_ERROR(IPC_connectModule("x", server), IPC_Not_Connected);
    EXPECT_INT(IPC_isConnected(), 0);
    IPC_setVerbosity(IPC_Silent);
}

static void connect_silently(void)
{
    connect_at(IPC_Silent);
}

static void connect_with_warnings(void)
{
    connect_at(IPC_Print_Warnings);
}

static void connect_with_errors(void)
{
    connect_at(IPC_Print_Errors);
}

static void connect_or_exit(void)
{
    connect_at(IPC_Exit_On_Errors);
}

CHECK(without_a_server_connecting_fails_after_five_tries)
{
    check_function *const functions[] = {connect_silently, connect_with_warnings,
                                         connect_with_errors, connect_or_exit};
    const char *const errors[] = {"", "", "ERROR: Not connected to IPC central\n",
                                  "ERROR: Not connected to IPC central\n"};
    const int statuses[] = {0, 0, 0, 255};
    char address[64];
    char line[160];
    char lines[800];
    struct apart apart[4];
    snprintf(address, sizeof address, "localhost:%d", free_port());
    server = address;
    snprintf(line, sizeof line, "  Trying again x to connect with the central server on %s\n",
             server);
    repeat(lines, sizeof lines, line, TRIES - 1);
    const long start = now_ms();
    for (int i = 0; i < 4; i++) {
        apart[i] = apart_start(functions[i]);
    }
    for (int i = 0; i < 4; i++) {
        const struct outcome outcome = apart_end(&apart[i]);
        size_t banner = 0;
        EXPECT_INT(outcome.status, statuses[i]);
        EXPECT_TEXT(outcome.err, errors[i]);
        EXPECT_INT(is_banner(outcome.out, &banner), i > 0);
        EXPECT_TEXT(outcome.out + banner, i > 0 ? lines : "");
    }
    EXPECT(now_ms() - start >= 4900);
}

static void connect_by_default(IPC_VERBOSITY_TYPE verbosity)
{
    unsetenv("CENTRALHOST");
    IPC_setVerbosity(verbosity);
    EXPECT_ERROR(IPC_connect("x"), IPC_Not_Connected);
    IPC_setVerbosity(IPC_Silent);
}

static void connect_by_default_with_errors(void)
{
    connect_by_default(IPC_Print_Errors);
}

static void connect_by_default_or_exit(void)
{
    connect_by_default(IPC_Exit_On_Errors);
}

/* Whether nobody has the port that is used when none is given. */
static bool is_default_port_free(void)
{
    struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons(1381), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    const bool is_free = connect(fd, (struct sockaddr *)&address, sizeof address) != 0 &&
                         access("/tmp/x_ipc/1381", F_OK) != 0;
    close(fd);
    return is_free;
}

CHECK(without_a_server_name_the_local_host_is_tried_and_every_failure_told)
{
    if (!is_default_port_free()) {
        return; /* somebody's central is there, and is left alone */
    }
    char host[64];
    char line[256];
    char lines[1400] = "Warning: CENTRALHOST environment variable not set.\n";
    gethostname(host, sizeof host);
    struct apart lasting = apart_start(connect_by_default_with_errors);
    const long start = now_ms();
    struct outcome outcome = run_apart(connect_by_default_or_exit);
    EXPECT_INT(outcome.status, 255);
    EXPECT(now_ms() - start < 4000);
    snprintf(line, sizeof line,
             "Warning: trying to connect to local host %s.\n"
             "ERROR: Can not connect to the server on %s.\n",
             host, host);
    const size_t first = strlen(lines);
    strcat(lines, line);
    EXPECT_TEXT(outcome.err, lines);
    repeat(lines + first, sizeof lines - first - 40, line, TRIES);
    strcat(lines, "ERROR: Not connected to IPC central\n");
    outcome = apart_end(&lasting);
    EXPECT_INT(outcome.status, 0);
    EXPECT_TEXT(outcome.err, lines);
}

static int late_port;

static void connect_to_late_server(void)
{
    IPC_setVerbosity(IPC_Silent);
    const long start = now_ms();
    EXPECT_OK(IPC_connectModule("x", server));
    EXPECT(now_ms() - start >= 1500);
}

CHECK(a_server_that_comes_up_during_the_tries_is_found)
{
    char address[64];
    late_port = free_port();
    snprintf(address, sizeof address, "localhost:%d", late_port);
    server = address;
    struct apart apart = apart_start(connect_to_late_server);
    sleep_ms(2000);
    central_start_on(late_port, NULL);
    EXPECT_INT(apart_end(&apart).status, 0);
}

CHECK_NEW(a_host_name_beyond_all_limits_fails_as_an_unknown_host)
{
    static char name[400];
    memset(name, 'h', 300);
    strcpy(name + 300, ":1381");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPC_connectModule("x", name), IPC_Not_Connected);
}

/* --------------------------------------------------------- if a server is there */

static void try_before_there_is_a_server(void)
{
    IPC_setVerbosity(IPC_Print_Errors);
    IPC_errno = IPC_No_Error;
    EXPECT_INT(IPCx_tryConnect("x", server), IPC_Timeout);
    EXPECT_INT(IPC_errno, IPC_No_Error);
    EXPECT_INT(IPC_isConnected(), 0);
}

CHECK_NEW(connecting_is_tried_once_without_a_word_where_nobody_listens)
{
    char address[64];
    snprintf(address, sizeof address, "localhost:%d", free_port());
    server = address;
    const struct outcome outcome = run_apart(try_before_there_is_a_server);
    EXPECT_INT(outcome.status, 0);
    EXPECT_TEXT(outcome.out, "");
    EXPECT_TEXT(outcome.err, "");
}

static void try_when_there_is_one(void)
{
    setenv("CENTRALHOST", server, 1);
    IPC_setVerbosity(IPC_Print_Errors);
    EXPECT_OK(IPCx_tryConnect("x", NULL));
    EXPECT_INT(IPC_isModuleConnected("x"), 1);
    const IPC_CONTEXT_PTR context = IPC_getContext();
    EXPECT_OK(IPCx_tryConnect("x", server));
    EXPECT(IPC_getContext() == context);
    EXPECT_ERROR(IPCx_tryConnect("", server), IPC_Null_Argument);
    EXPECT_ERROR(IPCx_tryConnect("x", " no host"), IPC_Not_Connected);
    EXPECT_INT(IPC_isConnected(), 1);
}

CHECK_NEW(connecting_succeeds_at_once_where_a_server_is)
{
    size_t banner = 0;
    char errors[200];
    struct central *central = central_start(NULL);
    server = central->address;
    snprintf(errors, sizeof errors,
             "... IPC Connected on port %d\n"
             "ERROR: Argument is (unexpectedly) NULL\n"
             "ERROR: Not connected to IPC central\n",
             central->port);
    const struct outcome outcome = run_apart(try_when_there_is_one);
    EXPECT_INT(outcome.status, 0);
    EXPECT(is_banner(outcome.out, &banner));
    EXPECT_TEXT(outcome.out + banner, "");
    EXPECT_TEXT(outcome.err, errors);
}

/* ------------------------------------------------------------------ odd servers */

/* A server in a process of its own: accepts connections and does something with each. */
static pid_t odd_server(const char *greeting, bool stay, char *address, size_t size)
{
    struct sockaddr_in bound = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof bound;
    const int listener = socket(AF_INET, SOCK_STREAM, 0);
    EXPECT_INT(bind(listener, (struct sockaddr *)&bound, length), 0);
    EXPECT_INT(listen(listener, 8), 0);
    getsockname(listener, (struct sockaddr *)&bound, &length);
    snprintf(address, size, "localhost:%d", ntohs(bound.sin_port));
    const pid_t pid = fork();
    while (pid == 0) {
        const int fd = accept(listener, NULL, NULL);
        (void)!write(fd, greeting, strlen(greeting));
        if (!stay) {
            close(fd);
        }
    }
    close(listener);
    return pid;
}

static void odd_server_end(pid_t pid)
{
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
}

CHECK(a_server_that_closes_at_once_is_told_for_each_try)
{
    char address[64];
    char lines[1000];
    const pid_t pid = odd_server("", false, address, sizeof address);
    server = address;
    struct apart lasting = apart_start(connect_with_errors);
    const struct outcome first = run_apart(connect_or_exit);
    EXPECT_INT(first.status, 255);
    EXPECT_TEXT(first.err,
                "ERROR: Socket connection broken or access denied to central server\n\n");
    const struct outcome outcome = apart_end(&lasting);
    repeat(lines, sizeof lines - 40,
           "ERROR: Socket connection broken or access denied to central server\n\n"
           "ERROR: ConnectModule Query failed.\n",
           TRIES);
    strcat(lines, "ERROR: Not connected to IPC central\n");
    EXPECT_INT(outcome.status, 0);
    EXPECT_TEXT(outcome.err, lines);
    odd_server_end(pid);
}

CHECK_NEW(a_server_that_never_answers_is_given_up)
{
    char address[64];
    const pid_t pid = odd_server("", true, address, sizeof address);
    server = address;
    connect_silently();
    odd_server_end(pid);
}

CHECK_NEW(who_listens_and_is_no_server_is_no_server_to_wait_for)
{
    char address[64];
    const pid_t pid = odd_server("", false, address, sizeof address);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPCx_tryConnect("x", address), IPC_Not_Connected);
    odd_server_end(pid);
}

CHECK_NEW(a_server_of_another_protocol_is_no_server)
{
    char address[64];
    const pid_t pid = odd_server("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n", true,
                                 address, sizeof address);
    server = address;
    connect_silently();
    odd_server_end(pid);
}

/* -------------------------------------------------------------------- connected */

CHECK(connecting_again_to_the_same_server_changes_nothing)
{
    struct central *central = connected();
    char expected[200];
    snprintf(expected, sizeof expected,
             "x_ipcConnectModule: already connected to %s\n... IPC Connected on port %d\n",
             central->address, central->port);
    IPC_CONTEXT_PTR context = IPC_getContext();
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    EXPECT_OK(IPC_connectModule("other", central->address));
    EXPECT_TEXT(captured_stderr(), expected);
    IPC_setVerbosity(IPC_Silent);
    EXPECT(IPC_getContext() == context);
    EXPECT_INT(IPC_isModuleConnected("other"), 0);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

CHECK(an_empty_server_name_means_the_environment)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    setenv("CENTRALHOST", central->address, 1);
    EXPECT_OK(IPC_connectModule("A", ""));
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModuleNoListen("B", NULL));
    IPC_disconnect();
    EXPECT_OK(IPC_connect("C"));
    IPC_disconnect();
    EXPECT_OK(IPC_connectNoListen("D"));
}

CHECK_NEW(the_environment_is_asked_for_even_after_an_explicit_server)
{
    struct central *first = connected();
    struct central *second = central_start(NULL);
    setenv("CENTRALHOST", second->address, 1);
    IPC_CONTEXT_PTR context = IPC_getContext();
    EXPECT_OK(IPC_connect("B"));
    EXPECT(IPC_getContext() != context);
    EXPECT(first->port != second->port);
}

CHECK(the_own_host_name_is_reached_by_unix_socket)
{
    struct central *central = central_start(NULL);
    struct sockaddr_storage peer;
    socklen_t length = sizeof peer;
    char host[128];
    char address[160];
    gethostname(host, sizeof host);
    snprintf(address, sizeof address, "%s:%d", host, central->port);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", address));
    EXPECT_INT(getpeername(x_ipcGetServer(), (struct sockaddr *)&peer, &length), 0);
    EXPECT_INT(peer.ss_family, AF_UNIX);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("A", central->address));
    length = sizeof peer;
    EXPECT_INT(getpeername(x_ipcGetServer(), (struct sockaddr *)&peer, &length), 0);
    EXPECT_INT(peer.ss_family, AF_INET);
}

CHECK_NEW(a_module_needs_a_name)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_ERROR(IPC_connectModule(NULL, central->address), IPC_Null_Argument);
    EXPECT_ERROR(IPC_connectModule("", central->address), IPC_Null_Argument);
    EXPECT_ERROR(IPC_connectModuleNoListen(NULL, central->address), IPC_Null_Argument);
    EXPECT_ERROR(IPC_connect(NULL), IPC_Null_Argument);
    EXPECT_ERROR(IPC_connectNoListen(""), IPC_Null_Argument);
    EXPECT_OK(IPC_connectModule("A", central->address));
}

CHECK(modules_are_known_by_name_in_any_case_and_central_is_one)
{
    connected();
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    EXPECT_INT(IPC_isModuleConnected("a"), 1);
    EXPECT_INT(IPC_isModuleConnected("B"), 0);
    EXPECT_INT(IPC_isModuleConnected("X_IPC Server"), 1);
}

/* ------------------------------------------------------------------ descriptors */

static void read_fd(int fd, void *client_data)
{
    char byte;
    (void)client_data;
    record("fd %d ", (int)read(fd, &byte, 1));
}

static int n_connections(void)
{
    fd_set set = IPC_getConnections();
    int count = 0;
    for (int fd = 0; fd < FD_SETSIZE; fd++) {
        count += FD_ISSET(fd, &set) != 0;
    }
    return count;
}

CHECK(the_set_of_connections_holds_central_and_the_descriptors_of_the_user)
{
    int ends[2];
    connected();
    EXPECT_INT(pipe(ends), 0);
    EXPECT_INT(n_connections(), 1);
    EXPECT_OK(IPC_subscribeFD(ends[0], read_fd, NULL));
    fd_set set = IPC_getConnections();
    EXPECT_INT(n_connections(), 2);
    EXPECT(FD_ISSET(ends[0], &set));
    EXPECT(FD_ISSET(x_ipcGetServer(), &set));
    EXPECT_OK(IPC_unsubscribeFD(ends[0], read_fd));
    EXPECT_INT(n_connections(), 1);
    IPC_disconnect();
    EXPECT_INT(n_connections(), 0);
}

CHECK_NEW(waiting_for_the_connections_does_not_sleep_over_messages_that_are_here)
{
    struct timeval soon = {5, 0};
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    IPC_setCapacity(10);
    publish_int("m", 1);
    publish_int("m", 2);
    EXPECT_INT(IPC_isModuleConnected("A"), 1); /* reads what has come */
    fd_set set = IPC_getConnections();
    EXPECT(select(FD_SETSIZE, &set, NULL, NULL, &soon) > 0);
    IPC_listenClear(0);
    EXPECT_TEXT(recorded(), "m1 m2 ");
}

/* --------------------------------------------------------- not going to listen */

CHECK(a_module_that_does_not_listen_is_warned_when_it_subscribes)
{
    int ends[2];
    char expected[200];
    struct central *central = central_start(NULL);
    EXPECT_INT(pipe(ends), 0);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModuleNoListen("A", central->address));
    define_int("m");
    snprintf(expected, sizeof expected,
             "WARNING: Subscribing to m, but have connected no-listen\n"
             "WARNING: Subscribing to port %d, but have connected no-listen\n",
             ends[0]);
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(IPC_subscribe("m", note_a, "m"));
    EXPECT_OK(IPC_subscribeFD(ends[0], read_fd, NULL));
    EXPECT_TEXT(captured_stderr(), expected);
    IPC_setVerbosity(IPC_Silent);
    settle();
    publish_int("m", 5);
    EXPECT_INT(write(ends[1], "x", 1), 1);
    listen_until(2);
    EXPECT_INT(n_recorded(), 2);
}

CHECK(connecting_again_changes_whether_a_module_listens)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModuleNoListen("A", central->address));
    EXPECT_OK(IPC_connectModule("A", central->address));
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(IPC_subscribe("m", note_a, "m"));
    EXPECT_TEXT(captured_stderr(), "");
    IPC_setVerbosity(IPC_Silent);
}

/* ----------------------------------------------------------------- a new life */

static void on_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)now;
    (void)scheduled;
    record("%s ", (const char *)client_data);
}

CHECK(a_new_connection_has_a_new_name_and_central_keeps_the_definitions)
{
    struct central *central = connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("B", central->address));
    EXPECT_INT(IPC_isModuleConnected("A"), 0);
    EXPECT_INT(IPC_isModuleConnected("B"), 1);
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    EXPECT_INT(IPC_numHandlers("m"), 0);
}

CHECK(a_new_connection_knows_no_timer_descriptor_or_subscription_of_the_old_one)
{
    int ends[2];
    struct central *central = connected();
    EXPECT_INT(pipe(ends), 0);
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    IPC_addPeriodicTimer(20, on_timer, "timer");
    IPC_subscribeFD(ends[0], read_fd, NULL);
    EXPECT_INT(write(ends[1], "x", 1), 1);
    IPC_disconnect();
    EXPECT_OK(IPC_connectModule("B", central->address));
    publish_int("m", 1);
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
}
