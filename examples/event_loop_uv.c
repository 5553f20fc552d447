/*
 * A module in the event loop of libuv.
 *
 * As event_loop.c, in a loop that waits by itself: it is told of the library's
 * descriptor once, and of its next time-out before each time that it waits.  The module
 * answers "question" with "answer", ticks ten times a second, and ends when its
 * standard input does.
 */
#include <stdio.h>
#include <unistd.h>

#include <uv.h>

#include <ipc/ipc.h>
#include <ipc/ipcx.h>

/* What connects the library with the loop. */
struct bridge {
    uv_poll_t readable;
    uv_timer_t due;
    uv_prepare_t before_waiting;
};

static void on_readable(uv_poll_t *handle, int status, int events)
{
    (void)handle;
    (void)status;
    (void)events;
    IPCx_process();
}

static void on_due(uv_timer_t *timer)
{
    (void)timer;
    IPCx_process();
}

/* Any callback may have called the library since the loop last waited. */
static void before_waiting(uv_prepare_t *prepare)
{
    struct bridge *bridge = prepare->data;
    long timeout = IPCx_nextTimeout();

    if (timeout < 0) {
        uv_timer_stop(&bridge->due);
    } else {
        uv_timer_start(&bridge->due, on_due, (uint64_t)timeout, 0);
    }
}

static void bridge_open(struct bridge *bridge, uv_loop_t *loop)
{
    uv_poll_init(loop, &bridge->readable, IPCx_fd());
    uv_poll_start(&bridge->readable, UV_READABLE, on_readable);
    uv_timer_init(loop, &bridge->due);
    uv_prepare_init(loop, &bridge->before_waiting);
    bridge->before_waiting.data = bridge;
    uv_prepare_start(&bridge->before_waiting, before_waiting);
}

static void bridge_close(struct bridge *bridge)
{
    uv_close((uv_handle_t *)&bridge->readable, NULL);
    uv_close((uv_handle_t *)&bridge->due, NULL);
    uv_close((uv_handle_t *)&bridge->before_waiting, NULL);
}

static void on_question(MSG_INSTANCE question, void *data, void *client_data)
{
    int answer = 2 * *(int *)data;

    (void)client_data;
    printf("asked about %d\n", *(int *)data);
    IPC_respondData(question, "answer", &answer);
    IPC_freeData(IPC_msgInstanceFormatter(question), data);
}

static void on_tick(void *client_data, unsigned long now, unsigned long scheduled)
{
    int *n_ticks = client_data;

    (void)now;
    (void)scheduled;
    (*n_ticks)++;
}

/* A key ends the module as well: nothing is open then that the loop runs for. */
static void on_input(uv_poll_t *input, int status, int events)
{
    (void)status;
    (void)events;
    bridge_close(input->data);
    uv_close((uv_handle_t *)input, NULL);
}

int main(void)
{
    int n_ticks = 0;
    uv_loop_t *loop = uv_default_loop();
    struct bridge bridge;
    uv_poll_t input;

    setvbuf(stdout, NULL, _IOLBF, 0);
    IPC_connect("event_loop_uv");
    IPC_defineMsg("question", IPC_VARIABLE_LENGTH, "int");
    IPC_defineMsg("answer", IPC_VARIABLE_LENGTH, "int");
    IPC_subscribeData("question", on_question, NULL);
    IPC_addPeriodicTimer(100, on_tick, &n_ticks);

    bridge_open(&bridge, loop);
    uv_poll_init(loop, &input, STDIN_FILENO);
    input.data = &bridge;
    uv_poll_start(&input, UV_READABLE, on_input);
    printf("ready\n");

    uv_run(loop, UV_RUN_DEFAULT);
    printf("%s\n", n_ticks > 0 ? "ticked" : "did not tick");
    IPC_disconnect();
    uv_loop_close(loop);
    return 0;
}
