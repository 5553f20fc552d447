"""The functions of ipc.h as a C program sees them; the checks are in the C files of this directory.

Every check is a test here.  They run side by side, since most of them wait most of the time.
"""
import concurrent.futures
import glob
import os
import re
import signal
import subprocess

import pytest

from support.waiting import SLOW

HERE = os.path.dirname(os.path.abspath(__file__))
SIDE_BY_SIDE = 6
LIMIT = 90 * SLOW

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror"]

#: Programs with checks that wait for seconds, to be begun first.
LONG = ("connecting", "loss", "listening")

#: Checks that wait for most of a minute, which other tests can use.
LONGEST = ("a_server_that_never_answers_is_given_up",)


def checks():
    """(program, check, whether it is true of our library only), the long ones first."""
    programs = [os.path.splitext(os.path.basename(path))[0]
                for path in sorted(glob.glob(os.path.join(HERE, "*.c")))]
    found = []
    for program in sorted(programs, key=lambda name: name not in LONG):
        with open(os.path.join(HERE, program + ".c"), encoding="utf-8") as source:
            found += [(program, name, bool(new))
                      for new, name in re.findall(r"^CHECK(_NEW)?\((\w+)\)", source.read(), re.M)]
    return found


class Runs:
    """Compiles the programs and runs their checks."""

    def __init__(self, compiler, library, central, directory):
        self.compiler, self.library, self.central = compiler, library, central
        self.directory = directory
        self.results = {}
        self.pool = concurrent.futures.ThreadPoolExecutor(SIDE_BY_SIDE)

    def start(self, wanted):
        """Begins all checks that are wanted."""
        for program, name in wanted:
            path = self.compile(program)
            self.results[program, name] = self.pool.submit(self.run, path, name)

    def compile(self, program):
        sources = [os.path.join(HERE, file) for file in (program + ".c", "check.c")]
        return self.compiler.program(
            sources, self.library, includes=[HERE],
            flags=["-std=c99", "-D_DEFAULT_SOURCE", "-D_XOPEN_SOURCE=700", *WARNINGS])

    def run(self, path, name):
        """(exit status, standard output, standard error) of a check."""
        place = os.path.join(self.directory, os.path.basename(path) + "-" + name)
        os.makedirs(place)
        options = os.environ.get("ASAN_OPTIONS", "")
        environment = {**os.environ, **self.library.environment(),
                       "IPC_CHECK_CENTRAL": self.central,
                       "ASAN_OPTIONS": "detect_leaks=1:" + options}
        environment.pop("CENTRALHOST", None)
        if self.library.original:
            environment["IPC_CHECK_ORIGINAL"] = "1"
        with subprocess.Popen([path, name], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, errors="replace", cwd=place,
                              env=environment, start_new_session=True) as process:
            try:
                out, err = process.communicate(timeout=LIMIT)
                status = process.returncode
            except subprocess.TimeoutExpired:
                status, out, err = "none: it does not end", "", ""
            finally:
                end_session(process.pid)
        return status, out, err + central_log(place) if status else err

    def close(self):
        self.pool.shutdown(cancel_futures=True)


def end_session(leader):
    """Ends what a check has left behind."""
    try:
        os.killpg(leader, signal.SIGKILL)
    except ProcessLookupError:
        pass


def central_log(place):
    """What the centrals of a check have printed."""
    text = ""
    for path in sorted(glob.glob(os.path.join(place, "central*.log"))):
        with open(path, encoding="utf-8", errors="replace") as log:
            text += f"\n{os.path.basename(path)}:\n" + log.read()[-1500:]
    return text


@pytest.fixture(scope="session")
def runs(request, compiler, library, central_program, tmp_path_factory):
    """The running checks, all that have been selected."""
    found = Runs(compiler, library, central_program, str(tmp_path_factory.mktemp("checks")))
    selected = [item.callspec.params for item in request.session.items
                if item.originalname == "test_check"]
    found.start([(params["program"], params["name"]) for params in selected
                 if not (params["new"] and library.original)])
    yield found
    found.close()


@pytest.mark.parametrize("program,name,new", [
    pytest.param(*check, id=f"{check[0]}-{check[1]}",
                 marks=[pytest.mark.looked_at_last] if check[1] in LONGEST else [])
    for check in checks()])
def test_check(request, library, program, name, new):
    if new and library.original:
        pytest.skip("the original differs")
    status, out, err = request.getfixturevalue("runs").results[program, name].result(2 * LIMIT)
    if library.original:
        err = re.sub(r"^\[(un)?lockMutex\].*\n", "", err, flags=re.M)
    if (status, out, err) != (0, f"ok {name}\n", ""):
        pytest.fail(f"{program}.c: {name}: exit status {status}\n{out}{err}", pytrace=False)
