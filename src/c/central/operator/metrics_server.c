/*
 * Where the server's numbers are asked for: a small part of HTTP.
 */
#include "central/operator/metrics_server.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/operator/metrics.h"
#include "platform/process.h"

#define PATIENCE_NS UINT64_C(2000000000)
#define PAUSE_NS UINT64_C(1000000000)

enum { SOCKET_MODE = 0666, HIGHEST_PORT = 65535 };

/* ------------------------------------------------------------------ life cycle */

void metrics_server_init(struct metrics_server *metrics, struct server *server)
{
    memset(metrics, 0, sizeof *metrics);
    metrics->server = server;
    metrics->tcp = -1;
    metrics->local.fd = -1;
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        metrics->callers[i].fd = -1;
        buffer_init(&metrics->callers[i].answer);
    }
}

static int listener_of(const struct metrics_server *metrics)
{
    return metrics->tcp >= 0 ? metrics->tcp : metrics->local.fd;
}

/* Watches the listener while there are places, and only then. */
static void watch(struct metrics_server *metrics, bool wanted)
{
    const int listener = listener_of(metrics);
    if (listener < 0 || wanted == metrics->watched) {
        return;
    }
    if (wanted) {
        metrics->watched =
            poller_add(metrics->server->poller, listener, READY_READ, &metrics->watched) == 0;
    } else {
        poller_remove(metrics->server->poller, listener);
        metrics->watched = false;
    }
}

static void hang_up(struct metrics_server *metrics, struct metrics_caller *caller)
{
    poller_remove(metrics->server->poller, caller->fd);
    net_close(caller->fd);
    caller->fd = -1;
    buffer_fini(&caller->answer);
    watch(metrics, true);
}

void metrics_server_fini(struct metrics_server *metrics)
{
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        if (metrics->callers[i].fd >= 0) {
            hang_up(metrics, &metrics->callers[i]);
        }
    }
    watch(metrics, false);
    if (metrics->tcp >= 0) {
        net_close_copy(metrics->tcp); /* a supervisor may have another */
    }
    net_close_local(&metrics->local);
}

/* ------------------------------------------------------------------- listening */

int metrics_server_adopt(struct metrics_server *metrics, int fd)
{
    bool local;
    int port;
    if (listener_of(metrics) >= 0 || net_adopt(fd, &local, &port) != 0) {
        return ERR_IO;
    }
    *(local ? &metrics->local.fd : &metrics->tcp) = fd;
    watch(metrics, true);
    return metrics->watched ? 0 : ERR_IO;
}

/* The port at the end of an address, -1: none. */
static int read_port(const char *text)
{
    char *end;
    const long port = strtol(text, &end, 10);
    return text[0] < '0' || text[0] > '9' || *end != '\0' || port > HIGHEST_PORT ? -1 : (int)port;
}

/* Splits "host:port", "[host]:port" or "port"; the caller frees *host.  0 or ERR_RANGE. */
static int split(const char *address, char **host, int *port)
{
    const char *colon = strrchr(address, ':');
    *port = read_port(colon == NULL ? address : colon + 1);
    if (*port < 0) {
        return ERR_RANGE;
    }
    if (colon == NULL) {
        *host = mem_copy_string("127.0.0.1");
    } else if (address[0] == '[' && colon[-1] == ']') {
        *host = mem_copy_text(address + 1, (size_t)(colon - address) - 2);
    } else {
        *host = mem_copy_text(address, (size_t)(colon - address));
    }
    return 0;
}

static int listen_on_port(struct metrics_server *metrics, const char *address)
{
    char *host;
    int port;
    if (split(address, &host, &port) != 0) {
        return ERR_RANGE;
    }
    const int error = net_listen_tcp(host, &port, &metrics->tcp);
    if (error == 0) {
        log_terminal(&metrics->server->log, "Numbers at http://%s%s%s:%d/metrics\n",
                     strchr(host, ':') ? "[" : "", host, strchr(host, ':') ? "]" : "", port);
    } else {
        metrics->tcp = -1;
    }
    free(host);
    return error;
}

int metrics_server_open(struct metrics_server *metrics, const char *address)
{
    const int error = address[0] == '/' ? net_listen_local(address, SOCKET_MODE, &metrics->local)
                                        : listen_on_port(metrics, address);
    if (error != 0) {
        return error;
    }
    watch(metrics, true);
    return metrics->watched ? 0 : ERR_IO;
}

/* --------------------------------------------------------------------- answers */

static void answer(struct metrics_caller *caller, const char *status, const struct buffer *body)
{
    text_append(&caller->answer,
                "HTTP/1.1 %s\r\n"
                "Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"
                "Content-Length: %zu\r\n"
                "Connection: close\r\n\r\n",
                status, body->length);
    (void)buffer_append(&caller->answer, body->bytes, body->length); /* without memory: too short */
}

/* Whether the request begins with these words and a blank. */
static bool asks(const struct metrics_caller *caller, const char *words)
{
    const size_t length = strlen(words);
    return caller->asked > length && memcmp(caller->request, words, length) == 0 &&
           caller->request[length] == ' ';
}

static void answer_request(struct metrics_server *metrics, struct metrics_caller *caller)
{
    struct buffer body;
    const char *status = "200 OK";
    buffer_init(&body);
    if (asks(caller, "GET /metrics") || asks(caller, "GET /")) {
        metrics_append(metrics->server, &body);
    } else {
        status = asks(caller, "GET") ? "404 Not Found" : "405 Method Not Allowed";
        text_append(&body, "There is only GET /metrics here.\n");
    }
    answer(caller, status, &body);
    buffer_fini(&body);
}

static bool is_whole(const struct metrics_caller *caller)
{
    for (size_t i = 1; i < caller->asked; i++) {
        const char *end = &caller->request[i];
        if (*end == '\n' && (end[-1] == '\n' || (i > 1 && end[-1] == '\r' && end[-2] == '\n'))) {
            return true;
        }
    }
    return false;
}

/* --------------------------------------------------------------------- callers */

/* Sends what the socket takes; the end of the answer is the end of the connection. */
static void send_rest(struct metrics_server *metrics, struct metrics_caller *caller)
{
    const struct net_slice rest = {caller->answer.bytes + caller->sent,
                                   caller->answer.length - caller->sent};
    const ptrdiff_t n = net_write(caller->fd, &rest, 1);
    caller->sent += n > 0 ? (size_t)n : 0;
    if (n < 0 || caller->sent == caller->answer.length ||
        poller_change(metrics->server->poller, caller->fd, READY_WRITE, caller) != 0) {
        hang_up(metrics, caller);
    }
}

static void read_request(struct metrics_server *metrics, struct metrics_caller *caller)
{
    const ptrdiff_t n = net_read(caller->fd, caller->request + caller->asked,
                                 sizeof caller->request - caller->asked);
    if (n < 0) {
        hang_up(metrics, caller);
        return;
    }
    caller->asked += (size_t)n;
    if (is_whole(caller)) {
        answer_request(metrics, caller);
        send_rest(metrics, caller);
    } else if (caller->asked == sizeof caller->request) {
        hang_up(metrics, caller); /* nobody asks for numbers in so many words */
    }
}

static struct metrics_caller *free_place(struct metrics_server *metrics)
{
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        if (metrics->callers[i].fd < 0) {
            return &metrics->callers[i];
        }
    }
    return NULL;
}

static void take_call(struct metrics_server *metrics, struct metrics_caller *caller, int fd)
{
    caller->fd = fd;
    caller->deadline_ns = metrics->server->now_ns + PATIENCE_NS;
    caller->asked = caller->sent = 0;
    if (poller_add(metrics->server->poller, fd, READY_READ, caller) != 0) {
        hang_up(metrics, caller);
    }
}

static void accept_callers(struct metrics_server *metrics)
{
    struct metrics_caller *caller;
    int result = 0;
    while (result == 0 && (caller = free_place(metrics)) != NULL) {
        int fd;
        result = net_accept(listener_of(metrics), &fd);
        if (result == 0) {
            take_call(metrics, caller, fd);
        }
    }
    if (result < 0) {
        metrics->again_ns = metrics->server->now_ns + PAUSE_NS; /* no descriptors, most likely */
    }
    watch(metrics, result >= 0 && free_place(metrics) != NULL);
}

static struct metrics_caller *find_caller(struct metrics_server *metrics, const void *owner)
{
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        if (owner == &metrics->callers[i]) {
            return &metrics->callers[i];
        }
    }
    return NULL;
}

bool metrics_server_take_event(struct metrics_server *metrics, const void *owner)
{
    struct metrics_caller *caller = find_caller(metrics, owner);
    if (owner == &metrics->watched) {
        accept_callers(metrics);
    } else if (caller == NULL) {
        return false;
    } else if (caller->fd < 0) {
        return true; /* this turn has closed it already */
    } else if (caller->answer.length > 0) {
        send_rest(metrics, caller);
    } else {
        read_request(metrics, caller);
    }
    return true;
}

/* ----------------------------------------------------------------------- turns */

void metrics_server_turn(struct metrics_server *metrics)
{
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        struct metrics_caller *caller = &metrics->callers[i];
        if (caller->fd >= 0 && metrics->server->now_ns >= caller->deadline_ns) {
            hang_up(metrics, caller);
        }
    }
    if (metrics->again_ns != 0 && metrics->server->now_ns >= metrics->again_ns) {
        metrics->again_ns = 0;
        watch(metrics, free_place(metrics) != NULL);
    }
}

uint64_t metrics_server_deadline_ns(const struct metrics_server *metrics)
{
    uint64_t first = metrics->again_ns != 0 ? metrics->again_ns : UINT64_MAX;
    for (size_t i = 0; i < METRICS_CALLERS; i++) {
        const struct metrics_caller *caller = &metrics->callers[i];
        if (caller->fd >= 0 && caller->deadline_ns < first) {
            first = caller->deadline_ns;
        }
    }
    return first;
}
