"""Queries, timers, descriptors, contexts (checks 57 to 65)."""
import gc
import os
import socket
import time

import pytest

from python.tools import listen_until
from support.waiting import PATIENCE, SLOW

ANSWERER = """
    import sys
    import ipc_cffi as IPC
    IPC.IPC_connect("answerer")
    IPC.IPC_defineMsg("query", IPC.IPC_VARIABLE_LENGTH, "int")
    IPC.IPC_defineMsg("response", IPC.IPC_VARIABLE_LENGTH, "{int, string}")
    def answer(instance, number, _):
        if number >= 0:
            IPC.IPC_respondData(instance, "response", (number, str(number)))
    IPC.IPC_subscribeData("query", answer)
    print("ready")
    IPC.IPC_dispatch()
    """


@pytest.fixture
def asking(module, program):
    """A module beside another one that answers queries with another message."""
    program(ANSWERER).wait_for_line("ready")
    return module


def test_a_query_is_answered_in_another_format(asking):
    class Response(asking.IPCdata):
        """What comes back."""
        _fields = ("number", "text")
    data, result = asking.IPC_queryResponseData("query", 5, PATIENCE * 1000)
    assert (result, type(data), data.f0, data.f1) == (asking.IPC_OK, asking.IPCdata, 5, "5")
    data, result = asking.IPC_queryResponseData("query", 6, asking.IPC_WAIT_FOREVER, Response)
    assert (result, type(data), data.number, data.text) == (asking.IPC_OK, Response, 6, "6")
    array, result = asking.IPC_queryResponse("query", 4, (7).to_bytes(4, "little"), None)
    assert (result, bytes(array)) == (1, b"\7\0\0\0\1\0\0\0007")
    data, result = asking.IPC_unmarshall(asking.IPC_msgFormatter("response"), array, Response)
    assert data.text == "7"
    vc = asking.IPC_VARCONTENT_TYPE()
    asking.IPC_marshall(asking.IPC_msgFormatter("query"), 8, vc)
    array, result = asking.IPC_queryResponseVC("query", vc, None)
    assert bytes(array)[-1:] == b"8"


def test_no_answer_is_a_timeout(asking):
    begin = time.monotonic()
    assert asking.IPC_queryResponseData("query", -1, 300) == (None, asking.IPC_Timeout)
    assert 0.29 <= time.monotonic() - begin < 0.35 * SLOW + 0.2
    assert asking.IPC_queryResponse("query", 4, b"\xff" * 4, 20) == (None, asking.IPC_Timeout)


def test_answers_come_to_handlers_once(asking):
    got = []

    def handler(*arguments):
        got.append(arguments)
    assert asking.IPC_queryNotifyData("query", 1, handler, "data", asking.IPCdata) == 1
    vc = asking.IPC_VARCONTENT_TYPE(b"\2\0\0\0")
    assert asking.IPC_queryNotifyVC("query", vc, handler) == asking.IPC_OK
    assert asking.IPC_queryNotify("query", 4, b"\3\0\0\0", handler, 3) == asking.IPC_OK
    listen_until(lambda: len(got) == 3)
    assert (got[0][1].f1, got[0][2]) == ("1", "data")
    assert bytes(got[1][1])[-1:] == b"2" and got[1][2] is None
    assert bytes(got[2][1])[-1:] == b"3" and got[2][2] == 3
    assert asking.IPC_listenClear(50) == asking.IPC_Timeout
    with pytest.raises(asking.IPCError):
        asking.IPC_queryNotifyData("unknown", 1, handler)


def test_a_delayed_response(module, program):
    asker = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("asker")
        IPC.IPC_defineMsg("query", IPC.IPC_VARIABLE_LENGTH, "int")
        print("asks")
        print(IPC.IPC_queryResponseData("query", 1, IPC.IPC_WAIT_FOREVER))
        """)
    asker.wait_for_line("asks")
    kept = []

    def handler(instance, _data, _client_data):
        kept.append(instance)
        assert module.IPC_delayResponse(instance) == module.IPC_OK
    module.IPC_defineMsg("r", module.IPC_VARIABLE_LENGTH, "string")
    module.IPC_subscribeData("query", handler)
    listen_until(lambda: kept)
    assert module.IPC_msgInstanceName(kept[0]) == "query"
    assert module.IPC_respondData(kept[0], "r", "late") == module.IPC_OK
    asker.wait_for_line(r"\('late', .*IPC_OK")
    with pytest.raises(module.IPCError):
        module.IPC_respondData(kept[0], "r", "later")


def test_handlers_may_ask_themselves(asking):
    got = []

    def handler(_instance, number, _client_data):
        data, _ = asking.IPC_queryResponseData("query", number, None)
        got.append(data.f1)
    asking.IPC_defineMsg("m", asking.IPC_VARIABLE_LENGTH, "int")
    asking.IPC_subscribeData("m", handler)
    asking.IPC_publishData("m", 4)
    asking.IPC_publishData("m", 5)
    listen_until(lambda: len(got) == 2)
    assert got == ["4", "5"]


def test_data_that_do_not_fit_are_neither_asked_nor_answered(asking):
    with pytest.raises(TypeError, match="data: expected int, got 'x'"):
        asking.IPC_queryResponseData("query", "x", None)
    with pytest.raises(TypeError):
        asking.IPC_queryNotifyData("query", "x", print)
    failed = []

    def handler(instance, number, _client_data):
        try:
            asking.IPC_respondData(instance, "response", (number, 3))
        except TypeError as error:
            failed.append(str(error))
        asking.IPC_respondData(instance, "response", (number, "good"))
    asking.IPC_defineMsg("own", asking.IPC_VARIABLE_LENGTH, "int")
    asking.IPC_subscribeData("own", handler)
    data, _ = asking.IPC_queryResponseData("own", 3, None)
    assert data.f1 == "good"
    assert failed[0].startswith("data.f1: expected string, got 3")


# ----------------------------------------------------------------------- timers


def test_timers_of_every_kind(module):
    ticks = []

    def tick(client_data, now, scheduled):
        ticks.append(client_data)
        assert isinstance(now, int) and isinstance(scheduled, int) and now >= scheduled

    def other(*_):
        ticks.append("other")
    assert module.IPC_addOneShotTimer(10.5, tick, "once") == module.IPC_OK
    module.IPC_listenWait(60)
    assert ticks == ["once"]
    assert module.IPC_addTimer(5, 3, tick, "thrice") == module.IPC_OK
    module.IPC_listenWait(80)
    assert ticks[1:] == ["thrice"] * 3
    del ticks[:]
    module.IPC_addPeriodicTimer(5, tick, "replaced")
    module.IPC_addPeriodicTimer(5, tick, "periodic")
    reference, result = module.IPC_addTimerGetRef(5, module.TRIGGER_FOREVER, other)
    assert result == module.IPC_OK and isinstance(reference, module.TIMER_REF)
    second, _ = module.IPC_addTimerGetRef(5, 1, other)
    assert second != reference
    module.IPC_listenWait(100)
    assert set(ticks) == {"periodic", "other"}
    assert module.IPC_removeTimer(tick) == module.IPC_OK
    assert module.IPC_removeTimerByRef(reference) == module.IPC_OK
    del ticks[:]
    module.IPC_listenWait(50)
    assert not ticks
    assert module.IPC_removeTimer(tick) == module.IPC_OK
    assert module.IPC_removeTimerByRef(reference) == module.IPC_OK
    assert module.IPC_removeTimerByRef(second) == module.IPC_OK


def test_the_newest_timer_with_a_reference_goes_by_its_handler(module):
    ticks = []

    def tick(client_data, *_):
        ticks.append(client_data)
    first, _ = module.IPC_addTimerGetRef(5, -1, tick, "first")
    module.IPC_addTimerGetRef(5, -1, tick, "second")
    module.IPC_removeTimer(tick)
    module.IPC_listenWait(40)
    assert set(ticks) == {"first"}
    module.IPC_removeTimerByRef(first)


def test_a_timer_may_remove_itself(module):
    ticks = []

    def tick(*_):
        ticks.append(1)
        module.IPC_removeTimer(tick)
    module.IPC_addPeriodicTimer(5, tick)
    module.IPC_listenWait(60)
    assert ticks == [1]


# ------------------------------------------------------------------ descriptors


def test_descriptors_and_objects_that_have_one(module):
    got = []
    ours, theirs = socket.socketpair()
    reading, writing = os.pipe()

    def read_socket(fd, client_data):
        got.append((fd == ours.fileno(), ours.recv(10), client_data))

    def read_pipe(fd, _client_data):
        got.append(os.read(fd, 10))
    assert module.IPC_subscribeFD(ours, read_socket, "data") == module.IPC_OK
    assert module.IPC_subscribeFD(reading, read_pipe) == module.IPC_OK
    theirs.send(b"a")
    os.write(writing, b"b")
    listen_until(lambda: len(got) == 2)
    assert sorted(got, key=str) == [(True, b"a", "data"), b"b"]
    replaced = []
    module.IPC_subscribeFD(reading, lambda fd, _: replaced.append(os.read(fd, 10)))
    os.write(writing, b"c")
    listen_until(lambda: replaced)
    assert module.IPC_unsubscribeFD(ours, read_socket) == module.IPC_OK
    assert module.IPC_unsubscribeFD(reading, None) == module.IPC_OK
    assert module.IPC_unsubscribeFD(reading, print) == module.IPC_OK
    theirs.send(b"d")
    assert module.IPC_listenClear(30) == module.IPC_Timeout
    for end in (ours, theirs):
        end.close()
    os.close(reading)
    os.close(writing)
    with pytest.raises(module.IPCError):
        module.IPC_subscribeFD(ours, read_socket)
    with pytest.raises(TypeError):
        module.IPC_subscribeFD("0", print)


# --------------------------------------------------------------------- contexts


def test_two_servers_at_once(ipc, start_central):
    centrals = [start_central(), start_central()]
    got, contexts = [], []

    def handler(_instance, data, client_data):
        got.append((data, client_data, contexts.index(ipc.IPC_getContext())))
    for number, central in enumerate(centrals):
        assert ipc.IPC_connectModule(f"m{number}", central.address) == ipc.IPC_OK
        contexts.append(ipc.IPC_getContext())
        ipc.IPC_defineMsg("m", ipc.IPC_VARIABLE_LENGTH, "int")
        ipc.IPC_subscribeData("m", handler, number)
    assert contexts[0] != contexts[1]
    assert ipc.IPC_getContext() == contexts[1]
    for number, context in enumerate(contexts):
        assert ipc.IPC_setContext(context) == ipc.IPC_OK
        ipc.IPC_publishData("m", 10 + number)
    ipc.IPC_setContext(contexts[0])
    listen_until(lambda: len(got) == 2)
    assert sorted(got) == [(10, 0, 0), (11, 1, 1)]
    assert ipc.IPC_getContext() == contexts[0]
    ipc.IPC_disconnect()
    with pytest.raises(ipc.IPCError):
        ipc.IPC_setContext(contexts[0])
    assert ipc.IPC_setContext(contexts[1]) == ipc.IPC_OK
    ipc.IPC_publishData("m", 12)
    listen_until(lambda: len(got) == 3)
    assert got[2] == (12, 1, 1)


def test_descriptors_of_the_connection(ipc, central):
    assert ipc.IPC_getConnections() == set()
    ipc.IPC_connectModule("test", central.address)
    connections = ipc.IPC_getConnections()
    assert connections and all(os.fstat(fd) for fd in connections)
    ipc.IPC_disconnect()
    assert ipc.IPC_getConnections() == set()


def test_nothing_is_left_after_disconnecting(ipc, central):
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(50):
        ipc.IPC_connectModule("test", central.address)
        ipc.IPC_defineMsg("m", ipc.IPC_VARIABLE_LENGTH, "int")
        ipc.IPC_subscribeData("m", print)
        ipc.IPC_queryNotifyData("m", 1, print)
        ipc.IPC_disconnect()
    gc.collect()
    assert len(os.listdir("/proc/self/fd")) <= before + 2
    assert not ipc.handlers._registrations
