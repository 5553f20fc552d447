"""The logs of small scenes, line by line as the original server wrote them.

logs/README.md tells each scene.  Times, numbers that change from run to run, and the mended line
ends of docs/differences.md apart, the logs are equal.
"""
import os
import re
import signal
import struct
import subprocess

import pytest

from support import codec, messages
from support.frame import BROADCAST
from support.peer import Peer
from support.processes import Process
from support.scene import ADDRESS, Actor, masked, mended
from support.waiting import PATIENCE, wait_until

pytestmark = pytest.mark.new_central("the samples are its own, but for the line ends")

LOGS = os.path.join(os.path.dirname(__file__), "logs")


def sample(name):
    with open(os.path.join(LOGS, name), encoding="latin-1") as file:
        return file.read()


class Scene:
    """A central that logs into a file, and modules."""

    def __init__(self, start_central, stack, directory, options, **popen):
        self.stack, self.directory = stack, directory
        self.central = start_central(*options.split(), cwd=directory, **popen)

    def join(self, *names, listen=True):
        actors = []
        for name in names:
            actors.append(self.stack.enter_context(Actor(self.central, name)).join())
        if listen:
            self.listen(*actors)
        return actors

    @staticmethod
    def listen(*actors):
        """All process what anyone of them has caused."""
        for actor in actors:
            actor.sync()
        for actor in actors:
            actor.listen()

    def text(self):
        path = self.directory / "sample.log"
        return path.read_text("latin-1") if path.exists() else ""

    def until(self, text, count=1):
        """Waits until the log holds a text."""
        wait_until(lambda: self.text().count(text) >= count, f"{text!r} in the log")

    def end(self):
        """The log of the whole run, ended by a signal."""
        self.central.signal(signal.SIGTERM)
        self.central.wait()
        self.central.stop_quietly()
        return self.text()


@pytest.fixture
def scene(start_central, stack, tmp_path):
    return lambda options, **popen: Scene(start_central, stack, tmp_path, options, **popen)


def assert_same(actual, name, change=lambda text: text):
    expected = change(mended(sample(name)))
    assert masked(actual).split("\n") == masked(expected).split("\n")


def robot(scene, options, **popen):
    """Planner defines Ping, which Arm and Camera handle."""
    scene = scene(options, **popen)
    planner, arm, camera = scene.join("Planner", "Arm", "Camera")
    planner.define("Ping")
    planner.sync()
    for actor in (arm, camera):
        actor.subscribe_to("Ping")
        scene.listen(planner, arm, camera)
    return scene, planner, arm, camera


def ping_twice(scene, planner, arm, camera):
    planner.publish_number("Ping", 1)
    planner.publish_number("Ping", 2)
    planner.sync()
    for actor in (arm, camera):
        actor.handle(2)
        actor.sync()
    camera.leave()
    arm.leave()


def test_01_the_terminal_by_default(scene):
    run = robot(scene, "", console=True)
    ping_twice(*run)
    run[0].end()
    assert_same("\n".join(run[0].central.stdout) + "\n", "01-terminal-default.log")


def test_02_the_letters_for_viewers(scene):
    run = robot(scene, "-lx -LmtirN -fsample.log")
    ping_twice(*run)
    assert_same(run[0].end(), "02-file-viewer-options.log")


def unbroken(text):
    """Data in one line, as where it breaks depends on the numbers of messages; no address of the
    open file, and no empty places in lists of names, both of which the original sends."""
    text = re.sub(r"\{\*-?\d{4,}, ", "{NULL, ", text)
    text = re.sub(r", ?\n {5}", ", ", text).replace("\n     ", "")
    text = re.sub(r"\{(\d+), \d+, <(?:, )?((?:(?!NULL)[^>])*?)(?:, )?(?:\"NULL\"(?:, )?)*>\}",
                  r"{\1, <\2>}", text)
    return re.sub(r"\{0, 0, NULL\}", "{0, <>}", text)


def test_03_everything(scene):
    scene = scene("-lx -L -fsample.log")
    planner, = scene.join("Planner", listen=False)
    planner.define("Ping")
    planner.subscribe_to("Ping")
    planner.handle()
    planner.publish_number("Ping", 5)
    planner.handle(ask=False)
    planner.leave()
    # The original changes the list of broadcasts once for each subscription that ends.
    assert_same(unbroken(scene.end()), "03-file-everything.log", lambda text: re.sub(
        r"Inform    V_set_X_IPC_BROADCAST_MSG_VAR: .*\n    \{1, <\"Ping\">\}\n  Done .*\n", "",
        unbroken(text)))


def pause(scene, count):
    """Waits until central has handled so many messages: without a word to it, which would count."""
    scene.until(f"\n{count:5}: Msg: ")


def test_04_all_letters(scene):
    scene = scene("-lx -LmstdhirpN -fsample.log")
    planner, arm, camera = scene.join("Planner", "Arm", "Camera", listen=False)
    planner.define("Ping")
    pause(scene, 83)
    arm.subscribe_to("Ping")
    pause(scene, 84)
    camera.subscribe_to("Ping")
    pause(scene, 85)
    for number, actor in enumerate((planner, arm, camera)):
        actor.handle()
        pause(scene, 87 + 2 * number)
    planner.publish_number("Ping", 1)
    planner.publish_number("Ping", 2)
    pause(scene, 94)
    for number, actor in enumerate((arm, camera)):
        actor.handle(2)
        pause(scene, 97 + 3 * number)
    camera.leave()
    pause(scene, 102)
    arm.leave()
    assert_same(scene.end(), "04-file-all-letters.log")


def test_05_parents_are_the_deliveries_that_were_being_handled(scene):
    scene = scene("-lx -LmtirpN -fsample.log")
    planner, arm, nav = scene.join("Planner", "Arm", "Nav")
    planner.define("Goal")
    planner.define("Step")
    planner.sync()
    arm.subscribe_to("Goal")
    nav.subscribe_to("Step")
    scene.listen(planner, arm, nav)
    planner.publish_number("Goal", 1)
    goal = arm.next_delivery()
    arm.publish("Step", struct.pack("<i", 2), parent=goal.dispatch)
    arm.acknowledge(goal)
    arm.sync()
    nav.handle()
    nav.sync()
    text = scene.end()
    assert_same(text, "05-parent-references.log")
    number = re.search(r"Goal \{(\d+)\}: .*\(Sent\)", text).group(1)
    assert f"Step {{{re.search('Step .([0-9]+)', text).group(1)}}}:        Arm {{{number}}} -->" in text


def where(scene, options):
    """Planner asks Where, Arm answers with Here."""
    scene = scene(options)
    planner, arm = scene.join("Planner", "Arm")
    planner.define("Where")
    planner.define("Here")
    planner.sync()
    return scene, planner, arm


def test_06_queries(scene):
    scene, planner, arm = where(scene, "-lx -LmtdirpN -fsample.log")
    arm.subscribe_to("Where")
    scene.listen(planner, arm)
    asked = planner.query_number("Where", 5)
    arm.respond_number(arm.next_delivery(), "Here", 42)
    planner.await_reply(asked)
    planner.publish_number("Where", 6)
    asked = planner.query_number("Where", 7)
    planner.sync()
    for _ in range(2):
        arm.respond_number(arm.next_delivery(), "Here", 42)
    planner.await_reply(asked)
    planner.query_number("Where", 8)
    arm.handle()
    arm.sync()
    assert_same(scene.end(), "06-query-reply.log")


def test_07_a_query_that_nobody_handles_yet(scene):
    scene, planner, arm = where(scene, "-lx -LmstdirN -fsample.log")
    asked = planner.query_number("Where", 5)
    planner.sync()
    arm.subscribe_to("Where")
    while (delivery := arm.next_delivery()).name != "Where":
        arm.acknowledge(delivery)
    arm.respond_number(delivery, "Here", 42)
    planner.await_reply(asked)
    assert_same(scene.end(), "07-query-no-handler.log")


def low_mid_high(scene, options, names=("Low", "Mid", "High")):
    scene = scene(options)
    planner, arm = scene.join("Planner", "Arm")
    for name in names:
        planner.define(name)
    planner.sync()
    for number, name in enumerate(names):
        arm.subscribe_to(name, 10 + number)
    scene.listen(planner, arm)
    return scene, planner, arm


def test_08_priorities(scene):
    scene, planner, arm = low_mid_high(scene, "-lx -LmsirN -fsample.log")
    arm.set_priority("High", 10)
    arm.sync()
    planner.set_priority("Mid", 5)
    for name in "Low Low Mid High Low Mid High".split():
        planner.publish_number(name, 0)
    planner.sync()
    arm.handle(7)
    arm.sync()
    assert_same(scene.end(), "08-priorities.log")


def test_09_a_limit_drops_the_oldest(scene):
    scene, planner, arm = low_mid_high(scene, "-lx -LmstdirN -fsample.log", ("Low", "Mid"))
    arm.set_limit("Low", 2)
    arm.sync()
    for number, name in enumerate("Mid Low Mid Low Mid Low Low Mid".split()):
        planner.publish_number(name, number)
    planner.sync()
    arm.handle(6)
    arm.sync()
    arm.set_limit("Low", 3)
    arm.sync()
    assert_same(scene.end(), "09-queue-length-limit.log")


def test_10_capacity(scene):
    scene, planner, arm = low_mid_high(scene, "-lx -LmsirN -fsample.log", ("Low",))
    arm.set_capacity(3)
    arm.sync()
    for number in range(5):
        planner.publish_number("Low", number)
    planner.sync()
    active = [arm.next_delivery() for _ in range(3)]
    for delivery in reversed(active):  # as the original's library did
        arm.acknowledge(delivery)
        arm.sync()
    arm.handle(2)
    arm.sync()
    assert_same(scene.end(), "10-capacity.log")


def test_11_modules_that_die(scene):
    scene, planner, arm = where(scene, "-lx -LmstirN -fsample.log")
    planner.define("Ping")
    planner.sync()
    arm.subscribe_to("Ping")
    scene.listen(planner, arm)
    for number in range(3):
        planner.publish_number("Ping", number)
    planner.sync()
    arm.close()
    scene.until("Clearing handler", 3)
    planner.listen()
    arm, = scene.join("Arm")
    arm.subscribe_to("Where")
    scene.listen(planner, arm)
    planner.query_number("Where", 5)
    delivery = arm.next_delivery()
    planner.close()
    scene.until("close Module: Closing Planner")
    arm.respond_number(delivery, "Here", 1)
    arm.sync()
    assert_same(scene.end(), "11-module-crash.log")


FORMATS = [
    ("int", -7), ("uint", 4000000000), ("short", -5), ("ushort", 65535), ("long", -9000000000),
    ("ulong", 18000000000000000000), ("float", 1.005), ("double", -12345678.999),
    ("double", 1e300), ("char", "A"), ("char", "\0"), ("char", "\n"), ("byte", -0x55),
    ("ubyte", 0xab), ("ubyte", 0), ("boolean", 1), ("boolean", 0), ("string", "hello"),
    ("string", None), ("string", ""), ("string", "with \"quote\" and\nnewline"),
    ("string", "0123456789" * 10), ("{enum A, B, C}", 1), ("{enum A, B, C}", 7),
    ("{enum : 5}", 2), ("{int, string, double}", (1, "two", 3.0)), ("*int", -7), ("*int", None),
    ("[int:2,3]", [1, 2, 3, 4, 5, 6]), ("{int, <int:1>}", (5, list(range(0, 5000, 1000)))),
    ("{int, <int:1>}", (0, [])), ("{int, <int:1>}", (60, list(range(0, 60000, 1000)))),
    ("{int, int, <int:1,2>}", (2, 3, list(range(0, 6000, 1000)))),
    ("{int, *!}", (1, (2, (3, None)))), ("{char, short, char, double, float}",
                                         ("x", 2, "y", 4.5, 5.5)),
    ("[int:100]", list(range(100000, 100100))),
    ("[byte:8]", bytes([0, 1, 2, 127, 128, 255, 65, 66])), ("[char:8]", b"abcdefgh"),
    ("[ubyte:8]", bytes([0, 1, 2, 127, 128, 255, 65, 66])), ("named", (1, "two")),
    ("{int, named}", (9, (8, "s"))),
]


def short_bytes(text):
    """Bytes with the values that they have, instead of those shifted by the original."""
    text = re.sub(r"0x([0-9a-f]{1,2})000000\b", r"0x\1", text)
    return text.replace("0x41, \n     0x42]", "0x41, 0x42]")


def test_12_data_of_many_formats(scene):
    scene = scene("-lx -LmdiN -fsample.log")
    formats, = scene.join("Formats")
    formats.set_capacity(1)
    formats.define_format("named", "{int, string}")
    for number, (fmt, value) in enumerate(FORMATS, 1):
        name = f"F{number}"
        formats.define(name, fmt)
        formats.subscribe_to(name, 200 + number)
        formats.listen()
        formats.publish(name, encoded(fmt, value))
        formats.handle()
        formats.sync()
    for name, wire, datas in (("Raw", codec.VARIABLE, [b"\x05\0\0\0\x05\0\0\0\1\2\xffab",
                                                       b"\0\0\0\0\0\0\0\0"]),
                              ("Fix", "[byte:4]", [b"\1\2\xffa"]), ("Empty", None, [b""])):
        formats.notice("x_ipc_registerMessageMsg", (name, BROADCAST, wire, None))
        formats.subscribe_to(name, 300 + len(name))
        formats.listen()
        for data in datas:
            formats.publish(name, data=data)
            formats.handle()
            formats.sync()
    formats.leave()
    assert_same(scene.end(), "12-data-formats.log", short_bytes)


def encoded(fmt, value):
    if fmt == "named" or "named" in fmt:
        fmt = fmt.replace("named", "{int, string}")
    return codec.encode(fmt, value, "<")


def dialogue(text):
    """A sample of a terminal as a pipe has it: without what was typed, and up to the end."""
    text = text.split("> quit\n")[0] + "> "
    text = text.replace("\nstatus\n", "\n", 1)
    return re.sub(r"^> (\n|\S.*\n)", "> ", text, flags=re.MULTILINE)


def without_news(text):
    """The listing of commands without those that the original does not have."""
    return re.sub(r"^(modules|messages|queues) .*\n|^(Connections|Per Second|Waiting|Dropped) *: .*\n", "", text,
                  flags=re.MULTILINE)


def test_14_commands(scene):
    scene = scene("-lmsi", console=True)
    planner, arm, camera = scene.join("Planner", "Arm", "Camera")
    for name in ("Ping", "Where"):
        planner.define(name)
        planner.sync()
        arm.subscribe_to(name, 100 + len(name))
        scene.listen(planner, arm, camera)
    planner.publish_number("Ping", 1)
    planner.publish_number("Ping", 2)
    planner.query_number("Where", 3)
    planner.sync()
    lines = ("status", "display", "memory", "", "foo", "close Nobody", "-lx",
             "-LmtirN -ftest.log", "status")
    for line in lines:
        scene.central.write_line(line)
    wait_until(lambda: "\n".join(scene.central.stdout).count("Resource status") == 2, "status")
    arm.take(2)
    arm.respond_number(arm.next_delivery(), "Ping", 4)
    camera.notice("x_ipc_registerResourceMsg", (1, "Gripper"))
    camera.sync()
    planner.request("x_ipc_lockResourceMsg", "Gripper")
    arm.sync()
    for line in ("status", "display", "close Camera", "status"):
        scene.central.write_line(line)
    wait_until(lambda: "\n".join(scene.central.stdout).count("Resource status") == 4, "status")
    scene.central.write_line("quit")
    assert scene.central.wait() == 0
    scene.central.stop_quietly()

    def comparable(text):
        text = re.sub(r"(?m)^(  Requests|  Total|  M\w\w Request).*$", r"\1", masked(text))
        blocks = re.split(r"(?m)^((?:  ?\S.* (?:Status: |\{N\}).*\n)+)", text)
        return "".join("".join(sorted(block.splitlines(True))) if " Status: " in block
                       or "{N}: " in block else block for block in blocks).split("\n")

    actual = without_news("\n".join(scene.central.stdout))
    assert comparable(actual) == comparable(dialogue(sample("14-terminal-dialogue.log")))


def direct_join(scene, name, port):
    """The handshake of the original library in direct mode."""
    actor = scene.stack.enter_context(Actor(scene.central, name))
    actor.read_prelude()
    for cls in messages.CLASS_FORMATS:
        actor.request("x_ipc_classInfoMsg", cls)
    actor.introduce()
    assert actor.direct
    actor.notice("x_ipc_directResMsg", (port, name))
    variables = ("CENTRAL_TERMINAL_LOG_VAR", "CENTRAL_FILE_LOG_VAR", messages.TAPPED)
    for variable in (*variables, messages.BROADCASTS):
        actor.request("V_get_" + variable)
    for number, variable in enumerate(variables):
        actor.subscribe("V_watch_" + variable, 190 + number, "V_watch_" + variable)
    for variable in variables:
        actor.notice("x_ipc_limitPendingMsg", (variable, name, 1))
    actor.subscribe(messages.WATCH_BROADCASTS, 199, messages.WATCH_BROADCASTS)
    actor.notice("x_ipc_limitPendingMsg", (messages.BROADCASTS, name, 1))
    actor.ready()
    return actor


def test_15_direct_mode(scene):
    """The messages themselves do not appear."""
    scene = scene("-lx -LmsN -fsample.log -c")
    planner = direct_join(scene, "Planner", 8002)
    arm = direct_join(scene, "Arm", 8003)
    planner.define("Ping")
    scene.until("Done    x_ipc_registerMessageMsg")
    arm.subscribe_to("Ping")
    for number, actor in enumerate((planner, arm), 1):
        actor.handle()
        scene.until("  Done    V_watch_X_IPC_BROADCAST_MSG_VAR:", number)
    assert planner.id_of("Ping") < 0
    planner.request("x_ipc_directMsgQuery", "Ping")
    planner.subscribe("V_watch_Ping", 150, "V_watch_Ping")
    planner.handle(ask=False)
    scene.until("  Done    V_watch_X_IPC_BROADCAST_MSG_VAR:", 3)
    arm.look_up("Ping", f"HND-Ping{ADDRESS}")
    arm.handle(ask=False)
    scene.until("  Done    V_watch_X_IPC_BROADCAST_MSG_VAR:", 4)
    arm.leave()
    scene.until("  Done     x_ipc_CloseMsg:")
    # A new list of subscribed messages overtakes what waits: no wait for the module.
    assert_same(scene.end(), "15-direct-mode.log", lambda text: text.replace(
        "--> Resource Planner (Pending)", "--> Planner         (Sent)"))


def test_16_a_query_with_two_handlers(scene):
    """The original ended here; now one of them gets it."""
    scene = scene("-lmsi")
    planner, arm, camera = scene.join("Planner", "Arm", "Camera")
    planner.define("Where")
    planner.sync()
    for actor in (arm, camera):
        actor.subscribe_to("Where")
        scene.listen(planner, arm, camera)
    planner.query_number("Where", 1)
    arm.handle()
    arm.sync()
    scene.end()
    expected = sample("16-fatal-two-query-handlers.log").split("ERROR")[0] + (
        "Query               Where:    Planner --> Arm             (Sent)\n"
        "  Done              Where:\nCentral Abort : Signal 15")
    assert masked("\n".join(scene.central.stdout)) == masked(expected)


def test_17_a_port_that_is_taken(central, central_program, stack):
    second = stack.enter_context(Process([central_program, "-u", f"-p{central.port}"]))
    assert second.wait() == 1
    assert second.stdout == ["ERROR: Unable to start server, Is one already running?", ""]
    assert second.stderr[0].startswith("Error: unable to bind TCP/IP socket for listening")
    with Peer(central, unix=True) as first:
        first.connect()  # on its Unix socket, too


def test_17b_a_server_that_is_stopped(central):
    central.signal(signal.SIGTERM)
    central.wait()
    central.stop_quietly()
    assert masked("\n".join(central.stdout)) == (
        "Task Control Server V\nExpecting 1 on port PORT\nCentral Abort : Signal 15")
    assert [line.split(":")[0].rstrip() for line in central.stderr[:6]] == [
        "Cumulative Memory Usage", "  Requests", "Data Msg Buffer Stats", "  Total Alloc",
        "  Total Freed", "  Min Request"]


def test_19_the_listing_of_options(central_program):
    done = subprocess.run([central_program, "-h"], capture_output=True, text=True, check=True,
                          timeout=PATIENCE, stdin=subprocess.DEVNULL)
    expected = sample("19-option-listing.log").split("\n")
    assert done.stdout.split("\n")[1:] == expected[1:]
    assert done.stdout.split("\n")[0] == f"{central_program} command line options:"
    assert done.stderr == ""


def test_19b_the_version(central_program):
    done = subprocess.run([central_program, "-v"], capture_output=True, text=True, check=True,
                          timeout=PATIENCE, stdin=subprocess.DEVNULL)
    assert done.stdout == ""
    assert re.fullmatch(r"Task Control Server \d+\.\d+\.\d+ \n Released : \w{3}-\d\d-\d\d\n"
                        r" Commited : \$Date: .*\$\n Compiled : \w{3} \d\d \d{4} \d\d:\d\d:\d\d\n",
                        done.stderr)


def test_20_summaries(scene):
    scene = scene("-lx -LmthiN -fsample.log")
    planner, arm = scene.join("Planner", "Arm", listen=False)
    planner.define("Ping")
    pause(scene, 56)
    arm.subscribe_to("Ping")
    pause(scene, 57)
    for number, actor in enumerate((planner, arm)):
        actor.handle()
        pause(scene, 59 + 2 * number)
    for number in range(4):
        planner.publish_number("Ping", number)
        arm.handle()
        pause(scene, 65 + 2 * number)
    assert_same(scene.end(), "20-handle-summary.log")


def test_21_the_start_with_everything_shown(start_central):
    """The registrations come before the banner."""
    central = start_central("-l")
    central.signal(signal.SIGTERM)
    central.wait()
    central.stop_quietly()
    assert_same("\n".join(central.stdout[:-1]) + "\n", "21-startup-unfiltered.log",
                lambda text: text.replace("{*1234567,", "{NULL,"))


def test_22_a_stranger_and_two_of_one_name(scene):
    """Unlike the original, the other one of that name stays."""
    scene = scene("-lmsi")
    with Peer(scene.central) as stranger:
        stranger.read_prelude()
    scene.central.wait_for_line("close Module: Closing")
    first, second, planner = scene.join("Dup", "Dup", "Planner")
    planner.define("Ping")
    planner.sync()
    for actor in (first, second):
        actor.subscribe_to("Ping")
        scene.listen(first, second, planner)
    planner.publish_number("Ping", 1)
    for actor in (first, second):
        actor.handle()
        actor.sync()
    first.close()
    scene.central.wait_for_line("close Module: Closing Dup")
    second.sync()
    scene.end()
    expected = sample("22-same-names-and-strangers.log").split("Broadcast")[0] + (
        "Broadcast            Ping:    Planner --> Dup             (Sent)\n"
        "Broadcast            Ping:    Planner --> Dup             (Sent)\n"
        "  Done               Ping:\n"
        "  Done               Ping:\n"
        "Closed Connection Detected from: sd: 5: \n"
        " Closing Dup on robot1\n"
        "close Module: Closing Dup\n"
        "Central Abort : Signal 15")
    assert masked("\n".join(scene.central.stdout)) == masked(expected)


def test_23_a_reservation(scene):
    scene = scene("-lmsi", console=True)
    planner, arm = scene.join("Planner", "Arm")
    planner.define("Ping")
    planner.sync()
    arm.subscribe_to("Ping")
    scene.listen(planner, arm)
    number = planner.request("x_ipc_reserveResourceMsg", "Arm")
    planner.publish_number("Ping", 1)
    planner.sync()
    scene.central.write_line("status")
    scene.central.wait_for_line("Resource Planner")
    planner.notice("x_ipc_cancelReservationMsg", number)
    planner.sync()
    arm.handle()
    arm.sync()
    scene.central.write_line("status")
    wait_until(lambda: "\n".join(scene.central.stdout).count("Resource Planner") == 2, "status")
    scene.central.write_line("quit")
    assert scene.central.wait() == 0
    scene.central.stop_quietly()
    swapped = r"( Resource Arm.*\n)( Resource Planner.*\n)"
    assert_same("\n".join(scene.central.stdout), "23-reservation.log",
                lambda text: re.sub(swapped, r"\2\1", text))
