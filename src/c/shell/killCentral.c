/*
 * killCentral [host[:port]]: ends the server in good order.
 */
#include <stdio.h>
#include <string.h>

#include <ipc/ipc.h>
#include <ipc/ipcx.h>

static const char usage[] =
    "Usage: killCentral [HOST[:PORT]]\n"
    "\n"
    "Ends the IPC server of this machine that listens there (default: CENTRALHOST, or\n"
    "port 1381) in good order, and waits until it has ended.\n"
    "\n"
    "Exit status: 0 it has ended; 1 it has not; 2 wrong usage.\n";

static int explain(const char *server)
{
    fprintf(stderr,
            IPC_errno == IPC_Not_Connected
                ? "killCentral: no server listens on %s\n"
                : "killCentral: the server on %s runs on another machine or as another user; "
                  "end it there\n",
            server);
    return 1;
}

int main(int argc, char **argv)
{
    const char *server = argc > 1 ? argv[1] : NULL;
    if (argc > 1 && (strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "--help") == 0)) {
        fputs(usage, stdout);
        return 0;
    }
    if (argc > 2 || (server != NULL && server[0] == '-')) {
        fputs(usage, stderr);
        return 2;
    }
    IPC_setVerbosity(IPC_Silent);
    switch (IPCx_killCentral(server)) {
    case IPC_OK:
        return 0;
    case IPC_Timeout:
        fprintf(stderr, "killCentral: the server was asked to end and has not done so\n");
        return 1;
    case IPC_Error:
    default:
        return explain(server != NULL ? server : "CENTRALHOST");
    }
}
