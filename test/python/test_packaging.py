"""The package as others get it: from a source distribution, into an empty environment."""
import os
import shutil
import subprocess
import sys

import pytest

from python.tools import ROOT
from support.processes import Central
from support.waiting import SLOW

pytestmark = pytest.mark.usefixtures("once")

PARTS = ("CMakeLists.txt", "CHANGELOG.md", "LICENSE", "MANIFEST.in", "pyproject.toml", "setup.py",
         "docs", "include", "python", "src", "xdrgen")

PROGRAM = """
import ipc_cffi, os
assert os.path.dirname(ipc_cffi.__file__).startswith(os.environ["EXPECTED"]), ipc_cffi.__file__
import IPC
IPC.IPC_connect("installed")
IPC.IPC_defineMsg("m", IPC.IPC_VARIABLE_LENGTH, "{int, string}")
got = []
IPC.IPC_subscribeData("m", lambda instance, data, client_data: got.append((data.f0, data.f1)))
IPC.IPC_publishData("m", (1, "text"))
while not got:
    IPC.IPC_listen(1000)
print("got", got)
"""


def run(*arguments, **options):
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True,
                          text=True, timeout=400 * SLOW, check=False, **options)
    assert done.returncode == 0, f"{arguments}\n{done.stdout[-2000:]}\n{done.stderr[-3000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """An environment into which the package was installed from a source distribution."""
    try:
        import setuptools.command.bdist_wheel  # noqa: F401
    except ImportError:
        pytest.importorskip("wheel", reason="older setuptools need the package wheel")
    here = tmp_path_factory.mktemp("package")
    tree = here / "tree"
    tree.mkdir()
    for part in PARTS:
        source = os.path.join(ROOT, part)
        if os.path.isdir(source):
            shutil.copytree(source, tree / part,
                            ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            shutil.copy(source, tree / part)
    try:
        run(sys.executable, "-m", "venv", "--system-site-packages", here / "venv")
    except AssertionError:
        pytest.skip("no environments with pip can be made here (Debian: python3-venv)")
    python = here / "venv" / "bin" / "python"
    # What the environment of the tests itself has may be used for building.
    paths = os.pathsep.join(path for path in sys.path if path.endswith("site-packages"))
    with open(run(python, "-c", "import site; print(site.getsitepackages()[0])").strip() +
              "/tests.pth", "w", encoding="utf-8") as file:
        file.write("\n".join(paths.split(os.pathsep)) + "\n")
    run(python, "-m", "pip", "--disable-pip-version-check", "uninstall", "-y", "setuptools")
    run(python, "setup.py", "-q", "sdist", "--dist-dir", here / "dist", cwd=tree)
    archive, = (here / "dist").iterdir()
    run(python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index",
        "--disable-pip-version-check", archive, cwd=here, env={**os.environ, "CFLAGS": "-O0"})
    return here / "venv"


def test_an_installed_package_works_elsewhere(environment, tmp_path, stack):
    central = stack.enter_context(Central(environment / "bin" / "central"))
    out = run(environment / "bin" / "python", "-c", PROGRAM, cwd=tmp_path,
              env={"CENTRALHOST": central.address, "EXPECTED": str(environment)})
    assert "got [(1, 'text')]" in out
    run(environment / "bin" / "killCentral", env={"CENTRALHOST": central.address})
    assert central.wait() == 0
    central._stopped = True


HELLO = """
#include <stdio.h>
#include <ipc/ipcx.h>
int main(void)
{
    IPC_VARCONTENT_TYPE bytes;
    int number = 7;
    IPC_initialize();
    IPC_marshall(IPC_parseFormat("int"), &number, &bytes);
    printf("%u bytes\\n", bytes.length);
    return 0;
}
"""


def test_c_programs_are_built_against_it(environment, tmp_path):
    def say(what):
        return run(environment / "bin" / "python", "-c", f"import ipc_cffi; print({what})",
                   cwd=tmp_path).strip()
    source, program = tmp_path / "hello.c", tmp_path / "hello"
    source.write_text(HELLO)
    run("cc", source, "-I" + say("ipc_cffi.include_dir()"), say("ipc_cffi.library_path()"),
        "-pthread", "-o", program)
    assert run(program) == "4 bytes\n"
    if shutil.which("pkg-config"):
        env = {**os.environ, "PKG_CONFIG_PATH": say("ipc_cffi.pkgconfig_dir()")}
        flags = run("pkg-config", "--cflags", "--libs", "ipc", env=env).split()
        run("cc", source, *flags, "-o", program)
        assert run(program) == "4 bytes\n"
        assert run("pkg-config", "--modversion", "ipc", env=env).strip() == say(
            "ipc_cffi.library_version()")


def test_the_demo_needs_nothing_else(environment, tmp_path):
    out = run(environment / "bin" / "python", "-m", "ipc_cffi", "demo", cwd=tmp_path,
              env={"PATH": "/nowhere"})
    assert "all went well" in out


def test_the_programs_come_along(environment):
    for program in ("central", "killCentral", "killModule", "xdrgen", "ipc-central",
                    "ipc-xdrgen"):
        assert os.access(environment / "bin" / program, os.X_OK)
    if shutil.which("bison") and shutil.which("flex"):
        assert "xdrgen" in run(environment / "bin" / "xdrgen", "--help")
