/*
 * The loop: the server's sockets, streams and signals.
 */
#include "central/loop.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "central/routing/lifecycle.h"
#include "central/service/conversation.h"
#include "central/routing/ending.h"
#include "central/routing/outbox.h"
#include "central/routing/resend.h"
#include "central/routing/watch.h"
#include "platform/process.h"

enum {
    N_EVENTS = 128, /* taken from the poller at a time */
    LAST_WORDS_PAUSE_MS = 10
};

#define MS_NS UINT64_C(1000000)
#define LAST_WORDS_NS (1000 * MS_NS)

/* ------------------------------------------------------------------ life cycle */

int loop_init(struct loop *loop, struct server *server)
{
    memset(loop, 0, sizeof *loop);
    loop->server = server;
    loop->waker.read_fd = loop->waker.write_fd = -1;
    loop->poller = poller_new();
    console_init(&loop->console, server);
    listeners_init(&loop->listeners, server, &loop->waker);
    metrics_server_init(&loop->metrics, server);
    loop->console.may_ask = server->options->prompt || stream_is_terminal(STREAM_INPUT);
    if (loop->poller == NULL || waker_open(&loop->waker) != 0) {
        return ERR_IO;
    }
    server->poller = loop->poller;
    server->log.waker = &loop->waker;
    if (poller_add(loop->poller, loop->waker.read_fd, READY_READ, &loop->waker) != 0) {
        return ERR_IO;
    }
    return process_catch_signals(&loop->waker);
}

void loop_fini(struct loop *loop)
{
    presence_fini(&loop->presence);
    metrics_server_fini(&loop->metrics);
    listeners_fini(&loop->listeners);
    console_fini(&loop->console);
    loop->server->poller = NULL;
    log_close(&loop->server->log); /* the threads of its files wake the loop */
    poller_free(loop->poller);
    waker_close(&loop->waker);
}

/* -------------------------------------------------------------------- commands */

static void stop_reading_input(struct loop *loop)
{
    if (loop->reads_input && !loop->input_is_unwatched) {
        poller_remove(loop->poller, stream_watched(STREAM_INPUT));
    }
    loop->reads_input = false;
    resend_set_asking(loop->server, false);
    loop->input_is_unwatched = false;
}

static void start_reading_input(struct loop *loop)
{
    loop->reads_input = console_listens(&loop->console);
    if (loop->reads_input) {
        resend_set_asking(loop->server,
                          loop->console.may_ask && loop->server->options->read_commands);
        loop->input_is_unwatched =
            poller_add(loop->poller, stream_watched(STREAM_INPUT), READY_READ, &loop->console) != 0;
    }
}

static void read_commands(struct loop *loop)
{
    char bytes[4096];
    const ptrdiff_t n = stream_read(STREAM_INPUT, bytes, sizeof bytes);
    if (n > 0) {
        console_feed(&loop->console, bytes, (size_t)n);
    }
    if (n < 0) {
        console_end_input(&loop->console);
    }
    if (n < 0 || !console_listens(&loop->console)) {
        stop_reading_input(loop);
    }
}

static void take_signals(struct loop *loop)
{
    int number;
    waker_clear(&loop->waker);
    while ((number = process_take_signal()) != 0) {
        if (process_signal_ends(number)) {
            loop->signal = number;
            return;
        }
        log_reopen_files(&loop->server->log);
    }
}

/* --------------------------------------------------------------------- output */

/* Has the poller tell of what the module's socket is good for now. */
static void watch_socket(struct loop *loop, struct module *module)
{
    const bool has_unsent = !module->deaf && link_waiting(&module->link) > 0;
    const int wanted = (module_waits(module) ? 0 : READY_READ) | (has_unsent ? READY_WRITE : 0);
    if (module->polled != wanted) {
        module->polled = wanted;
        /* A failure means that the socket is gone, which reading will find. */
        (void)poller_change(loop->poller, module->link.fd, wanted, module);
    }
}

/* Writes what the kernel takes. */
static void write_to(struct loop *loop, struct module *module)
{
    if (!module->deaf && link_flush(&module->link) < 0) {
        module->deaf = true; /* what it has sent before it went is still heard */
    }
    watch_look_at(loop->server, module);
    watch_socket(loop, module);
}

static void flush_module(struct loop *loop, struct module *module)
{
    if (module->state != MODULE_ENDED) {
        write_to(loop, module);
        if (!module->deaf) {
            conversation_flushed(loop->server, module);
        }
    }
}

/* Takes the first module off a list of those to flush. */
static struct module *take_first(struct list *modules)
{
    struct module *module = LIST_OWNER(modules->next, struct module, in_flush);
    list_remove(&module->in_flush);
    module->urgent = false;
    return module;
}

/* Writes new values of watched variables, behind which everything else is still held: the modules
 * are flushed once more with the rest. */
static void write_news(struct loop *loop)
{
    struct server *server = loop->server;
    do {
        while (!list_is_empty(&server->urgent)) {
            struct module *module = take_first(&server->urgent);
            list_append(&server->flush, &module->in_flush);
            write_to(loop, module);
        }
    } while (watch_settle(server));
    outbox_let_go(server);
}

static void flush_all(struct loop *loop)
{
    struct server *server = loop->server;
    do {
        write_news(loop);
        while (!list_is_empty(&server->flush)) {
            flush_module(loop, take_first(&server->flush));
        }
    } while (server->holding || !list_is_empty(&server->urgent) || watch_settle(server));
}

/* Lets the logs write, and has the poller tell when a full terminal takes more. */
static void flush_logs(struct loop *loop)
{
    struct log *log = &loop->server->log;
    log_flush(log);
    const bool waits = sink_waiting(&log->terminal) > 0;
    if (waits && !loop->watches_output) {
        loop->watches_output = poller_add(loop->poller, stream_watched(STREAM_OUTPUT), READY_WRITE,
                                          &loop->watches_output) == 0;
    } else if (!waits && loop->watches_output) {
        poller_remove(loop->poller, stream_watched(STREAM_OUTPUT));
        loop->watches_output = false;
    }
}

/* ----------------------------------------------------------------------- turns */

static void handle_event(struct loop *loop, const struct poller_event *event)
{
    if (event->owner == &loop->waker) {
        take_signals(loop);
    } else if (event->owner == &loop->console) {
        read_commands(loop);
    } else if (event->owner != &loop->watches_output && /* logs are flushed in every turn */
               !listeners_take_event(&loop->listeners, event->owner) &&
               !metrics_server_take_event(&loop->metrics, event->owner)) {
        struct module *module = event->owner;
        if (event->found & READY_WRITE) {
            flush_module(loop, module);
        }
        if (event->found & READY_ERROR) {
            conversation_hung_up(loop->server, module);
        } else if (event->found & READY_READ) {
            conversation_read(loop->server, module);
        }
    }
}

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Milliseconds to wait, -1: until something happens. */
static int64_t time_to_wait(const struct loop *loop, uint64_t until)
{
    const struct server *server = loop->server;
    if (conversation_is_pending(server) || loop->input_is_unwatched) {
        return 0;
    }
    until = earlier(until, listeners_deadline_ns(&loop->listeners));
    until = earlier(until, metrics_server_deadline_ns(&loop->metrics));
    if (sink_waiting(&server->log.terminal) > 0 && !loop->watches_output) {
        until = earlier(until, server->now_ns + 100 * MS_NS);
    }
    if (until == UINT64_MAX) {
        return -1;
    }
    return until <= server->now_ns ? 0 : (int64_t)((until - server->now_ns) / MS_NS + 1);
}

/* Waits, and notes what is there. */
static void wait_for_events(struct loop *loop, int64_t timeout_ms)
{
    struct server *server = loop->server;
    struct poller_event events[N_EVENTS];
    const int n = poller_wait(loop->poller, events, N_EVENTS, timeout_ms);
    server_set_time(server, server->clock());
    for (int i = 0; i < n; i++) {
        handle_event(loop, &events[i]);
    }
    if (loop->input_is_unwatched) {
        read_commands(loop);
    }
}

static void turn(struct loop *loop)
{
    struct server *server = loop->server;
    const uint64_t patience_ends_ns = conversation_check_patience(server);
    const uint64_t sign_is_due_ns = presence_turn(&loop->presence, server->now_ns);
    wait_for_events(loop, time_to_wait(loop, earlier(patience_ends_ns, sign_is_due_ns)));
    listeners_turn(&loop->listeners);
    metrics_server_turn(&loop->metrics);
    conversation_turn(server);
    flush_all(loop);
    flush_logs(loop);
    if (server->log.summary_on) {
        server->statistics.working_ns += server->clock() - server->now_ns;
    }
    if (!list_is_empty(&server->ended)) {
        ending_sweep(server);
        listeners_have_room(&loop->listeners);
    }
}

/* Writes what modules and logs take; returns how many bytes are left. */
static uint64_t write_rest(struct loop *loop)
{
    struct server *server = loop->server;
    struct list *at, *following;
    log_flush(&server->log);
    uint64_t unsent = sink_waiting(&server->log.terminal);
    LIST_EACH (at, following, &server->modules) {
        struct module *module = LIST_OWNER(at, struct module, in_server);
        flush_module(loop, module);
        unsent += module->deaf ? 0 : link_waiting(&module->link);
    }
    return unsent;
}

void loop_say_last_words(struct loop *loop)
{
    const uint64_t end = clock_ns() + LAST_WORDS_NS;
    while (write_rest(loop) > 0 && clock_ns() < end) {
        (void)ready_wait(NULL, 0, LAST_WORDS_PAUSE_MS);
    }
}

void loop_run(struct loop *loop)
{
    start_reading_input(loop);
    console_prompt(&loop->console);
    flush_logs(loop);
    while (loop->signal == 0 && !loop->console.wants_to_quit) {
        turn(loop);
    }
}
