/*
 * What the programs of checks have in common: running one check, its centrals, its players.
 */
#include "check.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CHECKS = 128, CENTRALS = 8, MODULES = 16, TEXT = 16384, PATIENCE_MS = 5000, FAILED = 77 };

static struct {
    struct {
        const char *name;
        check_function *function;
    } checks[CHECKS];
    int n_checks;
    const char *program;
    FILE *report; /* standard output, also while that is captured */
    bool failed;

    struct central centrals[CENTRALS];
    int n_centrals;
    struct module modules[MODULES];
    int n_modules;
    int control; /* of a player */
    const char *address;

    FILE *captured[2];
    int saved[2];
    char texts[2][TEXT];

    char record[TEXT];
    char given[TEXT];
    size_t length;
    int n_recorded;
} state;

void check_register(const char *name, check_function *function)
{
    if (state.n_checks == CHECKS) {
        abort();
    }
    state.checks[state.n_checks].name = name;
    state.checks[state.n_checks++].function = function;
}

static void give_up(const char *what)
{
    fprintf(state.report, "not ok: %s: %s\n", what, strerror(errno));
    fflush(state.report);
    exit(2);
}

/* ------------------------------------------------------------- expectations */

bool expect(bool holds, const char *place, const char *expectation, const char *format, ...)
{
    va_list values;
    if (holds) {
        return true;
    }
    state.failed = true;
    const char *file = strrchr(place, '/');
    fprintf(state.report, "not ok %s: expected %s, got ", file ? file + 1 : place, expectation);
    va_start(values, format);
    vfprintf(state.report, format, values);
    va_end(values);
    fputc('\n', state.report);
    fflush(state.report);
    return false;
}

void expect_text(const char *text, const char *expected, const char *place, const char *what)
{
    char expectation[TEXT];
    if (text == expected) {
        return;
    }
    snprintf(expectation, sizeof expectation, "%s == \"%s\"", what, expected ? expected : "(NULL)");
    expect(text && expected && strcmp(text, expected) == 0, place, expectation, "\"%s\"",
           text ? text : "(NULL)");
}

void expect_result(intptr_t result, intptr_t expected, int error, const char *place,
                   const char *what)
{
    char expectation[512];
    const int found = error < 0 ? error : (int)IPC_errno;
    if (error < 0) {
        snprintf(expectation, sizeof expectation, "%s == %ld", what, (long)expected);
    } else {
        snprintf(expectation, sizeof expectation, "%s == %ld, IPC_errno %d", what, (long)expected,
                 error);
    }
    expect(result == expected && found == error, place, expectation, "%ld, IPC_errno %d",
           (long)result, (int)IPC_errno);
}

/* ------------------------------------------------------------------ centrals */

int free_port(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof address;
    const int on = 1;
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    /* It stays open, so that nobody else is given the port; the option lets a central have it. */
    if (fd < 0 || bind(fd, (struct sockaddr *)&address, length) != 0 ||
        getsockname(fd, (struct sockaddr *)&address, &length) != 0 ||
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0) {
        give_up("no free port");
    }
    return ntohs(address.sin_port);
}

static void log_name(const struct central *central, char *name, size_t size)
{
    snprintf(name, size, "central%d.log", (int)(central - state.centrals));
}

/* Central says so; a connection to try it out would be a module to it. */
static bool is_ready(const struct central *central)
{
    char name[32];
    char text[1024];
    log_name(central, name, sizeof name);
    FILE *log = fopen(name, "r");
    if (!log) {
        return false;
    }
    text[fread(text, 1, sizeof text - 1, log)] = '\0';
    fclose(log);
    return strstr(text, " on port ") != NULL;
}

/* Leaves a child nothing of this process but the standard error stream. */
static void close_descriptors(int from)
{
    for (int fd = from; fd < 256; fd++) {
        close(fd);
    }
}

static void run_central(const struct central *central, const char *option)
{
    const char *later = getenv("IPC_CHECK_LATER_CENTRALS");
    const char *program = later && central != state.centrals ? later : getenv("IPC_CHECK_CENTRAL");
    char port_option[16];
    char name[32];
    snprintf(port_option, sizeof port_option, "-p%d", central->port);
    log_name(central, name, sizeof name);
    const int log = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, 0);
    dup2(log, 1);
    dup2(log, 2);
    close_descriptors(3);
    unsetenv("LD_LIBRARY_PATH"); /* is for the library under test, and an original finds its own */
    execl(program, program, port_option, "-u", option, (char *)NULL);
    _exit(127);
}

struct central *central_start_on(int port, const char *option)
{
    struct central *central = &state.centrals[state.n_centrals++];
    central->port = port;
    snprintf(central->address, sizeof central->address, "localhost:%d", port);
    central->pid = fork();
    if (central->pid == 0) {
        run_central(central, option);
    }
    const long end = now_ms() + 2 * PATIENCE_MS;
    while (!is_ready(central)) {
        if (now_ms() > end) {
            give_up("central does not start");
        }
        sleep_ms(5);
    }
    return central;
}

struct central *central_start(const char *option)
{
    return central_start_on(free_port(), option);
}

void central_kill(struct central *central)
{
    kill(central->pid, SIGKILL);
    waitpid(central->pid, NULL, 0);
    central->pid = 0;
}

void central_stop(struct central *central)
{
    int status;
    kill(central->pid, SIGSTOP);
    waitpid(central->pid, &status, WUNTRACED);
}

void central_continue(struct central *central)
{
    kill(central->pid, SIGCONT);
}

static void end_centrals(void)
{
    for (int i = 0; i < state.n_centrals; i++) {
        const pid_t pid = state.centrals[i].pid;
        int status;
        if (pid == 0) {
            continue;
        }
        if (!expect(waitpid(pid, &status, WNOHANG) == 0, PLACE, "central lives", "its end")) {
            continue;
        }
        kill(pid, SIGCONT);
        kill(pid, SIGTERM);
        waitpid(pid, &status, 0);
    }
}

struct central *connected(void)
{
    struct central *central = central_start(NULL);
    IPC_setVerbosity(IPC_Silent);
    if (IPC_connectModule("A", central->address) != IPC_OK) {
        give_up("cannot connect");
    }
    return central;
}

bool is_original(void)
{
    return getenv("IPC_CHECK_ORIGINAL") != NULL;
}

void settle(void)
{
    if (is_original()) {
        IPC_listenWait(200);
    }
}

/* Central has handled what had reached it before the first question when it answers the second. */
PLAYER(witness)
{
    EXPECT_INT(IPC_isModuleConnected("nobody"), 0);
    EXPECT_INT(IPC_isModuleConnected("nobody"), 0);
    player_say(0);
    player_wait();
    IPC_disconnect();
}

void let_arrive(void)
{
    if (is_original()) {
        sleep_ms(200);
    } else {
        module_start("witness", &state.centrals[0]);
    }
}

/* ------------------------------------------------------------- other modules */

static void run_player(const char *player, const char *address, int control)
{
    char number[16];
    snprintf(number, sizeof number, "%d", dup2(control, 3));
    close_descriptors(4);
    execl(state.program, state.program, player, address, number, (char *)NULL);
    _exit(127);
}

struct module *module_start(const char *player, const struct central *central)
{
    struct module *module = &state.modules[state.n_modules++];
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) {
        give_up("socketpair");
    }
    module->control = pair[0];
    module->pid = fork();
    if (module->pid == 0) {
        run_player(player, central ? central->address : "", pair[1]);
    }
    fcntl(pair[0], F_SETFD, FD_CLOEXEC);
    close(pair[1]);
    EXPECT_INT(module_hear(module), 0);
    return module;
}

void module_tell(struct module *module, int number)
{
    if (send(module->control, &number, sizeof number, MSG_NOSIGNAL) != sizeof number) {
        EXPECT_THAT("the player is there");
    }
}

int module_hear(struct module *module)
{
    int number;
    return read(module->control, &number, sizeof number) == sizeof number ? number : -1;
}

int module_end(struct module *module)
{
    int status;
    waitpid(module->pid, &status, 0);
    module->pid = 0;
    close(module->control);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

void module_kill(struct module *module)
{
    kill(module->pid, SIGKILL);
    EXPECT_INT(module_end(module), -SIGKILL);
}

/* Players end when their control descriptor is closed. */
static void end_modules(void)
{
    for (int i = 0; i < state.n_modules; i++) {
        if (state.modules[i].pid != 0) {
            shutdown(state.modules[i].control, SHUT_WR);
            EXPECT_INT(module_end(&state.modules[i]), 0);
        }
    }
}

void player_say(int number)
{
    (void)!write(state.control, &number, sizeof number);
}

int player_wait(void)
{
    int number;
    return read(state.control, &number, sizeof number) == sizeof number ? number : -1;
}

int player_control(void)
{
    return state.control;
}

const char *player_address(void)
{
    return state.address;
}

static void end_player(int fd, void *client_data)
{
    int number;
    (void)client_data;
    if (read(fd, &number, sizeof number) <= 0 || number < 0) {
        IPC_disconnect();
        exit(state.failed ? FAILED : 0);
    }
    exit(number); /* without disconnecting */
}

void player_serve(void)
{
    IPC_subscribeFD(state.control, end_player, NULL);
    settle();
    player_say(0);
    while (IPC_listen(IPC_WAIT_FOREVER) != IPC_Error) {
    }
    EXPECT_THAT("the player is connected until the check ends");
    exit(FAILED);
}

/* ------------------------------------------------------- output and processes */

void capture(void)
{
    FILE *streams[2] = {stdout, stderr};
    for (int i = 0; i < 2; i++) {
        fflush(streams[i]);
        state.saved[i] = dup(fileno(streams[i]));
        state.captured[i] = tmpfile();
        dup2(fileno(state.captured[i]), fileno(streams[i]));
    }
}

static void read_all(FILE *file, char *text, size_t size)
{
    rewind(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

static void capture_end(void)
{
    FILE *streams[2] = {stdout, stderr};
    for (int i = 0; i < 2 && state.captured[i]; i++) {
        fflush(streams[i]);
        dup2(state.saved[i], fileno(streams[i]));
        close(state.saved[i]);
        read_all(state.captured[i], state.texts[i], TEXT);
        state.captured[i] = NULL;
    }
}

const char *captured_stdout(void)
{
    capture_end();
    return state.texts[0];
}

const char *captured_stderr(void)
{
    capture_end();
    return state.texts[1];
}

struct apart apart_start(check_function *function)
{
    struct apart apart = {0, tmpfile(), tmpfile()};
    fflush(NULL);
    apart.pid = fork();
    if (apart.pid == 0) {
        dup2(fileno(apart.out), 1);
        dup2(fileno(apart.err), 2);
        function();
        exit(state.failed ? FAILED : 0);
    }
    return apart;
}

struct outcome apart_end(struct apart *apart)
{
    struct outcome outcome;
    int status;
    waitpid(apart->pid, &status, 0);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    read_all(apart->out, outcome.out, sizeof outcome.out);
    read_all(apart->err, outcome.err, sizeof outcome.err);
    return outcome;
}

struct outcome run_apart(check_function *function)
{
    struct apart apart = apart_start(function);
    return apart_end(&apart);
}

/* ------------------------------------------------------------------ helpers */

void record(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = vsnprintf(state.record + state.length, TEXT - state.length, format, values);
    va_end(values);
    state.length += (size_t)length;
    if (state.length >= TEXT) {
        state.length = TEXT - 1;
    }
    state.n_recorded++;
}

const char *recorded(void)
{
    memcpy(state.given, state.record, state.length + 1);
    state.record[0] = '\0';
    state.length = 0;
    state.n_recorded = 0;
    return state.given;
}

int n_recorded(void)
{
    return state.n_recorded;
}

void listen_until(int count)
{
    const long end = now_ms() + PATIENCE_MS;
    while (state.n_recorded < count && now_ms() < end) {
        if (IPC_listen(50) == IPC_Error) {
            EXPECT_THAT("IPC_listen works");
            return;
        }
    }
}

void listen_for(unsigned int milliseconds)
{
    EXPECT(IPC_listenWait(milliseconds) != IPC_Error);
}

static void note(BYTE_ARRAY content, const char *tag)
{
    int number = 0;
    if (content) {
        memcpy(&number, content, sizeof number);
    }
    record("%s%d ", tag ? tag : "", number);
    IPC_freeByteArray(content);
}

void note_a(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    note(content, client_data);
}

void note_b(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    note(content, client_data);
}

void note_c(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    note(content, client_data);
}

IPC_RETURN_TYPE define_int(const char *message)
{
    return IPC_defineMsg(message, IPC_VARIABLE_LENGTH, "int");
}

IPC_RETURN_TYPE publish_int(const char *message, int number)
{
    return IPC_publish(message, sizeof number, &number);
}

long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

void sleep_ms(long milliseconds)
{
    struct timespec rest = {milliseconds / 1000, milliseconds % 1000 * 1000000};
    while (nanosleep(&rest, &rest) != 0) {
    }
}

/* ---------------------------------------------------------------------- main */

static void play(const char *name, const char *address)
{
    for (int i = 0; i < state.n_checks; i++) {
        if (strcmp(state.checks[i].name, name) == 0) {
            if (address && *address) {
                IPC_setVerbosity(IPC_Silent);
                EXPECT_OK(IPC_connectModule(name, address));
            }
            state.checks[i].function();
            return;
        }
    }
    fprintf(state.report, "not ok: no check %s\n", name);
    state.failed = true;
}

/* program CHECK, or, for the program itself, program PLAYER ADDRESS DESCRIPTOR */
int main(int count, char **words)
{
    state.program = words[0];
    state.report = fdopen(dup(1), "w");
    if (count < 2 || !state.report) {
        return 2;
    }
    fcntl(fileno(state.report), F_SETFD, FD_CLOEXEC);
    if (count > 3) {
        state.address = words[2];
        state.control = atoi(words[3]);
        fcntl(state.control, F_SETFD, FD_CLOEXEC);
        play(words[1], words[2]);
        return state.failed ? FAILED : 0;
    }
    play(words[1], NULL);
    end_modules();
    IPC_disconnect();
    end_centrals();
    if (!state.failed) {
        fprintf(state.report, "ok %s\n", words[1]);
    }
    fflush(state.report);
    return state.failed ? 1 : 0;
}
