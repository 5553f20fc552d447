"""The messages that library and central exchange about themselves."""
import dataclasses

from support.frame import BROADCAST, INFORM, QUERY

NAME_LIST = "{int, int, <string:2>}"
HANDLER_LIST = "{int, <{int, int, int, int, string, string}:1>}"
LOG_OPTIONS = "{*int, int, int, int, int, int, int, int, int, int, int, int}"
MESSAGE_INFO = "*{int, string, int, format, format}"
BROADCASTS = "X_IPC_BROADCAST_MSG_VAR"
TAPPED = "X_IPC_TAPPED_MSG_VAR"
WATCH_BROADCASTS = "V_watch_" + BROADCASTS
VARIABLES = {
    BROADCASTS: NAME_LIST, TAPPED: NAME_LIST,
    "CENTRAL_TERMINAL_LOG_VAR": LOG_OPTIONS, "CENTRAL_FILE_LOG_VAR": LOG_OPTIONS,
}


@dataclasses.dataclass(frozen=True)
class Message:
    """What is fixed about one library message."""

    name: str
    cls: int
    request: str
    reply: str = None
    alias: str = None


def _all():
    query, inform = QUERY, INFORM
    yield Message("x_ipc_msgInfoMsg", query, "{string, string}", MESSAGE_INFO, "msgInfoMsg")
    yield Message("x_ipc_classInfoMsg", query, "int", "*{int, format}", "classInfoMsg")
    yield Message("x_ipc_newModuleConnectMsg", query, "{string, string}",
                  "{{int, int}, boolean}", "newModuleConnectMsg")
    yield Message("x_ipc_waitMsg", query, None, "int", "waitMsg")
    yield Message("x_ipc_CloseMsg", inform, None, None, "x_ipcCloseMsg")
    yield Message("x_ipc_registerMessageMsg", inform, "{string, int, string, string}", None,
                  "registerMessageMsg")
    yield Message("x_ipc_registerHandlerMsg", inform, "{int, string, string}", None,
                  "registerHandlerMsg")
    yield Message("x_ipc_deregisterHandlerMsg", inform, "{int, string, string}", None,
                  "deregisterHandlerMsg")
    yield Message("x_ipc_registerNamedFormMsg", inform, "{string, string}", None,
                  "registerNamedFormMsg")
    yield Message("x_ipc_getNamedFormMsg", query, "string", "format")
    yield Message("x_ipc_registerResourceMsg", inform, "{int, string}", None,
                  "registerResourceMsg")
    yield Message("x_ipc_limitPendingMsg", inform, "{string, string, int}", None,
                  "limitPendingMsg")
    yield Message("ipc_setMsgPriority", inform, "{string, int}")
    yield Message("x_ipc_moduleConnectedQ", query, "string", "int")
    yield Message("x_ipc_directMsgQuery", query, "string", HANDLER_LIST)
    yield Message("x_ipc_notifyHandlerChange", inform, "string")
    yield Message("x_ipc_connectNotify", BROADCAST, "string")
    yield Message("x_ipc_disconnectNotify", BROADCAST, "string")
    yield Message("x_ipc_directResMsg", inform, "{int, string}", None, "directResMsg")
    yield Message("x_ipc_hndInfoMsg", query, "{string, string}", "{string, string}", "hndInfoMsg")
    yield Message("x_ipc_getMessages", query, None, NAME_LIST)
    yield Message("x_ipc_getMessageInfo", query, "{string}",
                  "{string, string, string, int, string, int}")
    yield Message("x_ipc_directInfoMsg", query, "string", "{int, int, int, int, string, string}",
                  "directInfoMsg")
    yield Message("x_ipc_moduleProvides", inform, NAME_LIST)
    yield Message("x_ipc_moduleRequires", inform, NAME_LIST)
    yield Message("x_ipc_available", query, None, NAME_LIST)
    yield Message("x_ipc_ignoreLogging", inform, "string", None, "ignoreLogging")
    yield Message("x_ipc_resumeLogging", inform, "string", None, "resumeLogging")
    yield Message("x_ipc_addHndToResourceMsg", inform, "{string, string}", None,
                  "addHndToResourceMsg")
    yield Message("x_ipc_reserveResourceMsg", query, "string", "int")
    yield Message("x_ipc_reserveModResourceMsg", query, "{string, string}", "int",
                  "reserveModResourceMsg")
    yield Message("x_ipc_cancelReservationMsg", inform, "int", None, "cancelReservationMsg")
    yield Message("x_ipc_lockResourceMsg", query, "string", "int", "lockResourceMsg")
    yield Message("x_ipc_lockModResourceMsg", query, "{string, string}", "int",
                  "lockModResourceMsg")
    yield Message("x_ipc_unlockResourceMsg", inform, "int", None, "unlockResourceMsg")
    yield Message("x_ipc_tapMessage", inform, "{int, string, string}", None, "tapMessage")
    yield Message("x_ipc_removeTap", inform, "{int, string, string}", None, "removeTap")
    yield Message("x_ipc_tapReference", inform, "{int, X_IPC_REF_PTR, string}", None,
                  "tapReference")
    yield Message("x_ipc_findTappedReference", query, "int", "X_IPC_REF_PTR",
                  "findTappedReference")
    yield Message("x_ipc_registerGlobalVar", inform, "{string, string}", None,
                  "registerGlobalVar")


LIBRARY = {message.name: message for message in _all()}
ALIASES = {message.alias: message.name for message in LIBRARY.values() if message.alias}


def find(name):
    """The library message of that name, None for a user's message."""
    if name in LIBRARY:
        return LIBRARY[name]
    for prefix, cls in (("V_get_set_", QUERY), ("V_set_", INFORM), ("V_get_", QUERY),
                        ("V_watch_", BROADCAST)):
        if name.startswith(prefix):
            value = VARIABLES.get(name[len(prefix):], HANDLER_LIST)
            return Message(name, cls, None if prefix == "V_get_" else value,
                           value if cls == QUERY else None)
    return None


#: Formats of the class data of each class, in the order in which the original asks for them.
CLASS_FORMATS = {
    4: "int", 5: "{int, int}", 7: "int", 9: "int",
    8: "{{int, {int, int}}, {int, {int, int}}, *{int, int, int, int, int}}",
    10: "{{int, {int, int}}, {int, {int, int}}, *{int, int, int, int, int}}",
    2: "string", 13: "string", 14: "int", 16: "{int, int}",
}


def names_of(name_list):
    """The names in use of a decoded name list."""
    used, _, names = name_list
    return list(names[:used])


def name_list(names):
    """A name list as the original makes it: room for a multiple of four."""
    room = -(-len(names) // 4) * 4
    return (len(names), room, list(names) + [None] * (room - len(names)))
