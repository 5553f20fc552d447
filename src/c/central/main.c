/*
 * The server program: central.
 *
 * What calls what, from here down:
 *
 *     main                options, start, end, exit status
 *       opening           sockets and files by which others find the server
 *       loop              sockets, streams, signals; one turn after another
 *         listeners       newcomers                             access
 *         metrics_server  numbers for programs that watch       metrics
 *         presence        files, and signs of life to a supervisor
 *         console         typed commands                        comments, options, statistics, tables
 *         conversation    bytes to frames, a turn of each connection
 *           route         who gets a message                    tap
 *           completion    what modules report about deliveries
 *           service       requests to the server, by a table
 *             service_*, variable_service   carry them out
 *               ending, start, notify, handler_list, broadcasts, variable, own_request
 *                 resend          what ended modules did not finish
 *         flow            what goes now and what waits          claim, pending
 *           backpressure  who has to wait for whom
 *         watch           new values to those who watch
 *         deliver, answer frames on their way out
 *           outbox        links, and which of them to flush
 *     log, log_*          every line that is written            sink, text
 *     message, handler, module, resource, dispatch              what there is
 *       namesakes, pool                                         how it is found and kept
 *
 * struct server holds all state; only what stands above the console touches the system.
 */
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "central/loop.h"
#include "central/opening.h"
#include "central/operator/statistics.h"
#include "central/routing/lifecycle.h"
#include "central/settings/version.h"
#include "central/settings/command_line.h"
#include "platform/process.h"

enum exit_status { EXIT_WELL = 0, EXIT_FAILED = 1, EXIT_WRONG_USE = 2 };

/* Executes the command line and says what it has to say. */
static enum options_result parse(struct options *options, int count, char **arguments)
{
    struct buffer out, errors;
    const struct options_output output = {&out, &errors};
    buffer_init(&out);
    buffer_init(&errors);
    const enum options_result result = options_parse(options, count, arguments, &output);
    if (!options->silent || result != OPTIONS_GO) {
        text_print(stdout, &out);
        text_print(stderr, &errors);
    }
    buffer_fini(&out);
    buffer_fini(&errors);
    return result;
}

static int open_logs(struct log *log, struct console *console)
{
    const bool fails = (log_wants_file(log, LOG_JSON) && log_open_file(log, LOG_JSON) != 0) ||
                       (log_wants_file(log, LOG_FILE) && console_open_log(console) != 0);
    return fails ? ERR_IO : 0;
}

static int start(struct server *server, struct loop *loop)
{
    if (loop_init(loop, server) != 0) {
        (void)fprintf(stderr, "ERROR: %s\n", system_reason());
        return ERR_IO;
    }
    if (open_logs(&server->log, &loop->console) != 0) {
        return ERR_IO;
    }
    return opening_open(loop);
}

static void print_statistics(const struct server *server)
{
    struct buffer text;
    if (server->options->silent) {
        return;
    }
    buffer_init(&text);
    statistics_append(server, &text);
    text_print(stderr, &text);
    buffer_fini(&text);
}

/* Serves until the end, which is said. */
static void serve(struct server *server, struct loop *loop)
{
    log_terminal(&server->log, SERVER_BANNER "\n");
    log_always(&server->log, "Expecting %d on port %d\n", server->options->expected,
               server->options->port);
    presence_tell_ready(&loop->presence, server->options->port, clock_ns());
    loop_run(loop);
    presence_tell_end();
    print_statistics(server);
    if (loop->signal != 0) {
        log_always(&server->log, "Central Abort : Signal %d\n", loop->signal);
    } else if (!server->options->silent) {
        (void)fputs("Central Quit\n", stderr);
    }
    loop_say_last_words(loop);
}

static int run(struct options *options)
{
    struct server server;
    struct loop loop;
    (void)net_raise_descriptor_limit(); /* what it is, shows when it is reached */
    server_init(&server, options, STREAM_OUTPUT, clock_ns());
    const int error = start(&server, &loop);
    if (error == 0) {
        serve(&server, &loop);
    }
    loop_fini(&loop);
    server_fini(&server);
    return error == 0 ? EXIT_WELL : EXIT_FAILED;
}

int main(int count, char **arguments)
{
    struct options options;
    int status;
    process_complete_streams();
    options_init(&options);
    switch (parse(&options, count, arguments)) {
    case OPTIONS_SHOWN:
        status = EXIT_WELL;
        break;
    case OPTIONS_WRONG:
        status = EXIT_WRONG_USE;
        break;
    default:
        status = run(&options);
        break;
    }
    options_fini(&options);
    return status;
}
