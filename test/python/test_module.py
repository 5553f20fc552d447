"""Names, constants, signatures, what importing does (checks 1 to 5)."""
import glob
import importlib.metadata
import importlib.util
import inspect
import os
import subprocess
import sys

import pytest

from python.tools import PACKAGES, ROOT, ipc

NUMBERS = {
    "IPC_Error": 0, "IPC_OK": 1, "IPC_Timeout": 2,
    "IPC_No_Error": 0, "IPC_Not_Connected": 1, "IPC_Not_Initialized": 2,
    "IPC_Message_Not_Defined": 3, "IPC_Not_Fixed_Length": 4, "IPC_Message_Lengths_Differ": 5,
    "IPC_Argument_Out_Of_Range": 6, "IPC_Null_Argument": 7, "IPC_Illegal_Formatter": 8,
    "IPC_Mismatched_Formatter": 9, "IPC_Wrong_Buffer_Length": 10,
    "IPC_Communication_Error": 11,
    "IPC_Silent": 0, "IPC_Print_Warnings": 1, "IPC_Print_Errors": 2, "IPC_Exit_On_Errors": 3,
    "IPC_WAIT_FOREVER": 4294967295, "IPC_VARIABLE_LENGTH": 4294967295,
    "IPC_FIXED_LENGTH": 4294967294, "TRIGGER_FOREVER": -1,
}

TYPES = ["IPC_RETURN_TYPE", "IPC_ERROR_TYPE", "IPC_VERBOSITY_TYPE", "IPCdata", "IPCError",
         "IPC_VARCONTENT_TYPE", "MSG_INSTANCE", "FORMATTER_PTR", "IPC_CONTEXT_PTR", "TIMER_REF",
         "BYTE_ARRAY"]

SIGNATURES = """
IPC_initialize()
IPC_connect(taskName)
IPC_connectModule(taskName, serverName)
IPC_connectNoListen(taskName)
IPC_connectModuleNoListen(taskName, serverName)
IPC_disconnect()
IPC_isConnected()
IPC_isModuleConnected(moduleName)
IPC_getConnections()
IPC_defineMsg(msgName, length, formatString)
IPC_isMsgDefined(msgName)
IPC_publish(msgName, length, content)
IPC_publishVC(msgName, varcontent)
IPC_publishFixed(msgName, content)
IPC_msgInstanceName(msgInstance)
IPC_dataLength(msgInstance)
IPC_setCapacity(capacity)
IPC_setVerbosity(verbosity)
IPC_setMsgPriority(msgName, priority)
IPC_setMsgQueueLength(msgName, queueLength)
IPC_perror(msg)
IPC_subscribe(msgName, handler, clientData=None)
IPC_subscribeData(msgName, handler, clientData=None, dataClass=None)
IPC_unsubscribe(msgName, handler)
IPC_subscribeFD(fd, fdHandler, clientData=None)
IPC_unsubscribeFD(fd, handler)
IPC_subscribeConnect(connectHandler, clientData=None)
IPC_subscribeDisconnect(disconnectHandler, clientData=None)
IPC_unsubscribeConnect(connectHandler)
IPC_unsubscribeDisconnect(disconnectHandler)
IPC_subscribeHandlerChange(msgName, changeHandler, clientData=None)
IPC_unsubscribeHandlerChange(msgName, changeHandler)
IPC_numHandlers(msgName)
IPC_listen(timeoutMSecs)
IPC_listenClear(timeoutMSecs)
IPC_listenWait(timeoutMSecs)
IPC_handleMessage(timeoutMSecs)
IPC_dispatch()
IPC_respond(msgInstance, msgName, length, content)
IPC_respondVC(msgInstance, msgName, varcontent)
IPC_respondData(msgInstance, msgName, data)
IPC_delayResponse(msgInstance)
IPC_queryNotify(msgName, length, content, handler, clientData=None)
IPC_queryNotifyVC(msgName, varcontent, handler, clientData=None)
IPC_queryNotifyData(msgName, data, handler, clientData=None, responseClass=None)
IPC_queryResponse(msgName, length, content, timeout)
IPC_queryResponseVC(msgName, varcontent, timeout)
IPC_queryResponseData(msgName, data, timeoutMSecs, responseClass=None)
IPC_parseFormat(formatString)
IPC_defineFormat(formatName, formatString)
IPC_checkMsgFormats(msgName, formatString)
IPC_msgFormatter(msgName)
IPC_msgInstanceFormatter(msgInstance)
IPC_marshall(formatter, data, varcontent)
IPC_unmarshall(formatter, bytearray, oclass=None)
IPC_unmarshallData(formatter, bytearray, object=None, oclass=None)
IPC_freeByteArray(byteArray)
createByteArray(numBytes)
IPC_publishData(msgName, data)
IPC_printData(formatter, stream, data)
IPC_readData(formatter, stream)
IPC_getContext()
IPC_setContext(context)
IPC_addTimer(tdelay, count, handler, clientData=None)
IPC_addTimerGetRef(tdelay, count, handler, clientData=None)
IPC_addOneShotTimer(tdelay, handler, clientData=None)
IPC_addPeriodicTimer(tdelay, handler, clientData=None)
IPC_removeTimer(handler)
IPC_removeTimerByRef(timerRef)
""".split("\n")[1:-1]


def run(text, *options):
    return subprocess.run([sys.executable, *options, "-c", text], capture_output=True, text=True,
                          env={"PYTHONPATH": PACKAGES}, timeout=60, check=False)


def test_importing_is_quiet_and_quick():
    done = run("""if True:
        import os, sys
        before = set(os.listdir("/proc/self/fd"))
        import ipc_cffi
        assert set(os.listdir("/proc/self/fd")) == before
        assert not {"numpy", "asyncio", "logging"} & set(sys.modules), "too much is imported"
        """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("name, number", NUMBERS.items())
def test_constants(name, number):
    value = getattr(ipc, name)
    assert value == number
    assert f"{value}" == str(value) == "%d" % value == "%s" % value == str(number)
    assert bool(value) == bool(number)
    if isinstance(value, ipc.IPC_RETURN_TYPE):
        assert name in repr(value)


@pytest.mark.parametrize("signature", SIGNATURES)
def test_functions_have_the_parameters_of_the_manual(signature):
    name = signature.split("(")[0]
    parameters = [parameter.replace(annotation=parameter.empty) for parameter
                  in inspect.signature(getattr(ipc, name)).parameters.values()]
    assert f"{name}({', '.join(map(str, parameters))})" == signature


def test_exactly_these_names_are_exported():
    names = {*NUMBERS, *TYPES, *(signature.split("(")[0] for signature in SIGNATURES)}
    assert set(ipc.__all__) == names


def test_the_alias_has_the_same_objects_and_some_more():
    done = run("""if True:
        import ipc_cffi, IPC
        from IPC import *
        assert all(getattr(IPC, name) is getattr(ipc_cffi, name) for name in ipc_cffi.__all__)
        assert IPC.cvar.IPC_errno == IPC.IPC_errno == ipc_cffi.IPC_errno == 0
        IPC.printByteArray(createByteArray(2))
        assert TRIGGER_FOREVER == -1 and issubclass(IPCdata, object)
        """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "0 0\n", "")


def test_the_alias_says_what_it_is_to_those_who_ask():
    assert run("import IPC").stderr == ""
    assert "DeprecationWarning" in run("import IPC", "-Walways").stderr


def test_opaque_types_compare_and_hash(ipc):
    ipc.IPC_initialize()
    formatter = ipc.IPC_parseFormat("{int, double}")
    assert formatter == ipc.IPC_parseFormat("{ int,double }")
    assert len({formatter, ipc.IPC_parseFormat("{int, double}")}) == 1
    assert ipc.IPC_parseFormat(None) is None and ipc.IPC_parseFormat("") is None


def unchecked():
    """Modules without types of their own, or of what they build on: trio has some since 0.23."""
    spec = importlib.util.find_spec("trio")
    typed = spec and os.path.exists(os.path.join(os.path.dirname(spec.origin), "py.typed"))
    return ["_build.py", *([] if typed else ["trio.py"])]


def test_type_hints_hold():
    try:
        version = importlib.metadata.version("mypy")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("mypy is not installed")
    if int(version.split(".")[0]) < 2:
        pytest.skip(f"mypy {version} has other names for errors")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", PACKAGES + "/.mypy_cache",
         "--exclude", "|".join(unchecked()), "python/ipc_cffi", "test/python/typed_program.py"],
        cwd=ROOT, capture_output=True, text=True, timeout=300, check=False,
        env={"MYPYPATH": ROOT + "/python", "PATH": "/usr/bin:/bin"})
    assert done.returncode == 0, done.stdout + done.stderr


def test_type_hints_hold_for_pyright_too():
    """It comes with pip as well, and may have to get itself first."""
    command = [sys.executable, "-m", "pyright"]
    try:
        asked = subprocess.run([*command, "--version"], capture_output=True, timeout=60, check=False)
    except subprocess.TimeoutExpired:
        pytest.skip("pyright cannot be had")
    if asked.returncode != 0:
        pytest.skip("pyright is not installed")
    modules = [path for path in glob.glob(ROOT + "/python/ipc_cffi/**/*.py", recursive=True)
               if os.path.basename(path) not in unchecked()]
    done = subprocess.run([*command, "--pythonpath", sys.executable, *modules,
                           ROOT + "/test/python/typed_program.py"], cwd=ROOT + "/python",
                          capture_output=True, text=True, timeout=300, check=False,
                          env={**os.environ, "PYTHONPATH": ROOT + "/python"})
    assert done.returncode == 0, "\n".join(line for line in done.stdout.splitlines()
                                           if " error" in line)
