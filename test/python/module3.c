/*
 * The module3 of Appendix A in C: only listens, to the bytes of message1 and message2, and unmarshalls
 * them by itself.  Type q to quit.  Uses only functions of ipc.h, for libraries of CMU IPC too.
 */
#include <stdio.h>
#include <stdlib.h>

#include "ipc.h"

static char name[] = "module3";

static void on_number(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = 0;
    IPC_unmarshallData(IPC_msgInstanceFormatter(instance), content, &number, sizeof number);
    IPC_freeByteArray(content);
    printf("msg1Handler: Receiving %s (%d) [%s]\n", IPC_msgInstanceName(instance), number,
           (char *)client_data);
}

static void on_text(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    char *text = NULL;
    IPC_unmarshallData(IPC_msgInstanceFormatter(instance), content, &text, sizeof text);
    IPC_freeByteArray(content);
    printf("msg2Handler: Receiving %s (%s) [%s]\n", IPC_msgInstanceName(instance), text,
           (char *)client_data);
    IPC_freeDataElements(IPC_msgInstanceFormatter(instance), &text);
}

static void on_line(int fd, void *client_data)
{
    char line[81];
    (void)fd;
    (void)client_data;
    if (fgets(line, sizeof line, stdin) == NULL || line[0] == 'q') {
        IPC_disconnect();
        exit(EXIT_SUCCESS);
    }
}

int main(void)
{
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    setvbuf(stdin, NULL, _IONBF, 0);
    IPC_connect(name);
    IPC_subscribe("message1", on_number, name);
    IPC_subscribe("message2", on_text, name);
    IPC_subscribeFD(fileno(stdin), on_line, NULL);
    printf("Type 'q' to quit\n");
    IPC_dispatch();
    return EXIT_FAILURE;
}
