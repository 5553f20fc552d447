/*
 * A module that listens and answers: subscribes to message1 and to the query
 * query1, to which it publishes message2 and responds with response1.
 *
 * Type q to quit.  To be run together with module1.
 */
#include <stdio.h>
#include <stdlib.h>

#include "ipc/ipc.h"

#include "module.h"

static void msg1Handler(MSG_INSTANCE msgInstance, BYTE_ARRAY callData, void *clientData)
{
    MSG1_TYPE i1;

    IPC_unmarshallData(IPC_msgInstanceFormatter(msgInstance), callData, &i1, sizeof(i1));
    printf("msg1Handler: Receiving %s (%d) [%s]\n", IPC_msgInstanceName(msgInstance), i1,
           (char *)clientData);
    IPC_freeByteArray(callData);
}

static void queryHandler(MSG_INSTANCE msgInstance, BYTE_ARRAY callData, void *clientData)
{
    QUERY1_TYPE t1;
    MSG2_TYPE text = "Hello, world";
    RESPONSE1_TYPE t2;

    printf("queryHandler: Receiving %s [%s]\n", IPC_msgInstanceName(msgInstance),
           (char *)clientData);
    IPC_unmarshallData(IPC_msgInstanceFormatter(msgInstance), callData, &t1, sizeof(t1));
    IPC_printData(IPC_msgInstanceFormatter(msgInstance), stdout, &t1);

    /* All who subscribe get this.  Data are passed by pointer, strings too. */
    printf("\n  IPC_publishData(%s, &str1) [%s]\n", MSG2, text);
    IPC_publishData(MSG2, &text);

    /* Only the module that asked gets this. */
    t2.str1 = text;
    t2.count = 1;
    t2.t1 = &t1;
    t2.status = ReceiveVal;
    printf("\n  IPC_respondData(%p, %s, &t2)\n", (void *)msgInstance, RESPONSE1);
    IPC_respondData(msgInstance, RESPONSE1, &t2);

    IPC_freeByteArray(callData);
}

static void quit(void)
{
    IPC_disconnect();
    exit(EXIT_SUCCESS);
}

/* Is called when there is a line to read, or no line will come any more. */
static void stdinHnd(int fd, void *clientData)
{
    char line[81];

    (void)fd;
    if (fgets(line, sizeof(line), stdin) == NULL || line[0] == 'q' || line[0] == 'Q') {
        quit();
    }
    printf("stdinHnd [%s]: Received %s", (char *)clientData, line);
}

int main(void)
{
    /* Lines appear when they are written, and none hides in a buffer from IPC_subscribeFD(). */
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    setvbuf(stdin, NULL, _IONBF, 0);

    printf("\nIPC_connect(%s)\n", MODULE2_NAME);
    IPC_connect(MODULE2_NAME);

    /* The messages that this module sends.  module1 defines the formats they use. */
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", MSG2, MSG2_FORMAT);
    IPC_defineMsg(MSG2, IPC_VARIABLE_LENGTH, MSG2_FORMAT);
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", RESPONSE1, RESPONSE1_FORMAT);
    IPC_defineMsg(RESPONSE1, IPC_VARIABLE_LENGTH, RESPONSE1_FORMAT);

    /* The messages that it receives. */
    printf("\nIPC_subscribe(%s, msg1Handler, %s)\n", MSG1, MODULE2_NAME);
    IPC_subscribe(MSG1, msg1Handler, MODULE2_NAME);
    printf("\nIPC_subscribe(%s, queryHandler, %s)\n", QUERY1, MODULE2_NAME);
    IPC_subscribe(QUERY1, queryHandler, MODULE2_NAME);

    printf("\nIPC_subscribeFD(%d, stdinHnd, %s)\n", fileno(stdin), MODULE2_NAME);
    IPC_subscribeFD(fileno(stdin), stdinHnd, MODULE2_NAME);

    printf("\nType 'q' to quit\n");
    IPC_dispatch();
    IPC_disconnect();
    return EXIT_FAILURE;
}
