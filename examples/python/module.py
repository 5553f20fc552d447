"""The messages of the example modules, their formats and classes: module.h in Python."""
import ipc_cffi as IPC

WaitVal, SendVal, ReceiveVal, ListenVal = range(4)


class T1(IPC.IPCdata):
    """The structure of T1_FORMAT."""
    _fields = ("i1", "status", "matrix", "d1")


class T2(IPC.IPCdata):
    """The structure of T2_FORMAT; the elements of t1 are of class T1."""
    _fields = ("str1", "count", ("t1", T1), "status")


T1_NAME = "T1"
# First form of "enum": 3 is the largest value, that of ListenVal.
T1_FORMAT = "{int, {enum : 3}, [double:2,3], double}"

T2_NAME = "T2"
# Alternate form of "enum".
T2_FORMAT = "{string, int, <T1:2>, {enum WaitVal, SendVal, ReceiveVal, ListenVal}}"

MSG1 = "message1"
MSG1_FORMAT = "int"

MSG2 = "message2"
MSG2_FORMAT = "string"

QUERY1 = "query1"
QUERY1_FORMAT = T1_NAME

RESPONSE1 = "response1"
RESPONSE1_FORMAT = T2_NAME

MODULE1_NAME = "module1"
MODULE2_NAME = "module2"
MODULE3_NAME = "module3"
