/*
 * The opening: everything by which others reach the server, in order.
 */
#include "central/opening.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "platform/supervisor.h"

static const char *reason_of(int error)
{
    return error == ERR_IO ? system_reason() : error_text(error);
}

static int complain(struct loop *loop, const char *text)
{
    (void)fputs(text, stderr);
    log_always(&loop->server->log, "%s", text);
    log_flush(&loop->server->log);
    return ERR_IO;
}

/* ---------------------------------------------------------------- from a supervisor */

static int take_over(struct loop *loop, size_t i, int fd)
{
    char name[32];
    supervisor_socket_name(i, name, sizeof name);
    return strcmp(name, "metrics") == 0 ? metrics_server_adopt(&loop->metrics, fd)
                                        : listeners_adopt(&loop->listeners, fd);
}

static const char *reason_against(int error)
{
    switch (error) {
    case ERR_LIMIT:
        return "there is one of its kind already";
    case ERR_REFUSED:
        return "it is not local, as the options demand";
    default:
        return "it does not listen";
    }
}

static int take_over_all(struct loop *loop)
{
    int first;
    const size_t n = supervisor_sockets(&first);
    for (size_t i = 0; i < n; i++) {
        const int error = take_over(loop, i, first + (int)i);
        if (error != 0) {
            (void)fprintf(stderr, "ERROR: Can not use descriptor %d of the supervisor: %s\n",
                          first + (int)i, reason_against(error));
            return ERR_IO;
        }
    }
    return 0;
}

/* ------------------------------------------------------------------------ our own */

static int open_listeners(struct loop *loop)
{
    const int error = listeners_open(&loop->listeners);
    if (error == 0) {
        return 0;
    }
    (void)fprintf(stderr, "Error: unable to %s for listening (%s)\n",
                  listeners_want_tcp(&loop->listeners) ? "bind TCP/IP socket" : "open socket/pipe",
                  error == ERR_UNKNOWN ? "no such address" : reason_of(error));
    return complain(loop, "ERROR: Unable to start server, Is one already running?\n\n");
}

static int open_metrics(struct loop *loop)
{
    const char *address = loop->server->options->metrics;
    const int error = address == NULL ? 0 : metrics_server_open(&loop->metrics, address);
    if (error != 0) {
        (void)fprintf(stderr, "ERROR: Can not show numbers at %s (%s)\n", address,
                      error == ERR_RANGE || error == ERR_UNKNOWN ? "no such address"
                                                                 : reason_of(error));
        return ERR_IO;
    }
    return 0;
}

static int write_files(struct loop *loop)
{
    const char *path;
    const int error = presence_begin(&loop->presence, loop->server->options, &path);
    if (error != 0) {
        (void)fprintf(stderr, "ERROR: Can not write file %s (%s)\n", path, system_reason());
    }
    return error;
}

int opening_open(struct loop *loop)
{
    int error = take_over_all(loop);
    if (error == 0) {
        error = open_listeners(loop);
    }
    if (error == 0) {
        error = open_metrics(loop);
    }
    return error != 0 ? error : write_files(loop);
}
