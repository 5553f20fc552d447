"""A module that only listens, and unmarshalls what it gets by itself.  Type q to quit."""
import sys

import ipc_cffi as IPC

from module import MODULE3_NAME, MSG1, MSG2


def handler(name):
    """A handler of bytes that goes by that name."""
    def unmarshall_and_print(msgRef, callData, clientData):
        data, _ = IPC.IPC_unmarshall(IPC.IPC_msgInstanceFormatter(msgRef), callData)
        print(f"{name}: Receiving {IPC.IPC_msgInstanceName(msgRef)} ({data}) [{clientData}]",
              flush=True)
    return unmarshall_and_print


# Unbuffered, so that no line hides from IPC_subscribeFD
keyboard = open(sys.stdin.fileno(), "rb", buffering=0, closefd=False)


def stdinHnd(_fd, _clientData):
    """Is called when there is a line to read, or no line will come any more."""
    line = keyboard.readline().decode()
    if not line or line[0] in "qQ":
        sys.exit()  # comes out of IPC_dispatch


def main():
    """Subscribes, and listens until it is told to quit."""
    IPC.IPC_connect(MODULE3_NAME)
    IPC.IPC_subscribe(MSG1, handler("msg1Handler"), MODULE3_NAME)
    IPC.IPC_subscribe(MSG2, handler("msg2Handler"), MODULE3_NAME)
    IPC.IPC_subscribeFD(sys.stdin, stdinHnd)
    print("Type 'q' to quit", flush=True)
    try:
        IPC.IPC_dispatch()
    finally:
        IPC.IPC_disconnect()


if __name__ == "__main__":
    main()
