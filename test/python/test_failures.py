"""Exceptions in handlers, signals, threads, processes, errors (checks 46 to 56)."""
import os
import signal
import sys
import threading
import time
import traceback

import pytest

from python.tools import Program, ipc as IPC, listen_until
from support.waiting import PATIENCE, wait_until


def fail(*_):
    raise ValueError("boom")


def publish(module, number=1):
    module.IPC_publishData("m", number)


@pytest.fixture
def defined(module):
    module.IPC_defineMsg("m", module.IPC_VARIABLE_LENGTH, "int")
    module.IPC_defineMsg("query", module.IPC_VARIABLE_LENGTH, "int")
    return module


@pytest.mark.parametrize("listen", [
    lambda m: m.IPC_listen(5000), lambda m: m.IPC_listenClear(5000),
    lambda m: m.IPC_listenWait(60000), lambda m: m.IPC_handleMessage(5000),
    lambda m: m.IPC_dispatch(), lambda m: m.IPC_queryResponseData("query", 1, None)],
    ids=["listen", "listenClear", "listenWait", "handleMessage", "dispatch", "queryResponse"])
def test_an_exception_comes_out_of_the_listening_call(defined, listen):
    good = []
    defined.IPC_subscribeData("m", fail)
    publish(defined)
    with pytest.raises(ValueError, match="boom") as caught:
        listen(defined)
    assert "in fail" in "".join(traceback.format_tb(caught.value.__traceback__))
    defined.IPC_unsubscribe("m", fail)
    defined.IPC_subscribeData("m", lambda _i, data, _c: good.append(data))
    publish(defined, 2)
    listen_until(lambda: good)
    assert good == [2]


def test_every_kind_of_handler_may_fail(defined, program):
    def caught(handler_is_set_off):
        with pytest.raises(ValueError, match="boom"):
            handler_is_set_off()
            defined.IPC_listenWait(PATIENCE * 1000)
    reading, writing = os.pipe()
    defined.IPC_subscribeFD(reading, fail)
    caught(lambda: os.write(writing, b"x"))
    defined.IPC_unsubscribeFD(reading, fail)
    os.close(reading)
    os.close(writing)
    defined.IPC_subscribeConnect(fail)
    other = program("""
        import sys
        import ipc_cffi as IPC
        IPC.IPC_connect("other")
        sys.stdin.readline()
        IPC.IPC_subscribe("m", print)
        sys.stdin.readline()
        """, stdin=-1)
    caught(lambda: None)
    defined.IPC_unsubscribeConnect(fail)
    defined.IPC_subscribeHandlerChange("m", fail)
    caught(lambda: other.write_line(""))
    defined.IPC_unsubscribeHandlerChange("m", fail)
    defined.IPC_subscribeDisconnect(fail)
    caught(lambda: other.write_line(""))


def test_a_failing_timer_goes_on(defined):
    ticks = []

    def tick(*_):
        ticks.append(1)
        raise ValueError("boom")
    defined.IPC_addPeriodicTimer(20, tick)
    for _ in range(3):
        with pytest.raises(ValueError):
            defined.IPC_listen(PATIENCE * 1000)
    defined.IPC_removeTimer(tick)
    assert len(ticks) >= 3


def test_a_second_failure_is_reported_and_the_first_one_raised(defined, monkeypatch):
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", reported.append)

    def fail_too(*_):
        raise KeyError("second")
    defined.IPC_subscribeData("m", fail)
    defined.IPC_subscribeData("m", fail_too)
    publish(defined)
    failures = []
    while len(failures) + len(reported) < 2:
        try:
            defined.IPC_listen(PATIENCE * 1000)
        except (ValueError, KeyError) as failure:
            failures.append(failure)
    assert isinstance(failures[0], ValueError)
    kinds = [type(f) for f in failures] + [report.exc_type for report in reported]
    assert kinds == [ValueError, KeyError]


def test_a_failed_query_handler_sends_no_response(defined, program):
    asker = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("asker")
        IPC.IPC_setVerbosity(IPC.IPC_Silent)
        print(IPC.IPC_queryResponseData("query", 1, 500))
        """)
    defined.IPC_subscribeData("query", fail)
    with pytest.raises(ValueError):
        defined.IPC_listen(PATIENCE * 1000)
    assert asker.wait() == 0
    assert re_match_result(asker.stdout[-1])


def re_match_result(line):
    """Nothing came, or an original or new server has told that nothing will."""
    return line.startswith("(None, ")


def test_sys_exit_in_a_handler_ends_the_program(defined, program):
    started = program("""
        import sys
        import ipc_cffi as IPC
        IPC.IPC_connect("other")
        IPC.IPC_subscribeData("m", lambda *_: sys.exit(3))
        print("ready")
        IPC.IPC_dispatch()
        """)
    started.wait_for_line("ready")
    publish(defined)
    assert started.wait() == 3


WAITING = {
    "listen": "IPC.IPC_listen(60000)",
    "listenWait": "IPC.IPC_listenWait(60000)",
    "listenClear": "IPC.IPC_listenClear(60000)",
    "handleMessage": "IPC.IPC_handleMessage(60000)",
    "dispatch": "IPC.IPC_dispatch()",
    "queryResponse": "IPC.IPC_queryResponseData('query', 1, IPC.IPC_WAIT_FOREVER)",
}


@pytest.mark.parametrize("call", WAITING.values(), ids=WAITING)
def test_ctrl_c_ends_every_waiting_call_at_once(defined, program, call):
    """And the connection can be used afterwards."""
    defined.IPC_subscribeData("m", print)
    started = program(f"""
        import ipc_cffi as IPC
        IPC.IPC_connect("other")
        IPC.IPC_subscribeData("query", print)
        print("ready")
        try:
            {call}
        except KeyboardInterrupt:
            print("interrupted")
        print("connected", IPC.IPC_isModuleConnected("other"))
        """)
    started.wait_for_line("ready")
    started.wait_until_it_waits()
    started.signal(signal.SIGINT)
    started.wait_for_line("interrupted")  # long before the call would end by itself
    started.wait_for_line("connected True")
    assert started.wait() == 0


def test_ctrl_c_ends_connecting(ipc):
    from support.processes import free_port  # pylint: disable=import-outside-toplevel
    started = Program(f"""
        import ipc_cffi as IPC
        print("ready")
        try:
            IPC.IPC_connectModule("m", "localhost:{free_port()}")
        except KeyboardInterrupt:
            print("interrupted")
        """)
    started.wait_for_line("ready")
    started.wait_until_it_waits()
    started.signal(signal.SIGINT)
    started.wait_for_line("interrupted")
    assert started.wait() == 0


def test_ctrl_c_ends_a_publication_that_the_server_does_not_take(central, program):
    started = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("m")
        IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, None)
        IPC.IPC_subscribe("m", print)
        data = bytearray(b"abc" * 1000000)
        print("ready")
        input()
        print("publishing")
        try:
            while True:
                IPC.IPC_publish("m", len(data), data)
        except KeyboardInterrupt:
            print("interrupted")
        del data
        input()
        try:
            for _ in range(3):
                IPC.IPC_listen(1000)
        finally:
            print("alive", IPC.IPC_isModuleConnected("m"))
        """, stdin=-1)
    started.wait_for_line("ready")
    central.signal(signal.SIGSTOP)
    started.write_line("")
    started.wait_for_line("publishing")
    started.wait_until_it_waits()
    started.signal(signal.SIGINT)
    started.wait_for_line("interrupted")
    central.signal(signal.SIGCONT)
    started.write_line("")
    started.wait_for_line("alive True")
    assert started.wait() == 0


def test_ctrl_c_while_another_thread_is_in_the_kernel(defined, program):
    started = program("""
        import threading
        import ipc_cffi as IPC
        IPC.IPC_connect("other")
        threading.Thread(target=IPC.IPC_dispatch, daemon=True).start()
        print("ready")
        try:
            IPC.IPC_listen(60000)
        except KeyboardInterrupt:
            print("interrupted")
        IPC.IPC_setVerbosity(IPC.IPC_Silent)
        IPC.IPC_disconnect()
        """)
    started.wait_for_line("ready")
    started.wait_until_it_waits()
    started.signal(signal.SIGINT)
    started.wait_for_line("interrupted")
    assert started.wait() == 0


def test_other_signal_handlers_run_while_waiting(defined):
    calls = []
    before = signal.signal(signal.SIGALRM, lambda *_: calls.append(time.monotonic()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        begin = time.monotonic()
        assert defined.IPC_listenWait(600) == defined.IPC_Timeout
        end = time.monotonic()
        assert end - begin >= 0.59
    finally:
        signal.signal(signal.SIGALRM, before)
    assert calls and calls[0] < end


def test_other_threads_run_while_one_listens(defined):
    turns = []
    over = threading.Event()

    def work():
        while not over.wait(0.01):
            turns.append(1)
    thread = threading.Thread(target=work)
    thread.start()
    defined.IPC_listenWait(1000)
    over.set()
    thread.join()
    assert len(turns) > 5  # with the lock held there would be one


def test_threads_publish_while_one_listens(defined):
    got = []
    defined.IPC_subscribeData("m", lambda _i, data, _c: got.append(data))

    def work(start):
        for number in range(start, start + 1000):
            defined.IPC_publishData("m", number)
    threads = [threading.Thread(target=work, args=(1000 * k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    wait_until(lambda: defined.IPC_listen(50) and len(got) >= 4000, "all have come",
               PATIENCE * 6)
    for thread in threads:
        thread.join()
    assert sorted(got) == list(range(4000))


def test_a_thread_asks_while_another_one_listens(defined):
    def answer(instance, number, _):
        defined.IPC_respondData(instance, "m", number + 1)
    answers = []

    def work():
        for number in range(20):
            answers.append(defined.IPC_queryResponseData("query", number, None))
    defined.IPC_subscribeData("query", answer)
    thread = threading.Thread(target=work)
    thread.start()
    listen_until(lambda: not thread.is_alive())
    assert answers == [(number + 1, IPC.IPC_OK) for number in range(20)]


def test_a_child_does_not_disturb_its_parent(defined):
    got = []
    defined.IPC_subscribeData("m", lambda _i, data, _c: got.append(data))
    child = os.fork()
    if child == 0:
        try:
            state = 1 if defined.IPC_isConnected() else 0
        finally:
            os._exit(state)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    publish(defined, 9)
    listen_until(lambda: got)
    assert got == [9]


def test_the_end_of_the_program_is_quiet(central, program):
    started = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("m")
        IPC.IPC_subscribeData("m", print)
        IPC.IPC_addPeriodicTimer(1, print)
        """)
    assert started.wait() == 0
    assert not started.stderr[1:] and "Traceback" not in started.output()


# ----------------------------------------------------------------------- errors


def errors(module):
    """Calls that fail, and the error of each."""
    unknown = ("not", "defined")[0]
    return [
        (lambda: module.IPC_publishData(unknown, 1), module.IPC_Message_Not_Defined),
        (lambda: module.IPC_publish(unknown, 0, None), module.IPC_Message_Not_Defined),
        (lambda: module.IPC_msgFormatter(unknown), module.IPC_Message_Not_Defined),
        (lambda: module.IPC_parseFormat("{int"), module.IPC_Illegal_Formatter),
        (lambda: module.IPC_parseFormat("nobody"), module.IPC_Illegal_Formatter),
        (lambda: module.IPC_defineMsg("x", -1, "{int"), module.IPC_Illegal_Formatter),
        (lambda: module.IPC_defineMsg("", -1, "int"), module.IPC_Null_Argument),
        (lambda: module.IPC_defineMsg("x", 3, "int"), module.IPC_Mismatched_Formatter),
        (lambda: module.IPC_checkMsgFormats("m", "double"), module.IPC_Mismatched_Formatter),
        (lambda: module.IPC_subscribe("m", None), module.IPC_Null_Argument),
        (lambda: module.IPC_subscribeData(None, print), module.IPC_Null_Argument),
        (lambda: module.IPC_publishVC("m", None), module.IPC_Null_Argument),
        (lambda: module.IPC_respondData(None, "m", 1), module.IPC_Null_Argument),
        (lambda: module.IPC_msgInstanceName(None), module.IPC_Null_Argument),
        (lambda: module.IPC_dataLength(None), module.IPC_Null_Argument),
        (lambda: module.IPC_isModuleConnected(""), module.IPC_Null_Argument),
        (lambda: module.IPC_numHandlers(None), module.IPC_Null_Argument),
        (lambda: module.IPC_setContext(None), module.IPC_Null_Argument),
        (lambda: module.IPC_addTimer(0, 1, print), module.IPC_Argument_Out_Of_Range),
        (lambda: module.IPC_addTimer(1, -2, print), module.IPC_Argument_Out_Of_Range),
        (lambda: module.IPC_addTimer(1, 1, None), module.IPC_Null_Argument),
        (lambda: module.IPC_subscribeFD(-1, print), module.IPC_Argument_Out_Of_Range),
        (lambda: module.IPC_setVerbosity(9), module.IPC_Argument_Out_Of_Range),
        (lambda: module.IPC_unmarshall(module.IPC_parseFormat("int"), b"ab"),
         module.IPC_Wrong_Buffer_Length),
        (lambda: module.IPC_printData(None, sys.stdout, 1), module.IPC_Null_Argument),
    ]


def test_by_default_errors_are_exceptions_with_text_and_number(defined, capfd):
    for call, errno in errors(defined):
        with pytest.raises(defined.IPCError) as caught:
            call()
        assert caught.value.errno == errno == defined.IPC_errno
        assert str(caught.value) == caught.value.args[0] == defined.errors.error_text(errno)
        assert f"ERROR: {caught.value}" in capfd.readouterr().err
    assert defined.IPC_isConnected()


@pytest.mark.parametrize("level", ["IPC_Silent", "IPC_Print_Warnings", "IPC_Print_Errors"])
def test_with_other_levels_they_are_results(defined, capfd, level):
    defined.IPC_setVerbosity(getattr(defined, level))
    for call, errno in errors(defined):
        result = call()
        assert result in (None, 0, -1, False, (None, 0))
        assert defined.IPC_errno == errno
        assert ("ERROR:" in capfd.readouterr().err) == (level == "IPC_Print_Errors")


def test_functions_that_need_a_connection_say_so(ipc):
    for call in (lambda: ipc.IPC_defineMsg("m", -1, "int"), lambda: ipc.IPC_listen(10),
                 lambda: ipc.IPC_subscribe("m", print), lambda: ipc.IPC_publishData("m", 1),
                 ipc.IPC_dispatch, lambda: ipc.IPC_numHandlers("m"),
                 lambda: ipc.IPC_subscribeConnect(print), lambda: ipc.IPC_isMsgDefined("m")):
        with pytest.raises(ipc.IPCError) as caught:
            call()
        assert caught.value.errno == ipc.IPC_Not_Connected
    assert ipc.IPC_getContext() is None


def test_the_text_of_the_last_error_is_printed(ipc, capfd):
    with pytest.raises(ipc.IPCError):
        ipc.IPC_parseFormat("{")
    capfd.readouterr()
    ipc.IPC_perror("here")
    assert capfd.readouterr().err == "here: Illegal format string\n"


def test_the_loss_of_the_server_is_an_error(ipc, start_central):
    central = start_central()
    ipc.IPC_connectModule("test", central.address)
    os.kill(central.pid, signal.SIGKILL)
    central._stopped = True
    with pytest.raises(ipc.IPCError) as caught:
        ipc.IPC_listenWait(PATIENCE * 1000)
    assert caught.value.errno == ipc.IPC_Not_Connected
    assert not ipc.IPC_isConnected()
