"""Central's side of definitions and subscriptions (requirements 17-22)."""
import socket

import pytest

from support import codec, messages
from support.frame import BROADCAST, HANDLER_ONLY, QUERY
from support.peer import expect_nothing


def broadcasts(peer):
    """The list of subscribed messages as central tells it now."""
    return messages.names_of(peer.request("V_get_" + messages.BROADCASTS))


# ------------------------------------------------------------------------- names


def test_message_names_are_found_without_regard_to_case(join):
    """Requirement 17."""
    peer = join("M")
    peer.define("Foo", "int")
    for name in ("Foo", "FOO", "foo"):
        found = peer.look_up(name)
        assert (found.name, found.cls, found.content) == ("Foo", BROADCAST, codec.parse("int"))
    assert peer.look_up("FOO").id == peer.look_up("foo").id
    assert peer.look_up("X_IPC_WAITMSG").name.lower() == "x_ipc_waitmsg"


def test_a_message_reaches_handlers_that_spell_it_differently(join):
    """Requirement 17."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("FOO", 5)
    receiver.sync()
    sender.define("foo")
    sender.publish_number("foo", 1)
    assert receiver.take_numbers(1) == [1]


def test_names_of_formats_are_case_sensitive(join):
    """Requirement 17."""
    peer = join("M")
    peer.define_format("point", "{int, int}")
    peer.define_format("Point", "{double, double}")
    assert peer.request("x_ipc_getNamedFormMsg", "point") == codec.parse("{int, int}")
    assert peer.request("x_ipc_getNamedFormMsg", "Point") == codec.parse("{double, double}")
    assert peer.request("x_ipc_getNamedFormMsg", "POINT") == ("bad",)


@pytest.mark.parametrize("name", ["with blanks in it", "a/b:c", "100%", "x" * 180])
def test_a_name_may_contain_any_characters(name, join):
    """Terms: blanks and any other characters are allowed."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe(name, 5, "handler")
    receiver.sync()
    sender.define(name)
    sender.publish_number(name, 3)
    delivery = receiver.next_delivery()
    assert (delivery.name, delivery.number) == (name, 3)


@pytest.mark.new_central("it crashes on bytes above 0x7f")
@pytest.mark.parametrize("name", ["\xc3\xbc", "\x80\xff", "n" * 1000])
def test_a_name_may_contain_any_bytes_and_be_long(name, join):
    """Section 13.3: names up to 1024 bytes; central folds the case of ASCII letters only."""
    receiver, sender = join(name), join("S")
    receiver.subscribe(name, 5, name)
    receiver.sync()
    sender.define(name)
    sender.publish_number(name, 3)
    assert receiver.take_numbers(1) == [3]
    assert sender.request("x_ipc_moduleConnectedQ", name) == 1


# ------------------------------------------------------------------- definitions


@pytest.mark.parametrize("wire", ["{int, <byte:1>}", "[byte:12]", None])
@pytest.mark.parametrize("content", [
    None, "int", "{int, double, string}", "[double:2,3]", "{int, <{int, float}:1>}",
    "{int, *!}", "*{char, short, long, ubyte, ushort, uint, ulong, boolean}",
    "{enum A, B, C}", "{enum : 300}", "12", "{*int, *string, [string:2]}"])
def test_a_definition_is_told_as_it_was_made(wire, content, join):
    """Requirement 12, section 4.2: class 15, wire format and content format."""
    definer, asker = join("D"), join("A")
    definer.define("Msg", content, wire)
    definer.sync()
    found = asker.look_up("Msg")
    assert (found.cls, found.wire, found.content) == (
        BROADCAST, codec.parse(wire), codec.parse(content))


@pytest.mark.new_central("the notation is the manual's")
def test_both_notations_of_a_self_pointer_mean_the_same(join):
    """Section 15: kind 3 with a zero byte."""
    peer = join("M")
    peer.define("Old", "{int, !*}")
    assert peer.look_up("Old").content == codec.parse("{int, *!}")


@pytest.mark.parametrize("cls", [3, 6])
def test_central_accepts_definitions_of_the_classes_of_old_modules(cls, join):
    """Section 4.2: classes 3 and 6."""
    peer = join("M")
    peer.define("Old", "int", cls=cls)
    assert peer.look_up("Old").cls == cls


def test_named_formats_are_expanded_in_look_ups(join):
    """Requirement 20: definitions may come in any order before the first look-up."""
    definer, asker = join("D"), join("A")
    definer.define("Seg", "seg")
    definer.define("Poly", "{int, <seg:1>, *point}")
    definer.define_format("seg", "{point, point}")
    definer.define_format("point", "{int, int}")
    definer.sync()
    point = "{int, int}"
    segment = f"{{{point}, {point}}}"
    assert asker.look_up("Seg").content == codec.parse(segment)
    assert asker.look_up("Poly").content == codec.parse(f"{{int, <{segment}:1>, *{point}}}")
    assert asker.request("x_ipc_getNamedFormMsg", "seg") == codec.parse(segment)
    assert asker.request("x_ipc_getNamedFormMsg", "nothing") == ("bad",)


def test_a_redefinition_keeps_the_id(join):
    """Requirement 22: modules that ask later get the new format."""
    definer, asker, later = join("D"), join("A"), join("L")
    definer.define("Msg", "int")
    definer.sync()
    first = asker.look_up("Msg")
    definer.define("msg", "double", "[byte:8]")
    definer.sync()
    second = later.look_up("Msg")
    assert second.id == first.id
    assert (second.name, second.wire) == ("msg", codec.parse("[byte:8]"))
    assert second.content == codec.parse("double")


def test_a_redefined_message_still_reaches_its_subscribers(join):
    """Requirement 22, section 4.2."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("Msg", 5)
    sender.define("Msg", "int")
    receiver.sync()
    sender.define("Msg", "double")
    sender.publish_number("Msg", 1)
    assert receiver.take_numbers(1) == [1]
    assert "Msg" in broadcasts(sender)


def test_definitions_outlive_their_module(join):
    """Section 9.1: definitions and named formats stay."""
    definer, asker = join("D"), join("A")
    definer.define_format("f", "{int, int}")
    definer.define("Msg", "f")
    definer.sync()
    definer.close()
    assert asker.look_up("Msg").content == codec.parse("{int, int}")


# ----------------------------------------------------------------- subscriptions


def test_a_message_may_be_subscribed_to_before_it_is_defined(join):
    """Requirement 18: such a name has class 1 and id 0."""
    receiver, sender = join("R"), join("S")
    receiver.subscribe("Early", 5)
    receiver.sync()
    found = sender.look_up("Early")
    assert (found.id, found.name, found.cls) == (0, "Early", HANDLER_ONLY)
    assert found.wire is None and found.content is None
    sender.define("Early")
    sender.publish_number("Early", 9)
    assert receiver.take_numbers(1) == [9]


def test_the_first_handler_id_of_a_handler_name_remains_valid(join):
    """Requirement 19: repetitions carry id 0, also after the handler was deregistered in
    between."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 198, "HND-M1")
    receiver.subscribe("M", 0, "HND-M1")
    receiver.sync()
    sender.publish_number("M", 1)
    assert [(d.handler, d.number) for d in receiver.take(1)] == [(198, 1)]
    receiver.unsubscribe("M", "HND-M1")
    receiver.sync()
    sender.publish_number("M", 2)
    expect_nothing(receiver, sender)
    receiver.subscribe("M", 0, "HND-M1")
    receiver.sync()
    sender.publish_number("M", 3)
    assert [(d.handler, d.number) for d in receiver.take(1)] == [(198, 3)]
    expect_nothing(receiver, sender)


def test_handler_names_belong_to_their_connection(join):
    """Requirement 19: the pair of connection and handler name identifies a handler."""
    first, second, sender = join("A"), join("B"), join("S")
    sender.define("M")
    first.subscribe("M", 11, "HND-same")
    first.sync()
    second.subscribe("M", 22, "HND-same")
    second.sync()
    sender.publish_number("M", 1)
    assert first.next_delivery().handler == 11
    assert second.next_delivery().handler == 22


def test_unsubscribing_stops_deliveries_of_that_handler_only(join):
    """Section 4.2."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 10, "HND-a")
    receiver.subscribe("M", 11, "HND-b")
    receiver.unsubscribe("M", "HND-a")
    receiver.sync()
    sender.publish_number("M", 1)
    assert [d.handler for d in receiver.take(1)] == [11]
    expect_nothing(receiver, sender)


def test_pending_deliveries_of_a_removed_handler_still_come(join):
    """Section 4.2: with the old handler id, and the module acknowledges them."""
    receiver, sender = join("R"), join("S")
    sender.define("M")
    receiver.subscribe("M", 10, "HND-a")
    receiver.sync()
    for number in range(3):
        sender.publish_number("M", number)
    first = receiver.next_delivery()
    sender.sync()
    receiver.unsubscribe("M", "HND-a")
    receiver.acknowledge(first)
    assert [(d.handler, d.number) for d in receiver.take(2)] == [(10, 1), (10, 2)]


# ------------------------------------------------------------- the list of broadcasts


def test_a_message_is_listed_while_it_has_a_handler(join):
    """Requirement 21, section 4.6."""
    receiver, asker = join("R"), join("A")
    receiver.define("M")
    assert broadcasts(asker) == []
    receiver.subscribe("M", 10, "a")
    receiver.subscribe("M", 11, "b")
    receiver.sync()
    assert broadcasts(asker) == ["M"]
    receiver.unsubscribe("M", "a")
    receiver.sync()
    assert broadcasts(asker) == ["M"]
    receiver.unsubscribe("M", "b")
    receiver.sync()
    assert broadcasts(asker) == []


def test_a_message_of_another_class_is_not_listed(join):
    """Section 4.2: a name is taken out when it turns out to be something else."""
    receiver, asker = join("R"), join("A")
    receiver.subscribe("Q", 10)
    receiver.sync()
    assert "Q" in broadcasts(asker)
    receiver.define("Q", "int", cls=QUERY)
    receiver.sync()
    assert "Q" not in broadcasts(asker)


def test_watchers_of_the_list_are_told_of_every_change(join):
    """Requirement 21: the last update holds the whole list; watches themselves are in it."""
    watcher, receiver = join("W"), join("R")
    watcher.subscribe(messages.WATCH_BROADCASTS, 199, messages.WATCH_BROADCASTS)

    def told(expected):
        """Takes updates until one says what is expected; central may leave older ones out."""
        names = None
        while names != expected:
            delivery = watcher.next_delivery()
            watcher.acknowledge(delivery)
            assert delivery.handler == 199
            names = set(messages.names_of(delivery.value(messages.NAME_LIST)))

    for number in range(6):
        receiver.define(f"M{number}")
        receiver.subscribe(f"M{number}", 10 + number)
        told({messages.WATCH_BROADCASTS, *(f"M{n}" for n in range(number + 1))})
    receiver.unsubscribe("M0", "HND-M01010")
    told({messages.WATCH_BROADCASTS, *(f"M{n}" for n in range(1, 6))})
    receiver.close()
    told({messages.WATCH_BROADCASTS})


@pytest.mark.new_central("it keeps one copy per change")
def test_a_module_that_does_not_listen_has_one_update_waiting_at_most(join):
    """Section 4.6 and central 4.4: only the newest queued copy is kept."""
    watcher, receiver = join("W"), join("R")
    watcher.subscribe(messages.WATCH_BROADCASTS, 199, messages.WATCH_BROADCASTS)
    receiver.subscribe("M0", 10)
    first = watcher.next_delivery()
    for number in range(1, 50):
        receiver.subscribe(f"M{number}", 10 + number)
    receiver.sync()
    watcher.acknowledge(first)
    second = watcher.next_delivery()
    assert len(messages.names_of(second.value(messages.NAME_LIST))) == 51
    watcher.acknowledge(second)
    expect_nothing(watcher, receiver)


# ------------------------------------------------------------------- other variables


def test_a_variable_can_be_registered_set_read_and_watched(join):
    """Section 4.6."""
    owner, watcher = join("O"), join("W")
    owner.notice("x_ipc_registerGlobalVar", ("SPEED", "int"))
    owner.sync()
    watcher.subscribe("V_watch_SPEED", 7, "V_watch_SPEED")
    watcher.sync()
    owner.known["V_set_SPEED"] = owner.look_up("V_set_SPEED").id
    owner.notice("V_set_SPEED", data=codec.encode("int", 42))
    delivery = watcher.next_delivery()
    assert (delivery.handler, delivery.value("int")) == (7, 42)
    frame = owner.await_reply(owner.start_request("V_get_SPEED"))
    assert codec.decode("int", frame.data) == 42
    frame = owner.await_reply(owner.start_request("V_get_set_SPEED", data=codec.encode("int", 5)))
    assert codec.decode("int", frame.data) == 42
    frame = owner.await_reply(owner.start_request("V_get_SPEED"))
    assert codec.decode("int", frame.data) == 5


@pytest.mark.new_central("it makes no such promise")
def test_the_news_of_a_subscription_has_gone_out_when_the_subscription_is_complete(join):
    """Design 9: whoever has no delivery unfinished has the update in its socket before the
    subscriber's next question is answered, so that a publisher can rely on what its socket
    holds."""
    watcher, receiver = join("W"), join("R")
    watcher.subscribe(messages.WATCH_BROADCASTS, 199, messages.WATCH_BROADCASTS)
    watcher.sync()
    for number in range(200):
        receiver.subscribe(f"M{number}", 1 + number)
        receiver.sync()
        watcher.socket.setblocking(False)
        assert watcher.socket.recv(1, socket.MSG_PEEK), "the update is not there"
        update = watcher.next_delivery()
        assert f"M{number}" in messages.names_of(update.value(messages.NAME_LIST))
        watcher.acknowledge(update)
        watcher.sync()
