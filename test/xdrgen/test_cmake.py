"""The function ipc_xdrgen, in a project that finds the installed package and in one that contains
this project."""
import subprocess

import pytest

from xdrgen.conftest import BUILD, ROOT

PROJECT = """cmake_minimum_required(VERSION 3.16)
project(robot LANGUAGES C CXX)
{find}
add_executable(robot main.c)
target_link_libraries(robot PRIVATE {library})
ipc_xdrgen(robot messages.xdr sub/other.xdr OPTIONS --register)
add_executable(robot_cxx main.cc)
ipc_xdrgen(robot_cxx messages.xdr LANGUAGE c++ DIRECTORY made)
"""
FIND = "find_package(ipc REQUIRED)"
CONTAIN = f'set(IPC_BUILD_XDRGEN ON)\nadd_subdirectory("{ROOT}" ipc EXCLUDE_FROM_ALL)'
MAIN = """#include "messages.xdr.h"
#include "other.xdr.h"
int main(void)
{
  Pose pose = {1.0, 2.0};
  Other other = {3};
  IPC_initialize();
  return IPC_parseFormat(Pose_IPC_FORMAT) != 0 && pose.x + other.i == 4.0 ? 0 : 1;
}
"""
MAIN_CXX = """#include "messages.xdr.h"
int main() { return Pose::getIPCFormat()[0] == '{' ? 0 : 1; }
"""


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          timeout=600, check=False, stdin=subprocess.DEVNULL)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def build_project(folder, find, library, *options):
    """Writes a project, builds it, and runs its programs."""
    (folder / "sub").mkdir()
    (folder / "CMakeLists.txt").write_text(PROJECT.format(find=find, library=library))
    (folder / "messages.xdr").write_text("struct Pose { double x; double y; };\n")
    (folder / "sub" / "other.xdr").write_text("struct Other { int i; };\n")
    (folder / "main.c").write_text(MAIN)
    (folder / "main.cc").write_text(MAIN_CXX)
    run("cmake", "-S", folder, "-B", folder / "build", *options)
    run("cmake", "--build", folder / "build", "--target", "robot", "robot_cxx", "--parallel", "2")
    run(folder / "build" / "robot")
    run(folder / "build" / "robot_cxx")
    assert (folder / "build" / "made" / "messages.xdr.h").exists()


def test_a_project_that_finds_the_package_makes_headers(program, tmp_path):
    with open(f"{BUILD}/CMakeCache.txt", encoding="utf-8") as cache:
        settings = cache.read()
    if "IPC_SANITIZE:STRING=\n" not in settings:
        pytest.skip("a project without sanitizers cannot use a library with them")
    run("cmake", "--install", BUILD, "--prefix", tmp_path / "prefix")
    assert (tmp_path / "prefix/share/man/man1/xdrgen.1").exists()
    assert program
    build_project(tmp_path, FIND, "ipc::ipc", f"-DCMAKE_PREFIX_PATH={tmp_path / 'prefix'}")


def test_a_project_that_contains_this_one_makes_headers_anew_when_they_are_old(program, tmp_path):
    assert program
    build_project(tmp_path, CONTAIN, "ipc::ipc")
    (tmp_path / "messages.xdr").write_text("struct Pose { double x; double y; double theta; };\n")
    run("cmake", "--build", tmp_path / "build", "--target", "robot", "--parallel", "2")
    assert "theta" in (tmp_path / "build/xdrgen/robot/messages.xdr.h").read_text()
