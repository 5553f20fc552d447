/*
 * killModule NAME [host[:port]]: ends the modules of that name.
 */
#include <stdio.h>
#include <string.h>

#include <ipc/ipc.h>
#include <ipc/ipcx.h>

static const char usage[] =
    "Usage: killModule NAME [HOST[:PORT]]\n"
    "\n"
    "Asks the processes of all modules that are connected under that name to the IPC server\n"
    "there (default: CENTRALHOST, or port 1381 of this machine) to end, and waits until the\n"
    "server has noticed.  The modules have to run on this machine.\n"
    "\n"
    "Exit status: 0 they have ended; 1 they have not; 2 wrong usage.\n";

static const char *reason(void)
{
    switch (IPC_errno) {
    case IPC_Argument_Out_Of_Range:
        return "no module of that name is connected";
    case IPC_Message_Not_Defined:
        return "a server of CMU IPC does not know the processes of its modules; end it by its "
               "process id";
    case IPC_Not_Connected:
        return "no server listens there";
    default:
        return "it runs on another machine or as another user; end it there";
    }
}

int main(int argc, char **argv)
{
    if (argc > 1 && (strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "--help") == 0)) {
        fputs(usage, stdout);
        return 0;
    }
    if (argc < 2 || argc > 3 || argv[1][0] == '\0' || argv[1][0] == '-') {
        fputs(usage, stderr);
        return 2;
    }
    IPC_setVerbosity(IPC_Silent);
    switch (IPCx_killModule(argv[1], argc > 2 ? argv[2] : NULL)) {
    case IPC_OK:
        return 0;
    case IPC_Timeout:
        fprintf(stderr, "killModule: %s was asked to end and has not done so\n", argv[1]);
        return 1;
    case IPC_Error:
    default:
        fprintf(stderr, "killModule: %s: %s\n", argv[1], reason());
        return 1;
    }
}
