/*
 * module2 in another manner: handlers that get their data unmarshalled, a
 * response that is given later, from a timer, and notice of modules that come
 * and go.
 *
 * Type q to quit.  To be run together with module1, instead of module2.
 */
#include <stdio.h>
#include <stdlib.h>

#include "ipc/ipc.h"

#include "module.h"

#define DELAY_MSECS 500

/* A query that waits for its response. */
struct pending_query {
    MSG_INSTANCE instance;
    QUERY1_PTR data; /* to be freed with the formatter */
    FORMATTER_PTR formatter;
};

static void msg1Handler(MSG_INSTANCE msgInstance, void *callData, void *clientData)
{
    MSG1_PTR i1 = callData;

    printf("msg1Handler: Receiving %s (%d) [%s]\n", IPC_msgInstanceName(msgInstance), *i1,
           (char *)clientData);
    IPC_freeData(IPC_msgInstanceFormatter(msgInstance), callData);
}

/* Is called by the timer: the time to answer has come. */
static void respond(void *clientData, unsigned long currentTime, unsigned long scheduledTime)
{
    struct pending_query *query = clientData;
    MSG2_TYPE text = "Hello, world";
    RESPONSE1_TYPE t2;

    (void)currentTime;
    (void)scheduledTime;
    t2.str1 = text;
    t2.count = 1;
    t2.t1 = query->data;
    t2.status = ReceiveVal;
    printf("\n  IPC_publishData(%s, &str1) [%s]\n", MSG2, text);
    IPC_publishData(MSG2, &text);
    printf("\n  IPC_respondData(%p, %s, &t2)\n", (void *)query->instance, RESPONSE1);
    IPC_respondData(query->instance, RESPONSE1, &t2);

    IPC_freeData(query->formatter, query->data);
    free(query);
}

static void queryHandler(MSG_INSTANCE msgInstance, void *callData, void *clientData)
{
    struct pending_query *query = malloc(sizeof(*query));
    TIMER_REF timer;

    if (query == NULL) {
        abort();
    }
    query->instance = msgInstance;
    query->data = callData;
    query->formatter = IPC_msgInstanceFormatter(msgInstance);

    printf("queryHandler: Receiving %s [%s]\n", IPC_msgInstanceName(msgInstance),
           (char *)clientData);
    IPC_printData(query->formatter, stdout, callData);

    /* The instance stays valid until it is answered; each query has its own timer. */
    IPC_delayResponse(msgInstance);
    IPC_addTimerGetRef(DELAY_MSECS, 1, respond, query, &timer);
}

static void connectHandler(const char *moduleName, void *clientData)
{
    printf("connectHandler: %s has connected [%s]\n", moduleName, (char *)clientData);
}

static void disconnectHandler(const char *moduleName, void *clientData)
{
    printf("disconnectHandler: %s has disconnected [%s]\n", moduleName, (char *)clientData);
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

    printf("\nIPC_connect(%s)\n", MODULE3_NAME);
    IPC_connect(MODULE3_NAME);

    /* Messages go on arriving while a response is due. */
    printf("\nIPC_setCapacity(4)\n");
    IPC_setCapacity(4);

    /* The messages that this module sends.  module1 defines the formats they use. */
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", MSG2, MSG2_FORMAT);
    IPC_defineMsg(MSG2, IPC_VARIABLE_LENGTH, MSG2_FORMAT);
    printf("\nIPC_defineMsg(%s, IPC_VARIABLE_LENGTH, %s)\n", RESPONSE1, RESPONSE1_FORMAT);
    IPC_defineMsg(RESPONSE1, IPC_VARIABLE_LENGTH, RESPONSE1_FORMAT);

    /* The messages and notices that it receives. */
    printf("\nIPC_subscribeData(%s, msg1Handler, %s)\n", MSG1, MODULE3_NAME);
    IPC_subscribeData(MSG1, msg1Handler, MODULE3_NAME);
    printf("\nIPC_subscribeData(%s, queryHandler, %s)\n", QUERY1, MODULE3_NAME);
    IPC_subscribeData(QUERY1, queryHandler, MODULE3_NAME);
    printf("\nIPC_subscribeConnect(connectHandler, %s)\n", MODULE3_NAME);
    IPC_subscribeConnect(connectHandler, MODULE3_NAME);
    printf("\nIPC_subscribeDisconnect(disconnectHandler, %s)\n", MODULE3_NAME);
    IPC_subscribeDisconnect(disconnectHandler, MODULE3_NAME);

    printf("\nIPC_subscribeFD(%d, stdinHnd, %s)\n", fileno(stdin), MODULE3_NAME);
    IPC_subscribeFD(fileno(stdin), stdinHnd, MODULE3_NAME);

    printf("\nType 'q' to quit\n");
    IPC_dispatch();
    IPC_disconnect();
    return EXIT_FAILURE;
}
