"""A module that answers: module2.c in Python.

Publishes message2 and subscribes to message1 and query1.  When a query arrives it publishes
message2 and responds with response1.  Type q to quit.  To be run together with module1.
"""
import sys

import ipc_cffi as IPC

from module import (MODULE2_NAME, MSG1, MSG2, MSG2_FORMAT, QUERY1, RESPONSE1, RESPONSE1_FORMAT,
                    T1, T2, ReceiveVal)


def msg1Handler(msgRef, callData, clientData):
    """Gets the number that message1 is."""
    print(f"msg1Handler: Receiving {IPC.IPC_msgInstanceName(msgRef)} ({callData}) [{clientData}]")


def queryHandler(msgRef, t1, clientData):
    """Gets the structure of a query, and answers it."""
    print(f"queryHandler: Receiving {IPC.IPC_msgInstanceName(msgRef)} [{clientData}]")
    IPC.IPC_printData(IPC.IPC_msgInstanceFormatter(msgRef), sys.stdout, t1)

    # Publish this message -- all subscribers get it
    str1 = "Hello, world"
    print(f'\n  IPC.IPC_publishData({MSG2}, "{str1}")')
    IPC.IPC_publishData(MSG2, str1)

    t2 = T2()
    t2.str1 = str1
    # Variable length array of one element
    t2.t1 = [t1]
    t2.count = 1
    t2.status = ReceiveVal
    # Respond with this message -- only the module that asked gets it
    print(f"\n  IPC.IPC_respondData({msgRef}, {RESPONSE1}, {t2})")
    IPC.IPC_respondData(msgRef, RESPONSE1, t2)


done = False
# Unbuffered, so that no line hides from IPC_subscribeFD
keyboard = open(sys.stdin.fileno(), "rb", buffering=0, closefd=False)


def stdinHnd(_fd, clientData):
    """Is called when there is a line to read, or no line will come any more."""
    global done
    line = keyboard.readline().decode()
    if not line or line[0] in "qQ":
        IPC.IPC_disconnect()
        done = True
    else:
        print(f"stdinHnd [{clientData}]: Received {line}", end="")


def main():
    """Connects, defines and subscribes, and listens until it is told to quit."""
    # Connect to the central server
    print(f"\nIPC.IPC_connect({MODULE2_NAME})")
    IPC.IPC_connect(MODULE2_NAME)

    # Define the messages that this module publishes
    print(f"\nIPC.IPC_defineMsg({MSG2}, IPC_VARIABLE_LENGTH, {MSG2_FORMAT})")
    IPC.IPC_defineMsg(MSG2, IPC.IPC_VARIABLE_LENGTH, MSG2_FORMAT)
    print(f"\nIPC.IPC_defineMsg({RESPONSE1}, IPC_VARIABLE_LENGTH, {RESPONSE1_FORMAT})")
    IPC.IPC_defineMsg(RESPONSE1, IPC.IPC_VARIABLE_LENGTH, RESPONSE1_FORMAT)

    # Subscribe to the messages that this module listens to
    print(f"\nIPC.IPC_subscribeData({MSG1}, {msg1Handler.__name__}, {MODULE2_NAME})")
    IPC.IPC_subscribeData(MSG1, msg1Handler, MODULE2_NAME)
    print(f"\nIPC.IPC_subscribeData({QUERY1}, {queryHandler.__name__}, {MODULE2_NAME}, "
          f"{T1.__name__})")
    IPC.IPC_subscribeData(QUERY1, queryHandler, MODULE2_NAME, T1)

    # Subscribe a handler for the keyboard
    print(f"\nIPC_subscribeFD({sys.stdin.fileno()}, stdinHnd, {MODULE2_NAME})")
    IPC.IPC_subscribeFD(sys.stdin.fileno(), stdinHnd, MODULE2_NAME)

    print("\nType 'q' to quit", flush=True)
    while not done:
        result = IPC.IPC_listen(250)
        sys.stdout.flush()
        if result == IPC.IPC_Error and not done:
            sys.exit(1)  # The server has gone; that has been printed
    IPC.IPC_disconnect()


if __name__ == "__main__":
    IPC.IPC_setVerbosity(IPC.IPC_Print_Errors)
    main()
