"""Connections, definitions, publications, subscriptions (checks 30 to 45)."""
import functools
import gc
import weakref

import pytest

from python.tools import Program, encoded, ipc as IPC, listen_until, plain


class Got(list):
    """A handler that keeps what it is called with."""

    def __call__(self, *arguments):
        self.append(arguments)

    __hash__ = object.__hash__
    __eq__ = object.__eq__

    @property
    def data(self):
        return [call[1] for call in self]

    @property
    def client_data(self):
        return [call[-1] for call in self]


def define(module, name, text, length=IPC.IPC_VARIABLE_LENGTH):
    assert module.IPC_defineMsg(name, length, text) == IPC.IPC_OK


def test_connecting_and_disconnecting_say_that_they_worked(ipc, central):
    assert ipc.IPC_isConnected() is False
    assert ipc.IPC_getConnections() == set()
    assert ipc.IPC_connectModule("test", central.address) == ipc.IPC_OK
    assert ipc.IPC_isConnected() is True
    assert ipc.IPC_isModuleConnected("test") is True
    assert ipc.IPC_isModuleConnected("other") is False
    assert ipc.IPC_disconnect() == ipc.IPC_OK
    assert ipc.IPC_isConnected() is False
    assert ipc.IPC_disconnect() == ipc.IPC_OK


@pytest.mark.parametrize("name", ["IPC_connectNoListen", "IPC_connect"])
def test_the_server_of_the_environment_is_used(ipc, central, monkeypatch, name):
    monkeypatch.setenv("CENTRALHOST", central.address)
    assert getattr(ipc, name)("test") == ipc.IPC_OK
    assert ipc.IPC_isModuleConnected("test")


def test_a_module_that_does_not_listen_can_publish(ipc, central, program):
    receiver = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("receiver")
        IPC.IPC_subscribeData("m", lambda *message: print("got", message[1]))
        print("ready")
        IPC.IPC_dispatch()
        """)
    receiver.wait_for_line("ready")
    assert ipc.IPC_connectModuleNoListen("test", central.address) == ipc.IPC_OK
    define(ipc, "m", "int")
    assert ipc.IPC_publishData("m", 3) == ipc.IPC_OK
    receiver.wait_for_line("got 3")


def test_a_message_comes_back(module):
    got = Got()
    define(module, "m", "{int, string}")
    assert module.IPC_isMsgDefined("m") is True
    assert module.IPC_isMsgDefined("other") is False
    assert module.IPC_subscribeData("m", got, "client") == module.IPC_OK
    assert module.IPC_publishData("m", (5, "five")) == module.IPC_OK
    listen_until(lambda: got)
    (instance, data, client_data), = got
    assert (data.f0, data.f1, client_data) == (5, "five", "client")
    assert isinstance(instance, module.MSG_INSTANCE)


def test_an_instance_tells_of_its_message_while_the_handler_runs(module):
    told = []

    def handler(instance, _data, _client_data):
        told.append((module.IPC_msgInstanceName(instance), module.IPC_dataLength(instance),
                     module.IPC_msgInstanceFormatter(instance), instance))
    define(module, "m", "{int, string}")
    module.IPC_subscribeData("m", handler)
    module.IPC_publishData("m", (1, "ab"))
    listen_until(lambda: told)
    name, length, formatter, instance = told[0]
    assert (name, length, formatter) == ("m", 10, module.IPC_msgFormatter("m"))
    module.IPC_setVerbosity(module.IPC_Silent)
    assert module.IPC_msgInstanceName(instance) is None
    assert module.IPC_dataLength(instance) == 0
    assert module.IPC_respondData(instance, "m", (1, "x")) == module.IPC_Error
    assert module.IPC_delayResponse(instance) == module.IPC_Error
    assert module.IPC_msgInstanceName(None) is None


def test_raw_handlers_get_bytes_that_stay_valid(module):
    got = Got()
    define(module, "m", None)
    module.IPC_subscribe("m", got)
    assert module.IPC_publish("m", 5, b"abcdefgh") == module.IPC_OK
    assert module.IPC_publishVC("m", module.IPC_VARCONTENT_TYPE(bytearray(b"xy"))) == module.IPC_OK
    assert module.IPC_publish("m", 0, None) == module.IPC_OK
    listen_until(lambda: len(got) == 3)
    assert [None if data is None else bytes(data) for data in got.data] == [b"abcde", b"xy", None]
    array = got.data[0]
    assert isinstance(array, module.BYTE_ARRAY) and len(array) == 5 and array[0] == ord("a")
    module.IPC_freeByteArray(array)
    module.IPC_freeByteArray(array)
    assert len(array) == 0
    with pytest.raises(ValueError):
        array[0]


def test_messages_of_fixed_length(module, capfd):
    got = Got()
    define(module, "fixed", None, 4)
    define(module, "variable", None)
    define(module, "empty", None, 0)
    module.IPC_subscribe("fixed", got)
    module.IPC_subscribe("empty", got)
    assert module.IPC_publishFixed("fixed", b"abcd") == module.IPC_OK
    assert module.IPC_publish("fixed", module.IPC_FIXED_LENGTH, memoryview(b"efgh")) == 1
    assert module.IPC_publishFixed("empty", None) == module.IPC_OK
    assert module.IPC_publish("fixed", 4, module.createByteArray(4)) == module.IPC_OK
    listen_until(lambda: len(got) == 4)
    assert sorted(bytes(data or b"") for data in got.data) == [b"", b"\0\0\0\0", b"abcd", b"efgh"]
    for call, error in (
            (lambda: module.IPC_publishFixed("variable", b"ab"), module.IPC_Not_Fixed_Length),
            (lambda: module.IPC_publishFixed("fixed", b"ab"), module.IPC_Message_Lengths_Differ),
            (lambda: module.IPC_publishFixed("fixed", None), module.IPC_Null_Argument),
            (lambda: module.IPC_publish("fixed", 3, b"abc"), module.IPC_Message_Lengths_Differ),
            (lambda: module.IPC_publish("fixed", -1, b"abc"), module.IPC_Message_Lengths_Differ),
            (lambda: module.IPC_publishFixed("unknown", b"ab"), module.IPC_Message_Not_Defined)):
        with pytest.raises(module.IPCError) as caught:
            call()
        assert caught.value.errno == error
    with pytest.raises(ValueError):
        module.IPC_publish("fixed", 4, b"abc")
    with pytest.raises(TypeError):
        module.IPC_publish("fixed", 4, "abcd")
    capfd.readouterr()


def test_a_message_without_format_has_no_data(module):
    got = Got()
    define(module, "m", None)
    module.IPC_subscribeData("m", got)
    assert module.IPC_publishData("m", None) == module.IPC_OK
    listen_until(lambda: got)
    assert got.data == [None]
    with pytest.raises(TypeError):
        module.IPC_publishData("m", 3)


def test_none_is_a_null_pointer_or_no_data_at_all(module):
    got = Got()
    define(module, "pointer", "*int")
    define(module, "number", "int")
    module.IPC_subscribeData("pointer", got)
    module.IPC_publishData("pointer", None)
    module.IPC_publishData("pointer", 7)
    listen_until(lambda: len(got) == 2)
    assert got.data == [None, 7]
    with pytest.raises(TypeError):
        module.IPC_publishData("number", None)


def test_data_that_do_not_fit_are_not_sent(module):
    got = Got()
    define(module, "m", "{int, [double:2]}")
    module.IPC_subscribeData("m", got)
    with pytest.raises(TypeError, match=r"f1\[1\]: expected double, got 'x' \(format \{int"):
        module.IPC_publishData("m", (1, [2.0, "x"]))
    module.IPC_publishData("m", (2, [2.0, 3.0]))
    listen_until(lambda: got)
    assert [data.f0 for data in got.data] == [2]


def test_data_follow_the_format_that_the_message_has_now(module, start_central):
    got = Got()
    define(module, "m", "int")
    module.IPC_subscribeData("m", got)
    first = module.IPC_getContext()
    assert module.IPC_publishData("m", 5) == module.IPC_OK
    module.IPC_connectModule("other", start_central().address)
    with pytest.raises(module.IPCError):
        module.IPC_publishData("m", 5)
    define(module, "m", "{int, string}")
    module.IPC_subscribeData("m", got)
    assert module.IPC_publishData("m", (6, "six")) == module.IPC_OK
    with pytest.raises(TypeError, match="expected a structure, got 7"):
        module.IPC_publishData("m", 7)
    with pytest.raises(TypeError, match="a name has to be str or bytes, not list"):
        module.IPC_publishData([], 7)
    module.IPC_setContext(first)
    assert module.IPC_publishData("m", 8) == module.IPC_OK
    listen_until(lambda: len(got) == 3)
    assert [data for data in got.data if isinstance(data, int)] == [5, 8]
    assert [(data.f0, data.f1) for data in got.data if not isinstance(data, int)] == [(6, "six")]


def test_any_number_of_messages_can_be_published(module, monkeypatch):
    monkeypatch.setattr(module.messages, "MAX_OUTLETS", 2)
    got = Got()
    for number in range(5):
        define(module, f"m{number}", "int")
        module.IPC_subscribeData(f"m{number}", got)
    for number in (0, 1, 2, 3, 4, 0):
        assert module.IPC_publishData(f"m{number}", number) == module.IPC_OK
        assert len(module.messages._outlets) <= 2
    listen_until(lambda: len(got) == 6)
    assert got.data == [0, 1, 2, 3, 4, 0]


def test_subscribing_before_the_definition_delivers(module, program):
    got = Got()
    module.IPC_subscribeData("later", got)
    publisher = program("""
        import ipc_cffi as IPC
        IPC.IPC_connect("publisher")
        IPC.IPC_defineMsg("later", IPC.IPC_VARIABLE_LENGTH, "string")
        IPC.IPC_publishData("later", "text")
        """)
    listen_until(lambda: got)
    assert got.data == ["text"]
    assert publisher.wait() == 0


def test_one_function_may_be_subscribed_to_two_messages(module):
    got = Got()
    for name in "ab":
        define(module, name, "string")
        module.IPC_subscribeData(name, got, f"client {name}")
    module.IPC_publishData("a", "1")
    module.IPC_publishData("b", "2")
    listen_until(lambda: len(got) == 2)
    assert sorted(zip(got.data, got.client_data)) == [("1", "client a"), ("2", "client b")]
    module.IPC_unsubscribe("a", got)
    module.IPC_publishData("a", "3")
    module.IPC_publishData("b", "4")
    listen_until(lambda: len(got) == 3)
    assert got.data[2] == "4"


class Receiver:
    """Methods as handlers."""

    def __init__(self, calls):
        self.calls = calls

    def method(self, *_):
        self.calls.append(self)


def test_all_kinds_of_callables_are_handlers_of_their_own(module):
    calls = []

    def closure(name):
        return lambda *_: calls.append(name)

    def function(name, *_):
        calls.append(name)
    one, two = Receiver(calls), Receiver(calls)
    define(module, "m", "int")
    for handler in (closure(1), closure(2), one.method, two.method,
                    functools.partial(function, 3), functools.partial(function, 4)):
        assert module.IPC_subscribeData("m", handler) == module.IPC_OK
    assert module.IPC_numHandlers("m") == 6
    module.IPC_publishData("m", 0)
    listen_until(lambda: len(calls) == 6)
    assert calls == [1, 2, one, two, 3, 4]
    module.IPC_unsubscribe("m", one.method)  # written anew: equal, not the same
    assert module.IPC_numHandlers("m") == 5


def test_subscribing_again_replaces_client_data_and_mode(module, capfd):
    got = Got()
    define(module, "m", "int")
    module.IPC_subscribeData("m", got, "first")
    module.IPC_setVerbosity(module.IPC_Print_Warnings)
    module.IPC_subscribe("m", got, "second")
    assert "Resetting client data for handler" in capfd.readouterr().err
    module.IPC_publishData("m", 258)
    listen_until(lambda: got)
    assert len(got) == 1 and got.client_data == ["second"]
    assert len(got.data[0]) == 4
    assert module.IPC_numHandlers("m") == 1


def test_unsubscribing_all_handlers_and_unknown_ones(module):
    first, second = Got(), Got()
    define(module, "m", "int")
    module.IPC_subscribeData("m", first)
    module.IPC_subscribeData("m", second)
    assert module.IPC_unsubscribe("m", print) == module.IPC_OK
    assert module.IPC_numHandlers("m") == 2
    assert module.IPC_unsubscribe("m", None) == module.IPC_OK
    assert module.IPC_numHandlers("m") == 0
    module.IPC_subscribeData("m", second)
    module.IPC_publishData("m", 1)
    listen_until(lambda: second)
    assert not first


def test_handlers_may_change_subscriptions_and_disconnect(module):
    calls = []

    def once(*_):
        calls.append("once")
        module.IPC_unsubscribe("m", once)
        module.IPC_subscribeData("m", last)

    def last(*_):
        calls.append("last")
        module.IPC_disconnect()
    define(module, "m", "int")
    module.IPC_subscribeData("m", once)
    module.IPC_publishData("m", 1)
    listen_until(lambda: calls)
    module.IPC_publishData("m", 2)
    module.IPC_setVerbosity(module.IPC_Silent)
    listen_until(lambda: len(calls) == 2)
    assert calls == ["once", "last"]
    assert not module.IPC_isConnected()


def test_comings_and_goings_are_told_in_the_order_of_subscription(module, program):
    told = []

    def note(kind):
        return lambda *arguments: told.append((kind, *arguments))
    connects = [note("connect 1"), note("connect 2")]
    changes = [note("change 1"), note("change 2")]
    define(module, "m", "int")
    for handler in connects:
        assert module.IPC_subscribeConnect(handler, "data") == module.IPC_OK
    assert module.IPC_subscribeDisconnect(note("disconnect")) == module.IPC_OK
    for handler in changes:
        assert module.IPC_subscribeHandlerChange("m", handler) == module.IPC_OK
    other = program("""
        import sys
        import ipc_cffi as IPC
        IPC.IPC_connect("other")
        IPC.IPC_subscribeData("m", print)
        sys.stdin.readline()
        """, stdin=-1)
    listen_until(lambda: len(told) == 4)
    assert told == [("connect 1", "other", "data"), ("connect 2", "other", "data"),
                    ("change 1", "m", 1, None), ("change 2", "m", 1, None)]
    del told[:]
    assert module.IPC_unsubscribeHandlerChange("m", changes[0]) == module.IPC_OK
    assert module.IPC_unsubscribeConnect(connects[0]) == module.IPC_OK
    assert module.IPC_unsubscribeConnect(print) == module.IPC_OK
    other.write_line("")
    listen_until(lambda: len(told) == 2)
    assert sorted(told) == [("change 2", "m", 0, None), ("disconnect", "other", None)]


def test_client_data_are_kept_as_long_as_needed(module):
    class Thing:
        """An object with weak references."""
    thing = Thing()
    known = weakref.ref(thing)
    got = []
    define(module, "m", "int")

    def handler(_instance, _data, client_data):
        got.append(client_data is known())
    module.IPC_subscribeData("m", handler, thing)
    del thing
    gc.collect()
    assert known() is not None
    module.IPC_publishData("m", 1)
    listen_until(lambda: got)
    assert got == [True]
    module.IPC_unsubscribe("m", handler)
    gc.collect()
    assert known() is None


def test_capacity_priority_and_queue_length(module):
    define(module, "m", "int")
    assert module.IPC_setCapacity(4) == module.IPC_OK
    assert module.IPC_setMsgPriority("m", 3) == module.IPC_OK
    assert module.IPC_setMsgQueueLength("m", 2) == module.IPC_OK
    for call in (lambda: module.IPC_setCapacity(0), lambda: module.IPC_setMsgPriority("m", -1),
                 lambda: module.IPC_setMsgQueueLength("m", 0)):
        with pytest.raises(module.IPCError) as caught:
            call()
        assert caught.value.errno == module.IPC_Argument_Out_Of_Range


def test_a_thousand_messages_arrive_in_order(module):
    got = Got()
    define(module, "m", "int")
    module.IPC_subscribeData("m", got)
    for number in range(1000):
        module.IPC_publishData("m", number)
    listen_until(lambda: len(got) == 1000)
    assert got.data == list(range(1000))


def test_no_server_is_an_error(ipc):
    from support.processes import free_port  # pylint: disable=import-outside-toplevel
    done = Program(f"""
        import ipc_cffi as IPC
        try:
            IPC.IPC_connectModule("m", "localhost:{free_port()}")
        except IPC.IPCError as error:
            print("error", error, error.errno)
        """)
    done.wait_for_line("error Not connected to IPC central 1", seconds=60)
    assert done.wait() == 0


@pytest.mark.new_central("ends at names beyond ASCII")
def test_text_of_names(module):
    got = Got()
    define(module, "mö", "string")
    module.IPC_subscribeData(b"m\xc3\xb6", got)
    module.IPC_publishData("mö", "straße \udcff")
    listen_until(lambda: got)
    assert got.data == ["straße \udcff"]
    with pytest.raises(ValueError):
        module.IPC_isMsgDefined("a\0b")
    with pytest.raises(TypeError):
        module.IPC_isMsgDefined(3)


@pytest.mark.parametrize("text, value", [
    ("[string:3]", ["a" * 20000, "", "é"]), ("[double:5000]", [float(k) for k in range(5000)]),
    ("{[char:20000], boolean, *int}", [["x"] * 20000, True, 7]), ("[boolean:9000]", [True] * 9000),
    ("{int, <{string, short}:1>}", [3000, [["text", 5]] * 3000])], ids=str)
def test_large_values_of_other_kinds(module, text, value):
    module.IPC_defineMsg("m", module.IPC_VARIABLE_LENGTH, text)
    got, raw = [], []
    module.IPC_subscribeData("m", lambda _, data, __: got.append(data))
    module.IPC_subscribe("m", lambda _, content, __: raw.append(content))
    module.IPC_publishData("m", value)
    listen_until(lambda: got and raw)
    assert plain(got[0]) == value and bytes(raw[0]) == encoded(text, value)
