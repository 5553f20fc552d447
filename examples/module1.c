/*
 * A module that asks and listens: publishes message1, subscribes to message2,
 * and sends the query query1, as the keyboard says.
 *
 * Type m to send message1, r to send query1 and see the response, q to quit.
 * To be run together with module2 or module3.
 */
#include <stdio.h>
#include <stdlib.h>

#include "ipc/ipc.h"

#include "module.h"

#define PI 3.14159265358979

static void msg2Handler(MSG_INSTANCE msgInstance, BYTE_ARRAY callData, void *clientData)
{
    MSG2_TYPE text;

    IPC_unmarshallData(IPC_msgInstanceFormatter(msgInstance), callData, &text, sizeof(text));
    printf("msg2Handler: Receiving %s (%s) [%s]\n", IPC_msgInstanceName(msgInstance), text,
           (char *)clientData);
    IPC_freeDataElements(IPC_msgInstanceFormatter(msgInstance), &text);
    IPC_freeByteArray(callData);
}

static void send_message(void)
{
    MSG1_TYPE i1 = 42;

    printf("\n  IPC_publishData(%s, &i1) [%d]\n", MSG1, i1);
    IPC_publishData(MSG1, &i1);
}

static void send_query(void)
{
    QUERY1_TYPE t1 = {666, SendVal, {{0.0, 1.0, 2.0}, {1.0, 2.0, 3.0}}, PI};
    void *response = NULL;

    printf("\n  IPC_queryResponseData(%s, &t1, &r1Ptr, IPC_WAIT_FOREVER)\n", QUERY1);
    /* Other handlers go on being called while this waits. */
    IPC_queryResponseData(QUERY1, &t1, &response, IPC_WAIT_FOREVER);
    printf("\n  Received response:\n");
    IPC_printData(IPC_msgFormatter(RESPONSE1), stdout, response);
    IPC_freeData(IPC_msgFormatter(RESPONSE1), response);
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
    if (fgets(line, sizeof(line), stdin) == NULL) {
        quit();
    }
    switch (line[0]) {
    case 'q':
    case 'Q':
        quit();
        break;
    case 'm':
    case 'M':
        send_message();
        break;
    case 'r':
    case 'R':
        send_query();
        break;
    default:
        printf("stdinHnd [%s]: Received %s", (char *)clientData, line);
        break;
    }
}

int main(void)
{
    /* Lines appear when they are written, and none hides in a buffer from IPC_subscribeFD(). */
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    setvbuf(stdin, NULL, _IONBF, 0);

    printf("\nIPC_connect(%s)\n", MODULE1_NAME);
    IPC_connect(MODULE1_NAME);

    /* Formats that other formats refer to by name. */
    printf("\nIPC_defineFormat(%s, %s)\n", T1_NAME, T1_FORMAT);
    IPC_defineFormat(T1_NAME, T1_FORMAT);
    printf("\nIPC_defineFormat(%s, %s)\n", T2_NAME, T2_FORMAT);
    IPC_defineFormat(T2_NAME, T2_FORMAT);

    /* The messages that this module sends. */
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", MSG1, MSG1_FORMAT);
    IPC_defineMsg(MSG1, IPC_VARIABLE_LENGTH, MSG1_FORMAT);
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", QUERY1, QUERY1_FORMAT);
    IPC_defineMsg(QUERY1, IPC_VARIABLE_LENGTH, QUERY1_FORMAT);

    /* The message that it receives.  The response to a query needs no subscription. */
    printf("\nIPC_subscribe(%s, msg2Handler, %s)\n", MSG2, MODULE1_NAME);
    IPC_subscribe(MSG2, msg2Handler, MODULE1_NAME);

    printf("\nIPC_subscribeFD(%d, stdinHnd, %s)\n", fileno(stdin), MODULE1_NAME);
    IPC_subscribeFD(fileno(stdin), stdinHnd, MODULE1_NAME);

    printf("\nType 'm' to send %s; Type 'r' to send %s; Type 'q' to quit\n", MSG1, QUERY1);
    IPC_dispatch();
    IPC_disconnect();
    return EXIT_FAILURE;
}
