"""Nothing that a program does wrong in Python crashes it."""
import pytest

from python.tools import Program
from support.waiting import SLOW

WRONG_ARGUMENTS = """
    import inspect, io, os, random, sys
    import ipc_cffi as IPC

    random.seed(int(sys.argv[1]))
    sys.unraisablehook = lambda report: None
    IPC.IPC_setVerbosity(IPC.IPC_Silent)
    stale = []

    def connect():
        IPC.IPC_connect("abused")
        IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, "{int, string}")
        IPC.IPC_subscribeData("m", handler)
        IPC.IPC_publishData("m", (1, "x"))
        IPC.IPC_listen(100)
        stale.append(IPC.IPC_getContext())
        stale.append(IPC.IPC_addTimerGetRef(1, 1, handler)[0])

    def handler(*arguments):
        stale.extend(arguments)

    connect()
    left_out = {"IPC_connect", "IPC_connectModule", "IPC_connectNoListen", "IPC_dispatch",
                "IPC_connectModuleNoListen", "IPC_setVerbosity"}
    functions = [getattr(IPC, name) for name in sorted(IPC.__all__)
                 if name not in left_out and (name.startswith("IPC_") or name == "createByteArray")
                 and inspect.isfunction(getattr(IPC, name))]
    limits = {"timeout", "timeoutMSecs"}
    pool = [None, 0, 1, 2, -1, 1 << 70, -(1 << 70), 0.5, float("nan"), float("inf"), "", "m", "x",
            "a" * 3000, "{int", "{int, string}", "int", b"m", b"", b"\\0", b"abcd", bytearray(9),
            object(), [], [1, "x"], (1, "x"), {}, {"f0": 1, "f1": "x"}, int, IPC.IPCdata,
            IPC.IPCdata(), handler, print, len, True, IPC.IPC_VARCONTENT_TYPE(),
            IPC.IPC_VARCONTENT_TYPE(b"abc"), IPC.createByteArray(4), sys.stdin, io.StringIO(),
            IPC.IPC_parseFormat("{int, string}"), IPC.IPC_parseFormat("[int:3]"),
            memoryview(b"abcdef")[::2]]
    overlong = IPC.IPC_VARCONTENT_TYPE(b"abc")
    overlong.length = 1000000
    pool.append(overlong)
    for round in range(4000):
        function = random.choice(functions)
        arguments = []
        for parameter in inspect.signature(function).parameters:
            choice = random.choice(pool + stale[-20:])
            if parameter in limits:
                choice = random.choice([0, 1, "x", 1 << 70, float("nan"), object()])
            arguments.append(choice)
        try:
            function(*arguments)
        except (TypeError, ValueError, OverflowError, AttributeError, IPC.IPCError, OSError,
                NotImplementedError, MemoryError) as error:
            pass
        if not IPC.IPC_isConnected():
            connect()
    print("survived")
    """


@pytest.mark.parametrize("seed", range(4))
def test_arguments_of_all_kinds(program, seed):
    abused = program(WRONG_ARGUMENTS, str(seed))
    abused.wait_for_line("survived", seconds=90 * SLOW)
    assert abused.wait() == 0


def test_handles_that_were_kept_too_long(program):
    kept = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("m")
        IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, "int")
        kept = []
        IPC.IPC_subscribe("m", lambda *arguments: kept.extend(arguments))
        IPC.IPC_publishData("m", 1)
        IPC.IPC_listen(1000)
        formatter, context = IPC.IPC_msgFormatter("m"), IPC.IPC_getContext()
        timer, _ = IPC.IPC_addTimerGetRef(1000, 1, print)
        IPC.IPC_removeTimerByRef(timer)
        IPC.IPC_disconnect()
        IPC.IPC_setVerbosity(IPC.IPC_Silent)
        assert IPC.IPC_msgInstanceName(kept[0]) is None
        assert IPC.IPC_respondData(kept[0], "m", 1) == IPC.IPC_Error
        assert IPC.IPC_setContext(context) == IPC.IPC_Error
        assert IPC.IPC_removeTimerByRef(timer) == IPC.IPC_OK
        assert IPC.IPC_unmarshall(formatter, kept[1]) == (1, IPC.IPC_OK)
        print("survived")
        """)
    kept.wait_for_line("survived")
    assert kept.wait() == 0


@pytest.mark.parametrize("daemon", [True, False])
def test_the_program_ends_while_a_thread_listens(program, daemon):
    ended = program(f"""
        import threading, time
        import ipc_cffi as IPC
        IPC.IPC_connect("m")
        IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, "int")
        IPC.IPC_subscribeData("m", lambda *_: None)
        IPC.IPC_addPeriodicTimer(1, lambda *_: None)
        IPC.IPC_setVerbosity(IPC.IPC_Silent)
        threading.Thread(target=IPC.IPC_dispatch, daemon={daemon}).start()
        for number in range(200):
            IPC.IPC_publishData("m", number)
        if not {daemon}:
            IPC.IPC_disconnect()
        print("ends")
        """)
    ended.wait_for_line("ends")
    assert ended.wait() == 0


def test_formats_as_deep_as_the_library_allows(ipc):
    depth = 200
    for opening, closing in (("{", "}"), ("*", ""), ("[", ":1]")):
        text = opening * depth + "int" + closing * depth
        value = 5
        if opening != "*":
            for _ in range(depth):
                value = [value]
        converter = ipc.IPC_parseFormat(text).converter
        content = bytes(converter.encode(value))
        assert content[-4:] == (5).to_bytes(4, ipc.formatters.sys.byteorder)
        assert converter.decode(content) is not None
