/*
 * Fork, symbols for old programs, and direct connections between modules (T191 to T195).
 */
#include "check.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* CMU IPC has not got it. */
__attribute__((weak)) IPC_RETURN_TYPE IPCx_tryConnect(const char *taskName, const char *serverName);

/* ------------------------------------------------------------------------------------- fork */

static int status_of(pid_t pid)
{
    int status;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

static void on_disconnect(const char *module, void *client_data)
{
    (void)client_data;
    record("%s leaves ", module);
}

PLAYER(forks)
{
    define_int("m");
    player_say(0);
    player_wait();
    const pid_t pid = fork();
    if (pid == 0) {
        x_ipcCloseInternal(0);
        exit(IPC_isConnected() ? 1 : 0);
    }
    EXPECT_INT(status_of(pid), 0);
    EXPECT_INT(IPC_isConnected(), 1);
    settle();
    EXPECT_OK(publish_int("m", 1));
    player_say(IPC_isModuleConnected("forks"));
    player_wait();
}

CHECK(a_child_may_close_its_copy_of_the_connection)
{
    struct central *central = connected();
    define_int("m");
    IPC_subscribeDisconnect(on_disconnect, NULL);
    IPC_subscribe("m", note_a, "m");
    settle();
    struct module *module = module_start("forks", central);
    module_tell(module, 1);
    listen_until(1);
    EXPECT_INT(module_hear(module), 1);
    listen_for(50);
    EXPECT_TEXT(recorded(), "m1 ");
}

PLAYER(forks_and_exits_in_the_child)
{
    define_int("m");
    player_say(0);
    player_wait();
    const pid_t pid = fork();
    if (pid == 0) {
        exit(0);
    }
    EXPECT_INT(status_of(pid), 0);
    EXPECT_INT(IPC_isModuleConnected("forks_and_exits_in_the_child"), 1);
    player_say(1);
    player_wait();
}

CHECK(the_exit_of_a_child_disconnects_nobody)
{
    struct central *central = connected();
    IPC_subscribeDisconnect(on_disconnect, NULL);
    settle();
    struct module *module = module_start("forks_and_exits_in_the_child", central);
    module_tell(module, 1);
    EXPECT_INT(module_hear(module), 1);
    listen_for(50);
    EXPECT_TEXT(recorded(), "");
}

CHECK_NEW(a_program_that_is_started_inherits_no_descriptor_of_the_library)
{
    connected();
    const int flags = fcntl(x_ipcGetServer(), F_GETFD);
    EXPECT(flags >= 0 && (flags & FD_CLOEXEC) != 0);
}

/* --------------------------------------------------------------------- symbols by hand */

CHECK(handlers_are_told_apart_by_name_when_they_have_one)
{
    connected();
    define_int("m");
    EXPECT_OK(_IPC_subscribe("m", "one", note_a, "one", 0));
    EXPECT_OK(_IPC_subscribe("m", "two", note_a, "two", 0));
    settle();
    EXPECT_INT(IPC_numHandlers("m"), 2);
    publish_int("m", 1);
    listen_until(2);
    EXPECT_TEXT(recorded(), "one1 two1 ");
    EXPECT_OK(_IPC_unsubscribe("m", "one"));
    settle();
    publish_int("m", 2);
    listen_until(1);
    listen_for(30);
    EXPECT_TEXT(recorded(), "two2 ");
}

CHECK(another_function_for_a_named_handler_is_ignored_with_a_warning)
{
    connected();
    define_int("m");
    EXPECT_OK(_IPC_subscribe("m", "one", note_a, "one", 0));
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(_IPC_subscribe("m", "one", note_b, "one", 0));
    EXPECT_TEXT(captured_stderr(),
                "\nWARNING: Procedure change ignored for existing handler one.\n");
    IPC_setVerbosity(IPC_Silent);
}

static void note_data(MSG_INSTANCE instance, void *data, void *client_data)
{
    (void)client_data;
    record("%s ", *(char **)data);
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
}

CHECK(a_named_handler_may_want_data)
{
    char *text = "text";
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, "string");
    EXPECT_OK(_IPC_subscribe("m", "one", note_data, NULL, 1));
    settle();
    IPC_publishData("m", &text);
    listen_until(1);
    EXPECT_TEXT(recorded(), "text ");
}

static void read_fd(int fd, void *client_data)
{
    (void)fd;
    (void)client_data;
}

CHECK(the_descriptors_can_be_asked_for_as_in_the_older_interface)
{
    int ends[2];
    connected();
    EXPECT_INT(pipe(ends), 0);
    const int high = dup2(ends[0], 99);
    const int server = x_ipcGetServer();
    EXPECT(server >= 0);
    EXPECT(FD_ISSET(server, x_ipcGetConnections()));
    EXPECT(x_ipcGetMaxConnection() >= server);
    IPC_subscribeFD(high, read_fd, NULL);
    EXPECT(FD_ISSET(high, x_ipcGetConnections()));
    EXPECT_INT(x_ipcGetMaxConnection(), high);
    IPC_unsubscribeFD(high, read_fd);
    EXPECT(!FD_ISSET(high, x_ipcGetConnections()));
    EXPECT_INT(x_ipcGetMaxConnection(), high);
    IPC_disconnect();
    EXPECT_INT(x_ipcGetServer(), -1);
}

CHECK(old_names_of_connecting_and_leaving_work)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(_IPC_initialize(0));
    EXPECT_OK(_IPC_connect("A", central->address, 1, 0));
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    x_ipcClose();
    EXPECT_INT(IPC_isConnected(), 0);
    EXPECT_OK(_IPC_connect("B", central->address, 0, 0));
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    IPC_subscribe("m", note_a, NULL);
    EXPECT_TEXT(captured_stderr(), "WARNING: Subscribing to m, but have connected no-listen\n");
    IPC_setVerbosity(IPC_Silent);
    x_ipcCloseInternal(1);
    EXPECT_INT(IPC_isConnected(), 0);
}

CHECK(programs_may_set_errors_themselves)
{
    connected();
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    ipcSetError(IPC_Illegal_Formatter);
    EXPECT_TEXT(captured_stderr(), "ERROR: Illegal format string\n");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_INT(IPC_errno, IPC_Illegal_Formatter);
}

/* A program asks under a passing name whether its own is taken, and then connects under that. */
CHECK(a_name_may_be_tried_before_it_is_used)
{
    char name[32];
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    snprintf(name, sizeof name, "probe-%d", (int)getpid());
    EXPECT_OK(IPC_connectModule(name, central->address));
    EXPECT_INT(IPC_isModuleConnected("robot"), 0);
    EXPECT_OK(IPC_disconnect());
    EXPECT_OK(IPC_connectModule("robot", central->address));
    EXPECT_INT(IPC_isModuleConnected("robot"), 1);
    EXPECT_INT(IPC_isModuleConnected(name), 0);
}

/* ------------------------------------------------------------------------ direct connections */

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = *(int *)content + 100;
    (void)client_data;
    EXPECT_OK(IPC_respond(instance, "r", sizeof number, &number));
    IPC_freeByteArray(content);
}

static void forward(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    player_say(*(int *)content);
    IPC_freeByteArray(content);
}

PLAYER(direct_one)
{
    define_int("m");
    define_int("q");
    define_int("r");
    IPC_subscribe("m", forward, NULL);
    IPC_subscribe("q", answer, NULL);
    player_serve();
}

static struct central *directly_connected(void)
{
    struct central *central = central_start("-c");
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", central->address));
    define_int("m");
    define_int("q");
    define_int("r");
    return central;
}

CHECK(modules_that_are_linked_directly_publish_and_ask_as_others_do)
{
    int number = 5;
    void *reply = NULL;
    struct central *central = directly_connected();
    struct module *module = module_start("direct_one", central);
    listen_for(100);
    for (int i = 0; i < 5; i++) {
        EXPECT_OK(publish_int("m", i));
        EXPECT_INT(module_hear(module), i);
    }
    EXPECT_OK(IPC_queryResponse("q", sizeof number, &number, &reply, 5000));
    EXPECT_INT(*(int *)reply, 105);
    IPC_freeByteArray(reply);
    EXPECT_OK(IPC_queryNotify("q", sizeof number, &number, note_a, "reply"));
    listen_until(1);
    EXPECT_TEXT(recorded(), "reply105 ");
    EXPECT_INT(IPC_numHandlers("m"), 1);
}

CHECK(the_end_of_a_directly_linked_module_is_no_error)
{
    struct central *central = directly_connected();
    struct module *module = module_start("direct_one", central);
    listen_for(100);
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(module_hear(module), 1);
    module_kill(module);
    listen_for(50);
    EXPECT_OK(publish_int("m", 2));
    EXPECT_OK(publish_int("m", 3));
    listen_for(50);
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
}

/* Whether text is made of these beginnings of lines, in this order. */
static bool has_lines(const char *text, const char *const *beginnings, int count)
{
    for (int i = 0; i < count; i++) {
        if (strncmp(text, beginnings[i], strlen(beginnings[i])) != 0) {
            return false;
        }
        text = strchr(text, '\n') ? strchr(text, '\n') + 1 : "";
    }
    return *text == '\0';
}

CHECK(the_publisher_says_what_it_is_linked_with)
{
    static const char *const lines[] = {"Direct Connection Established for m to direct_one at sd: ",
                                        "Closed Connection Detected from: Module: sd: "};
    struct central *central = directly_connected();
    struct module *module = module_start("direct_one", central);
    listen_for(100);
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(module_hear(module), 1);
    const char *text = captured_stderr();
    expect(has_lines(text, lines, 1), PLACE, "one line", "\"%s\"", text);
    IPC_setVerbosity(IPC_Silent);
}

PLAYER(direct_publisher)
{
    define_int("m");
    player_say(0);
    player_wait();
    IPC_listenClear(100);
    EXPECT_OK(publish_int("m", 1));
    player_wait();
}

CHECK(the_subscriber_says_who_has_linked_and_who_has_gone)
{
    static const char *const lines[] = {"New UNIX Connection Established for a Module at sd: ",
                                        "Closed Connection Detected from: Module: sd: "};
    struct central *central = directly_connected();
    IPC_subscribe("m", note_a, "m");
    listen_for(50);
    struct module *module = module_start("direct_publisher", central);
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    module_tell(module, 1);
    listen_until(1);
    module_tell(module, 2);
    EXPECT_INT(module_end(module), 0);
    listen_for(100);
    const char *text = captured_stderr();
    IPC_setVerbosity(IPC_Silent);
    expect(has_lines(text, lines, 2), PLACE, "two lines", "\"%s\"", text);
    EXPECT_TEXT(recorded(), "m1 ");
}

static void handle_eight(int number)
{
    struct central *central = directly_connected();
    IPC_setMsgQueueLength("m", 2);
    IPC_subscribe("m", note_a, "");
    struct module *module = module_start("sends_eight", central);
    module_tell(module, number);
    EXPECT_INT(module_hear(module), 1);
    sleep_ms(50);
    listen_for(200);
}

PLAYER(sends_eight)
{
    define_int("m");
    player_say(0);
    const int number = player_wait();
    IPC_listenClear(100);
    for (int i = 0; i < number; i++) {
        EXPECT_OK(publish_int("m", i));
    }
    player_say(1);
    player_wait();
}

CHECK_NEW(the_queue_length_holds_for_direct_messages)
{
    handle_eight(8);
    EXPECT_TEXT(recorded(), "6 7 ");
}

/* The path at which the socket with that inode is bound, "" if there is none. */
static void bound_path(unsigned long inode, char *path, size_t size)
{
    char line[300];
    char name[200];
    unsigned long found;
    FILE *sockets = fopen("/proc/self/net/unix", "r");
    path[0] = '\0';
    while (sockets && fgets(line, sizeof line, sockets)) {
        if (sscanf(line, "%*s %*s %*s %*s %*s %*s %lu %199s", &found, name) == 2 &&
            found == inode) {
            snprintf(path, size, "%s", name);
        }
    }
    if (sockets) {
        fclose(sockets);
    }
}

/* The path of the Unix socket on which this module is reached by others. */
static void own_socket(char *path, size_t size)
{
    struct stat status;
    fd_set set = IPC_getConnections();
    path[0] = '\0';
    for (int fd = 0; fd < FD_SETSIZE && path[0] == '\0'; fd++) {
        if (FD_ISSET(fd, &set) && fstat(fd, &status) == 0) {
            bound_path((unsigned long)status.st_ino, path, size);
        }
    }
}

PLAYER(exits_without_a_word)
{
    char path[200];
    own_socket(path, sizeof path);
    player_say(0);
    player_say(atoi(path[0] ? strrchr(path, '/') + 1 : "-1"));
    player_wait();
    exit(access(path, F_OK) == 0 ? 0 : 1);
}

CHECK_NEW(the_socket_of_direct_mode_is_removed_when_a_module_disconnects)
{
    char path[200];
    directly_connected();
    own_socket(path, sizeof path);
    EXPECT(path[0] != '\0');
    EXPECT_INT(access(path, F_OK), 0);
    IPC_disconnect();
    EXPECT(access(path, F_OK) != 0);
}

CHECK_NEW(a_child_leaves_the_socket_of_direct_mode_alone)
{
    char path[200];
    directly_connected();
    own_socket(path, sizeof path);
    const pid_t exits = fork();
    if (exits == 0) {
        exit(0);
    }
    EXPECT_INT(status_of(exits), 0);
    const pid_t closes = fork();
    if (closes == 0) {
        x_ipcCloseInternal(0);
        exit(0);
    }
    EXPECT_INT(status_of(closes), 0);
    EXPECT_INT(access(path, F_OK), 0);
}

CHECK_NEW(the_socket_of_direct_mode_is_removed_when_a_module_exits)
{
    char path[200];
    struct central *central = directly_connected();
    struct module *module = module_start("exits_without_a_word", central);
    snprintf(path, sizeof path, "/tmp/x_ipc/%d", module_hear(module));
    EXPECT_INT(access(path, F_OK), 0);
    module_tell(module, 1);
    EXPECT_INT(module_end(module), 0);
    EXPECT(access(path, F_OK) != 0);
}

/* The TCP address at which others reach this module directly. */
static in_addr_t own_address(void)
{
    struct sockaddr_in name;
    fd_set set = IPC_getConnections();
    for (int fd = 0; fd < FD_SETSIZE; fd++) {
        int listens = 0;
        socklen_t size = sizeof listens;
        socklen_t length = sizeof name;
        if (FD_ISSET(fd, &set) && getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 &&
            listens && getsockname(fd, (struct sockaddr *)&name, &length) == 0 &&
            name.sin_family == AF_INET) {
            return ntohl(name.sin_addr.s_addr);
        }
    }
    return INADDR_NONE;
}

CHECK_NEW(direct_links_come_from_everywhere_if_nothing_is_said)
{
    unsetenv("IPC_DIRECT_ADDRESS");
    directly_connected();
    EXPECT_INT(own_address(), INADDR_ANY);
}

CHECK_NEW(direct_links_are_listened_for_at_the_address_that_is_told)
{
    setenv("IPC_DIRECT_ADDRESS", "127.0.0.1", 1);
    struct central *central = directly_connected();
    EXPECT_INT(own_address(), INADDR_LOOPBACK);
    struct module *module = module_start("direct_one", central);
    listen_for(100);
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(module_hear(module), 1);
}

static char address_of_central[64];

static void connect_at_an_address_of_another_host(void)
{
    setenv("IPC_DIRECT_ADDRESS", "192.0.2.1", 1); /* for documentation only */
    IPC_setVerbosity(IPC_Print_Warnings);
    EXPECT_ERROR(IPCx_tryConnect("A", address_of_central), IPC_Not_Connected);
}

CHECK_NEW(an_address_for_direct_links_that_is_none_is_told)
{
    snprintf(address_of_central, sizeof address_of_central, "%s", central_start("-c")->address);
    const struct outcome outcome = run_apart(connect_at_an_address_of_another_host);
    EXPECT_INT(outcome.status, 0);
    EXPECT(strstr(outcome.err, "Warning: no port from 8000 to 9000 for direct links at "
                               "IPC_DIRECT_ADDRESS=192.0.2.1\n"));
}

/* Connects again and again, and counts how often it had no socket then. */
PLAYER(comes_and_goes)
{
    char path[200];
    int without = 0;
    player_say(0);
    player_wait();
    for (int i = 0; i < 200; i++) {
        IPC_disconnect();
        EXPECT_OK(IPC_connectModule("comes_and_goes", player_address()));
        own_socket(path, sizeof path);
        without += path[0] == '\0' || access(path, F_OK) != 0;
    }
    player_say(without);
    player_wait();
}

CHECK_NEW(who_takes_the_port_of_a_module_that_leaves_has_its_socket_too)
{
    struct module *modules[6];
    struct central *central = directly_connected();
    for (int i = 0; i < 6; i++) {
        modules[i] = module_start("comes_and_goes", central);
    }
    for (int i = 0; i < 6; i++) {
        module_tell(modules[i], 1);
    }
    for (int i = 0; i < 6; i++) {
        EXPECT_INT(module_hear(modules[i]), 0);
    }
}
