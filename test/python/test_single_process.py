"""One process that publishes, subscribes, asks and answers (S11)."""
import os
import io

from python.tools import ipc as IPC, listen_until


class Sample(IPC.IPCdata):
    """A structure that is marshalled."""
    _fields = ("i1", "str1", "str2", "d1")


class Element(IPC.IPCdata):
    """Of a linked list."""
    _fields = ("matrix", "name", "count", ("next", "Element"))


def test_one_process_does_it_all(module):
    said = []

    def raw(instance, content, client_data):
        said.append(f"{module.IPC_msgInstanceName(instance)} of "
                    f"{module.IPC_dataLength(instance)} bytes ({bytes(content)!r}) [{client_data}]")

    def decoded(instance, data, client_data):
        said.append(f"{module.IPC_msgInstanceName(instance)} of "
                    f"{module.IPC_dataLength(instance)} bytes ({data}) [{client_data}]")

    def next_said():
        before = len(said)
        listen_until(lambda: len(said) > before, "something was said")
        return said[before]
    ticks = []
    module.IPC_addTimer(50, module.TRIGGER_FOREVER, lambda *times: ticks.append(times), "timer1")
    for name in ("msg1", "msg2", "query1"):
        module.IPC_defineMsg(name, module.IPC_VARIABLE_LENGTH, "string")
    assert module.IPC_isMsgDefined("msg1") and not module.IPC_isMsgDefined("msg3")
    module.IPC_subscribe("msg1", raw, "client1a")
    module.IPC_subscribeData("msg2", decoded, "client2a")
    module.IPC_publishData("msg1", "abcde")
    assert next_said() == r"msg1 of 9 bytes (b'\x05\x00\x00\x00abcde') [client1a]"
    module.IPC_publishData("msg2", "abcdefgh")
    assert next_said() == "msg2 of 12 bytes (abcdefgh) [client2a]"
    assert module.IPC_numHandlers("msg2") == 1
    module.IPC_subscribe("msg2", decoded, "client2b")
    module.IPC_publishData("msg2", "again")
    assert next_said().endswith("[client2b]")
    assert module.IPC_numHandlers("msg2") == 1
    module.IPC_subscribe("msg1", raw, "client1b")
    module.IPC_publishData("msg1", "abcde")
    assert next_said().endswith("[client1b]")
    module.IPC_unsubscribe("msg1", raw)
    module.IPC_unsubscribe("msg2", decoded)
    module.IPC_publishData("msg1", "abcde")
    assert module.IPC_listen(30) == module.IPC_Timeout

    def answer(instance, data, client_data):
        decoded(instance, data, client_data)
        module.IPC_respondData(instance, "msg2", "Responded")
    module.IPC_subscribeData("query1", answer, "qtest")
    module.IPC_queryNotifyData("query1", "abcdef", decoded, "Notification")
    assert next_said() == "query1 of 10 bytes (abcdef) [qtest]"
    listen_until(lambda: said[-1] == "msg2 of 13 bytes (Responded) [Notification]")
    assert module.IPC_queryResponseData("query1", "abcdef", module.IPC_WAIT_FOREVER) == (
        "Responded", module.IPC_OK)
    listen_until(lambda: ticks)
    assert ticks[0][0] == "timer1" and ticks[0][1] >= ticks[0][2]


def test_marshalling_and_printing(ipc):
    formatter = ipc.IPC_parseFormat("{int, string, string, double}")
    sample = Sample(i1=666, str1="hello", str2="world", d1=3.14159)
    varcontent = ipc.IPC_VARCONTENT_TYPE()
    ipc.IPC_marshall(formatter, sample, varcontent)
    assert varcontent.length == 30
    copy, _ = ipc.IPC_unmarshall(formatter, varcontent.content, Sample)
    assert repr(copy) == repr(sample) == "<Sample: i1: 666; str1: 'hello'; str2: 'world'; d1: 3.14159>"

    def printed(text, data):
        stream = io.StringIO()
        ipc.IPC_printData(ipc.IPC_parseFormat(text), stream, data)
        return stream.getvalue()
    assert printed("int", 42) == "42\n"
    assert printed("string", "Hello, world") == '"Hello, world"\n'
    head = None
    for count, name in ((2, "TheThird"), (1, "TheSecond"), (0, "TheFirst")):
        head = Element(matrix=[[count, count + 1], [count + 1, count + 2]], name=name,
                       count=count, next=head)
    assert printed("{[double:2,2], string, int, *!}", head) == (
        '{[[0.00, 1.00], [1.00, 2.00]], "TheFirst", 0, *{[[1.00, 2.00], [2.00, 3.00]], "\n'
        ' TheSecond", 1, *{[[2.00, 3.00], [3.00, 4.00]], "TheThird", 2, NULL}}}\n')


def test_a_query_answered_with_a_matrix_and_a_keyboard(module):
    module.IPC_defineMsg("query2", module.IPC_VARIABLE_LENGTH, "int")
    module.IPC_defineMsg("matrix", module.IPC_VARIABLE_LENGTH, "[double:2,2]")
    module.IPC_subscribeData("query2", lambda instance, number, _: module.IPC_respondData(
        instance, "matrix", [[number, number + 1], [number + 1, number + 2]]))
    assert module.IPC_queryResponseData("query2", 1, None) == (
        [[1.0, 2.0], [2.0, 3.0]], module.IPC_OK)
    reading, writing = os.pipe()
    keys = []

    def keyboard(fd, client_data):
        keys.append((os.read(fd, 1), client_data))
    module.IPC_subscribeFD(reading, keyboard, "FD1")
    os.write(writing, b"m")
    os.write(writing, b"q")
    listen_until(lambda: len(keys) == 2)
    assert keys == [(b"m", "FD1"), (b"q", "FD1")]
    module.IPC_unsubscribeFD(reading, keyboard)
    os.close(reading)
    os.close(writing)
