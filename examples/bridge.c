/*
 * A bridge between two centrals: what is published under a name in one is published
 * in the other as well.
 *
 *     bridge SERVER1 SERVER2 MESSAGE...
 *
 * One loop serves both contexts.  A handler runs in the context that its message came
 * from, sets the other one, and publishes there.  Messages are passed on as bytes, so
 * the bridge need not know their formats; the other side defines them.
 */
#include <stdio.h>
#include <stdlib.h>

#include <ipc/ipc.h>

/* Passes a message on to the context that is the client data. */
static void pass_on(MSG_INSTANCE message, BYTE_ARRAY bytes, void *client_data)
{
    IPC_setContext(client_data);
    IPC_publish(IPC_msgInstanceName(message), IPC_dataLength(message), bytes);
    IPC_freeByteArray(bytes);
}

static IPC_CONTEXT_PTR connect_to(const char *server)
{
    if (IPC_connectModule("bridge", server) != IPC_OK) {
        fprintf(stderr, "bridge: no central on %s\n", server);
        exit(1);
    }
    return IPC_getContext();
}

int main(int argc, char **argv)
{
    IPC_CONTEXT_PTR from;
    IPC_CONTEXT_PTR to;
    int i;

    if (argc < 4) {
        fprintf(stderr, "usage: bridge SERVER1 SERVER2 MESSAGE...\n");
        return 2;
    }
    from = connect_to(argv[1]);
    to = connect_to(argv[2]);
    for (i = 3; i < argc; i++) {
        IPC_setContext(to);
        if (!IPC_isMsgDefined(argv[i])) {
            IPC_defineMsg(argv[i], IPC_VARIABLE_LENGTH, NULL);
        }
        IPC_setContext(from);
        IPC_subscribe(argv[i], pass_on, to);
    }
    printf("bridge: ready\n");
    fflush(stdout);
    IPC_dispatch();
    return 0;
}
