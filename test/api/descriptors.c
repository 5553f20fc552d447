/*
 * Descriptors of the user (T101 to T108).
 */
#include "check.h"

#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static int ends[2];

static void open_pipe(void)
{
    EXPECT_INT(pipe(ends), 0);
}

static void write_byte(void)
{
    EXPECT_INT(write(ends[1], "x", 1), 1);
}

static void read_a(int fd, void *client_data)
{
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    record("a %d %s; ", fd == ends[0], (const char *)client_data);
}

static void read_b(int fd, void *client_data)
{
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    record("b %d %s; ", fd == ends[0], (const char *)client_data);
}

static void read_nothing(int fd, void *client_data)
{
    (void)fd;
    (void)client_data;
    record("x");
}

CHECK(a_readable_descriptor_is_an_event)
{
    open_pipe();
    connected();
    IPC_listenClear(20);
    EXPECT_OK(IPC_subscribeFD(ends[0], read_a, "data"));
    EXPECT_TIMEOUT(IPC_listen(20));
    write_byte();
    EXPECT_OK(IPC_listen(1000));
    EXPECT_TEXT(recorded(), "a 1 data; ");
    EXPECT_TIMEOUT(IPC_listen(20));
}

CHECK(a_descriptor_has_one_handler_and_replacing_it_is_warned_of)
{
    char expected[200];
    open_pipe();
    connected();
    EXPECT_OK(IPC_subscribeFD(ends[0], read_a, "one"));
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(IPC_subscribeFD(ends[0], read_b, "one"));
    EXPECT_OK(IPC_subscribeFD(ends[0], read_b, "two"));
    EXPECT_OK(IPC_subscribeFD(ends[0], read_b, "two"));
    snprintf(expected, sizeof expected,
             "WARNING: Handler function replaced for fd %d\n"
             "WARNING: Replacing client data for fd %d\n",
             ends[0], ends[0]);
    EXPECT_TEXT(captured_stderr(), expected);
    IPC_setVerbosity(IPC_Silent);
    write_byte();
    listen_until(1);
    listen_for(30);
    EXPECT_TEXT(recorded(), "b 1 two; ");
}

CHECK(a_descriptor_that_is_not_read_is_served_again)
{
    open_pipe();
    connected();
    IPC_listenClear(20);
    IPC_subscribeFD(ends[0], read_nothing, NULL);
    write_byte();
    for (int i = 1; i <= 3; i++) {
        EXPECT_OK(IPC_listen(1000));
        EXPECT_INT(n_recorded(), i);
    }
}

CHECK(the_end_of_a_file_is_an_event)
{
    open_pipe();
    connected();
    IPC_listenClear(20);
    IPC_subscribeFD(ends[0], read_nothing, NULL);
    close(ends[1]);
    EXPECT_OK(IPC_listen(1000));
    EXPECT_INT(n_recorded(), 1);
}

CHECK(unsubscribing_a_descriptor_asks_for_no_handler)
{
    open_pipe();
    connected();
    IPC_listenClear(20);
    IPC_subscribeFD(ends[0], read_a, "data");
    write_byte();
    EXPECT_OK(IPC_unsubscribeFD(ends[0], read_b));
    EXPECT_OK(IPC_unsubscribeFD(ends[0], read_a));
    EXPECT_TIMEOUT(IPC_listen(50));
    EXPECT_TEXT(recorded(), "");
}

static void read_and_unsubscribe_both(int fd, void *client_data)
{
    const int *other = client_data;
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    EXPECT_OK(IPC_unsubscribeFD(fd, NULL));
    EXPECT_OK(IPC_unsubscribeFD(*other, NULL));
    record("x");
}

CHECK_NEW(a_handler_may_unsubscribe_itself_and_others)
{
    int others[2];
    open_pipe();
    EXPECT_INT(pipe(others), 0);
    connected();
    IPC_subscribeFD(ends[0], read_and_unsubscribe_both, &others[0]);
    IPC_subscribeFD(others[0], read_nothing, NULL);
    write_byte();
    EXPECT_INT(write(others[1], "x", 1), 1);
    EXPECT_OK(IPC_listen(1000));
    EXPECT_TIMEOUT(IPC_listen(50));
    EXPECT_INT(n_recorded(), 1);
}

static void read_both(int fd, void *client_data)
{
    const int *other = client_data;
    char byte;
    EXPECT_INT(read(fd, &byte, 1), 1);
    EXPECT_INT(read(*other, &byte, 1), 1);
    record("both ");
}

CHECK_NEW(no_handler_is_called_for_what_another_has_read)
{
    int others[2];
    open_pipe();
    EXPECT_INT(pipe(others), 0);
    connected();
    IPC_subscribeFD(ends[0], read_both, &others[0]);
    IPC_subscribeFD(others[0], read_nothing, NULL);
    write_byte();
    EXPECT_INT(write(others[1], "x", 1), 1);
    EXPECT_OK(IPC_listen(1000));
    EXPECT_TIMEOUT(IPC_listen(50));
    EXPECT_TEXT(recorded(), "both ");
}

CHECK_NEW(a_descriptor_subscribed_before_connecting_is_served_after)
{
    struct central *central = central_start(NULL);
    open_pipe();
    IPC_setVerbosity(IPC_Silent);
    IPC_initialize();
    EXPECT_OK(IPC_subscribeFD(ends[0], read_a, "early"));
    EXPECT_OK(IPC_connectModule("A", central->address));
    write_byte();
    listen_until(1);
    EXPECT_TEXT(recorded(), "a 1 early; ");
}

CHECK_NEW(a_descriptor_subscribed_in_state_fresh_is_served_after_connecting)
{
    struct central *central = central_start(NULL);
    open_pipe();
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_subscribeFD(ends[0], read_a, "early"));
    EXPECT_OK(IPC_connectModule("A", central->address));
    write_byte();
    listen_until(1);
    EXPECT_TEXT(recorded(), "a 1 early; ");
}

CHECK(a_closed_descriptor_fails_until_it_is_unsubscribed)
{
    open_pipe();
    connected();
    IPC_listenClear(20);
    IPC_subscribeFD(ends[0], read_a, "data");
    close(ends[0]);
    EXPECT_ERROR(IPC_listen(50), IPC_Communication_Error);
    EXPECT_ERROR(IPC_listen(50), IPC_Communication_Error);
    EXPECT_OK(IPC_unsubscribeFD(ends[0], read_a));
    EXPECT_TIMEOUT(IPC_listen(50));
}

CHECK_NEW(a_closed_descriptor_is_named)
{
    char expected[120];
    open_pipe();
    connected();
    IPC_subscribeFD(ends[0], read_a, "data");
    IPC_setVerbosity(IPC_Print_Errors);
    capture();
    close(ends[0]);
    EXPECT_ERROR(IPC_listen(50), IPC_Communication_Error);
    snprintf(expected, sizeof expected,
             "ERROR: Bad file descriptor %d in listen\n"
             "ERROR: Low level communication (socket) error\n",
             ends[0]);
    EXPECT_TEXT(captured_stderr(), expected);
    IPC_setVerbosity(IPC_Silent);
}

CHECK_NEW(descriptors_beyond_those_of_select_are_served)
{
    struct rlimit limit;
    open_pipe();
    getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_max < 2100) {
        return;
    }
    limit.rlim_cur = 2100;
    EXPECT_INT(setrlimit(RLIMIT_NOFILE, &limit), 0);
    EXPECT_INT(dup2(ends[0], 2000), 2000);
    ends[0] = 2000;
    connected();
    EXPECT_OK(IPC_subscribeFD(ends[0], read_a, "high"));
    write_byte();
    EXPECT_OK(IPC_listen(1000));
    EXPECT_TEXT(recorded(), "a 1 high; ");
    fd_set set = IPC_getConnections();
    EXPECT(FD_ISSET(x_ipcGetServer(), &set));
}

CHECK_NEW(the_library_itself_has_a_connection_beyond_those_of_select)
{
    struct rlimit limit;
    struct central *central = central_start(NULL);
    getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_max < 2100) {
        return;
    }
    limit.rlim_cur = 2100;
    EXPECT_INT(setrlimit(RLIMIT_NOFILE, &limit), 0);
    for (int fd = dup(0); fd < 1100; fd = dup(0)) {
    }
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", central->address));
    EXPECT(x_ipcGetServer() > 1024);
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
    IPC_getConnections();
}

CHECK_NEW(the_connection_to_central_cannot_be_unsubscribed)
{
    connected();
    define_int("m");
    IPC_subscribe("m", note_a, "m");
    EXPECT_OK(IPC_unsubscribeFD(x_ipcGetServer(), read_a));
    publish_int("m", 1);
    listen_until(1);
    EXPECT_TEXT(recorded(), "m1 ");
}
