/*
 * A module in C for values of any format: gets them decoded, prints them, and sends them back.
 *
 * Each line of its standard input is a number N and a format.  From then on what arrives as thereN is
 * printed by IPC_printData and published as backN, and the query askN is answered by backN.  Uses only
 * functions of ipc.h, for libraries of CMU IPC too.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ipc.h"

static void handle(MSG_INSTANCE instance, void *data, void *back)
{
    const FORMATTER_PTR formatter = IPC_msgInstanceFormatter(instance);
    if (strncmp(IPC_msgInstanceName(instance), "ask", 3) == 0) {
        IPC_respondData(instance, back, data);
    } else {
        IPC_printData(formatter, stdout, data);
        printf("end\n");
        fflush(stdout);
        IPC_publishData(back, data);
    }
    IPC_freeData(formatter, data);
}

static char *name_of(const char *stem, int number)
{
    char *name = malloc(20);
    sprintf(name, "%s%d", stem, number);
    return name;
}

static void on_line(int fd, void *client_data)
{
    static char line[65536];
    int number;
    int skipped;
    (void)fd;
    (void)client_data;
    if (fgets(line, sizeof line, stdin) == NULL || sscanf(line, "%d %n", &number, &skipped) != 1) {
        IPC_disconnect();
        exit(EXIT_SUCCESS);
    }
    line[strcspn(line, "\n")] = '\0';
    /* The names are kept by their handlers. */
    char *const there = name_of("there", number);
    char *const back = name_of("back", number);
    char *const ask = name_of("ask", number);
    IPC_defineMsg(there, IPC_VARIABLE_LENGTH, line + skipped);
    IPC_defineMsg(back, IPC_VARIABLE_LENGTH, line + skipped);
    IPC_defineMsg(ask, IPC_VARIABLE_LENGTH, line + skipped);
    IPC_subscribeData(there, handle, back);
    IPC_subscribeData(ask, handle, back);
    printf("ready %d\n", number);
    fflush(stdout);
}

int main(void)
{
    setvbuf(stdin, NULL, _IONBF, 0); /* no line hides in a buffer */
    IPC_connect("echo");
    IPC_subscribeFD(fileno(stdin), on_line, NULL);
    printf("started\n");
    fflush(stdout);
    IPC_dispatch();
    return EXIT_FAILURE;
}
