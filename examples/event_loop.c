/*
 * A module in an event loop that is not the library's.
 *
 * The loop here is poll; any other one waits for the same two things, a descriptor
 * and a time.  The module answers "question" with "answer", ticks ten times a second,
 * and ends when its standard input does.
 */
#include <poll.h>
#include <stdio.h>
#include <unistd.h>

#include <ipc/ipc.h>
#include <ipc/ipcx.h>

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

int main(void)
{
    int n_ticks = 0;
    struct pollfd items[2] = {{STDIN_FILENO, POLLIN, 0}, {-1, POLLIN, 0}};

    setvbuf(stdout, NULL, _IOLBF, 0);
    IPC_connect("event_loop");
    IPC_defineMsg("question", IPC_VARIABLE_LENGTH, "int");
    IPC_defineMsg("answer", IPC_VARIABLE_LENGTH, "int");
    IPC_subscribeData("question", on_question, NULL);
    IPC_addPeriodicTimer(100, on_tick, &n_ticks);
    printf("ready\n");

    items[1].fd = IPCx_fd();
    while (items[0].revents == 0) {
        poll(items, 2, (int)IPCx_nextTimeout());
        IPCx_process();
    }
    printf("%s\n", n_ticks > 0 ? "ticked" : "did not tick");
    IPC_disconnect();
    return 0;
}
