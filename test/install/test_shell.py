"""killCentral and killModule, the commands for the shell."""
import os
import subprocess

import pytest

from support.processes import Central, Process
from support.waiting import SLOW

PATIENCE = 20 * SLOW


@pytest.fixture
def command(build):
    """Runs a command of the build: (exit status, what it wrote on standard error)."""
    def run(name, *arguments, env=None):
        done = subprocess.run([os.path.join(build.directory, "src/c/shell", name), *arguments],
                              capture_output=True, text=True, timeout=PATIENCE,
                              env={**os.environ, **(env or {})})
        return done.returncode, done.stderr
    return run


def host_address(central):
    """By host name, so that the Unix socket is used."""
    return f"{os.uname().nodename}:{central.port}"


@pytest.mark.parametrize("way", ["TCP", "Unix socket", "CENTRALHOST"])
def test_kill_central_ends_the_server_in_good_order(command, start_central, way):
    central = start_central()
    address = host_address(central) if way == "Unix socket" else central.address
    arguments, env = ([address], {}) if way != "CENTRALHOST" else ([], {"CENTRALHOST": address})
    assert command("killCentral", *arguments, env=env) == (0, "")
    assert central.wait(PATIENCE) == 0
    assert "Central Abort : Signal 15" in central.output()
    assert not os.path.exists(central.unix_path)
    central._stopped = True


def test_kill_central_says_when_nobody_listens(command, start_central):
    central = start_central()
    address = central.address
    central.stop()
    status, text = command("killCentral", address)
    assert status == 1
    assert text == f"killCentral: no server listens on {address}\n"


def test_kill_central_leaves_other_machines_alone(command):
    status, text = command("killCentral", "192.0.2.1:1381")
    assert status == 1
    assert "another machine" in text


@pytest.mark.parametrize("way", ["TCP", "Unix socket"])
def test_kill_module_ends_all_modules_of_that_name(command, build, central, stack, way):
    address = host_address(central) if way == "Unix socket" else central.address
    modules = [stack.enter_context(Process(
        [os.path.join(build.directory, "examples/module2")], stdin=subprocess.PIPE,
        env={"CENTRALHOST": address})) for _ in range(2)]
    for module in modules:
        module.wait_for_line("^Type", seconds=PATIENCE)
    other = stack.enter_context(Process(
        [os.path.join(build.directory, "examples/module1")], stdin=subprocess.PIPE,
        env={"CENTRALHOST": address}))
    other.wait_for_line("^Type", seconds=PATIENCE)
    assert command("killModule", "MODULE2", address) == (0, "")
    for module in modules:
        assert module.wait(PATIENCE) == -15
    assert other.alive()
    assert command("killModule", "module2", address) == (
        1, "killModule: module2: no module of that name is connected\n")


def test_an_original_central_can_be_ended_but_not_asked(command, stack,
                                                        original_central_program):
    central = stack.enter_context(Central(original_central_program, original=True))
    status, text = command("killModule", "anybody", central.address)
    assert status == 1
    assert "does not know the processes of its modules" in text
    assert command("killCentral", central.address) == (0, "")
    central._stopped = True


@pytest.mark.parametrize("name, arguments", [("killCentral", ["a", "b"]), ("killCentral", ["-x"]),
                                             ("killModule", []), ("killModule", [""]),
                                             ("killModule", ["a", "b", "c"])])
def test_wrong_usage_is_told(command, name, arguments):
    status, text = command(name, *arguments)
    assert status == 2
    assert text.startswith(f"Usage: {name} ")
