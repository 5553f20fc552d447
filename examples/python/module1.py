"""A module that asks and listens: module1.c in Python.

Publishes message1 and the query query1 and subscribes to message2.  Type m to send message1, r to
send query1 and see the response, q to quit.  To be run together with module2.
"""
import sys

import ipc_cffi as IPC

from module import (MODULE1_NAME, MSG1, MSG1_FORMAT, MSG2, QUERY1, QUERY1_FORMAT, RESPONSE1,
                    T1, T1_FORMAT, T1_NAME, T2_FORMAT, T2_NAME, SendVal)


def msg2Handler(msgRef, callData, clientData):
    """Gets the bytes of message2 and unmarshalls them."""
    formatter = IPC.IPC_msgInstanceFormatter(msgRef)
    text, _ = IPC.IPC_unmarshall(formatter, callData)
    print(f"msg2Handler: Receiving {IPC.IPC_msgInstanceName(msgRef)} ({text}) [{clientData}]")


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
    elif line[0] in "mM":
        i1 = 42
        print(f"\n  IPC_publishData({MSG1}, {i1})")
        IPC.IPC_publishData(MSG1, i1)
    elif line[0] in "rR":
        t1 = T1()
        t1.i1 = 666
        t1.status = SendVal
        t1.matrix = ((0.0, 1.0, 2.0), (1.0, 2.0, 3.0))
        t1.d1 = 3.14159
        print(f"\n  IPC_queryResponseData({QUERY1}, {t1}, IPC_WAIT_FOREVER, {T1.__name__})")
        # Other handlers go on being called while this waits.
        r1, _ = IPC.IPC_queryResponseData(QUERY1, t1, IPC.IPC_WAIT_FOREVER, T1)
        print("\n  Received response")
        IPC.IPC_printData(IPC.IPC_msgFormatter(RESPONSE1), sys.stdout, r1)
    else:
        print(f"stdinHnd [{clientData}]: Received {line}", end="")


def handlerChangeHnd(msgName, num, _clientData):
    """Is told how many handlers a message has now."""
    print(f"HANDLER CHANGE: {msgName}: {num}")


def handlerChangeHnd2(msgName, num, _clientData):
    """The same."""
    print(f"HANDLER CHANGE2: {msgName}: {num}")


def connect1Hnd(moduleName, _clientData):
    """Is told who connects."""
    print(f"CONNECT1: Connection from {moduleName}")
    print(f"          Confirming connection ({IPC.IPC_isModuleConnected(moduleName):d})")


def connect2Hnd(moduleName, _clientData):
    """The same."""
    print(f"CONNECT2: Connection from {moduleName}")
    print(f"          Number of handlers: {IPC.IPC_numHandlers(MSG1)}")


first = True


def disconnect1Hnd(moduleName, _clientData):
    """Is told who leaves, and ends some of the subscriptions."""
    global first
    print("DISCONNECT:", moduleName)
    IPC.IPC_unsubscribeConnect(connect1Hnd if first else connect2Hnd)
    IPC.IPC_unsubscribeHandlerChange(MSG1, handlerChangeHnd2 if first else handlerChangeHnd)
    first = False


def main():
    """Connects, defines and subscribes, and listens until it is told to quit."""
    # Connect to the central server
    print(f"\nIPC.IPC_connect({MODULE1_NAME})")
    IPC.IPC_connect(MODULE1_NAME)
    IPC.IPC_subscribeConnect(connect1Hnd, None)
    IPC.IPC_subscribeConnect(connect2Hnd, None)
    IPC.IPC_subscribeDisconnect(disconnect1Hnd, None)

    # Define the named formats that the modules need
    print(f"\nIPC.IPC_defineFormat({T1_NAME}, {T1_FORMAT})")
    IPC.IPC_defineFormat(T1_NAME, T1_FORMAT)
    print(f"\nIPC.IPC_defineFormat({T2_NAME}, {T2_FORMAT})")
    IPC.IPC_defineFormat(T2_NAME, T2_FORMAT)

    # Define the messages that this module publishes
    print(f"\nIPC.IPC_defineMsg({MSG1}, IPC_VARIABLE_LENGTH, {MSG1_FORMAT})")
    IPC.IPC_defineMsg(MSG1, IPC.IPC_VARIABLE_LENGTH, MSG1_FORMAT)
    IPC.IPC_subscribeHandlerChange(MSG1, handlerChangeHnd, None)
    IPC.IPC_subscribeHandlerChange(MSG1, handlerChangeHnd2, None)
    print(f"\nIPC.IPC_defineMsg({QUERY1}, IPC_VARIABLE_LENGTH, {QUERY1_FORMAT})")
    IPC.IPC_defineMsg(QUERY1, IPC.IPC_VARIABLE_LENGTH, QUERY1_FORMAT)
    IPC.IPC_subscribeHandlerChange(QUERY1, handlerChangeHnd, None)

    # Subscribe to the messages that this module listens to.  There is no need to subscribe to
    # RESPONSE1: it is a response to a query, not a regular subscription.
    print(f"\nIPC.IPC_subscribe({MSG2}, msg2Handler, {MODULE1_NAME})")
    IPC.IPC_subscribe(MSG2, msg2Handler, MODULE1_NAME)

    # Subscribe a handler for the keyboard
    print(f"\nIPC.IPC_subscribeFD({sys.stdin.fileno()}, stdinHnd, {MODULE1_NAME})")
    IPC.IPC_subscribeFD(sys.stdin.fileno(), stdinHnd, MODULE1_NAME)

    print(f"\nType 'm' to send {MSG1}; Type 'r' to send {QUERY1}; Type 'q' to quit", flush=True)
    while not done:
        result = IPC.IPC_listen(250)
        sys.stdout.flush()
        if result == IPC.IPC_Error and not done:
            sys.exit(1)  # The server has gone; that has been printed
    IPC.IPC_disconnect()


if __name__ == "__main__":
    IPC.IPC_setVerbosity(IPC.IPC_Print_Errors)
    main()
