"""The project as a part of another one, by add_subdirectory as FetchContent does it."""
import re

import pytest

from install.tools import ROOT, run, tool

pytestmark = pytest.mark.usefixtures("once")

CONSUMER = f"""
cmake_minimum_required(VERSION 3.16)
project(robot LANGUAGES C)
add_subdirectory({ROOT} ipc)
add_executable(consumer consumer.c)
target_link_libraries(consumer PRIVATE ipc)
install(TARGETS consumer)
"""


@pytest.fixture(scope="module")
def configured(tmp_path_factory):
    """A project that contains this one, has tests of its own, and is configured."""
    source = tmp_path_factory.mktemp("robot")
    (source / "CMakeLists.txt").write_text(CONSUMER)
    (source / "consumer.c").touch()
    said = run("cmake", "-S", source, "-B", source / "out", "-DBUILD_TESTS=ON")
    return source, said


def test_tests_and_examples_are_off_and_the_parents_switches_its_own(configured):
    source, _ = configured
    cache = (source / "out/CMakeCache.txt").read_text()
    assert "IPC_BUILD_TESTS:BOOL=OFF" in cache
    assert "IPC_BUILD_EXAMPLES:BOOL=OFF" in cache
    assert re.search("^CMAKE_BUILD_TYPE:STRING=$", cache, re.MULTILINE)


def test_target_ipc_works(configured, consumer):
    source, _ = configured
    with open(consumer, encoding="utf-8") as text:
        (source / "consumer.c").write_text(text.read())
    run("cmake", "--build", source / "out", "--target", "consumer", "--parallel", "2")
    assert run(source / "out/consumer") == '{1, "two"}\n'


def test_only_the_parents_things_are_installed(configured, tmp_path):
    source, _ = configured
    scripts = list((source / "out").rglob("cmake_install.cmake"))
    assert scripts
    assert not [script for script in scripts if "libipc" in script.read_text()
                and "file(INSTALL" in script.read_text() and "/ipc/" in str(script)]


def test_fetch_content_gives_the_target_ipc_ipc(consumer, tmp_path):
    """Nothing is fetched: the source is here."""
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\n"
        "project(robot LANGUAGES C)\n"
        "include(FetchContent)\n"
        f"FetchContent_Declare(ipc SOURCE_DIR {ROOT})\n"
        "FetchContent_MakeAvailable(ipc)\n"
        f"add_executable(consumer {consumer})\n"
        "target_link_libraries(consumer PRIVATE ipc::ipc)\n")
    run("cmake", "-S", tmp_path, "-B", tmp_path / "out")
    run("cmake", "--build", tmp_path / "out", "--target", "consumer", "--parallel", "2")
    assert run(tmp_path / "out/consumer") == '{1, "two"}\n'


# What a project that contains CMU IPC says: variables or options, the folder, the target ipc.
OLD_USER = """
cmake_minimum_required(VERSION 3.5)
project(robot C)
{settings}
add_subdirectory({root} third-party/ipc)
if(NOT THREADED)
    message(FATAL_ERROR "THREADED has gone")
endif()
add_executable(consumer consumer.c)
target_link_libraries(consumer ipc c)
install(TARGETS consumer ipc central RUNTIME DESTINATION bin LIBRARY DESTINATION lib)
"""
SETTINGS = {
    "nothing": "",
    "variables": "set(THREADED ON)\nset(BUILD_SHARED_LIBS OFF)\nset(BUILD_TESTS OFF)",
    "options": """option(THREADED "" ON)
option(BUILD_SHARED_LIBS "" OFF)
option(BUILD_TESTS "" ON)""",
}


@pytest.mark.parametrize("settings,is_shared", [
    ("nothing", True), ("variables", False), ("options", False)])
def test_a_project_that_contained_cmu_ipc_works_with_this_one(settings, is_shared, consumer,
                                                              tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        OLD_USER.format(settings=SETTINGS[settings], root=ROOT))
    run("cmake", "-S", tmp_path, "-B", tmp_path / "out", f"-DCMAKE_INSTALL_PREFIX={tmp_path}/prefix")
    run("cmake", "--build", tmp_path / "out", "--parallel", "2")
    assert ("libipc.so.1" in run(tool("readelf"), "-d", tmp_path / "out/consumer")) == is_shared
    run("cmake", "--install", tmp_path / "out")
    assert bool(list((tmp_path / "prefix").rglob("libipc.so.1"))) == is_shared
    assert (tmp_path / "prefix/bin/central").exists()
    assert run(tmp_path / "prefix/bin/consumer",
               env={"LD_LIBRARY_PATH": f"{tmp_path}/prefix/lib"}) == '{1, "two"}\n'


def test_a_project_may_install_this_one_with_itself(tmp_path):
    """As CMU IPC does unasked."""
    (tmp_path / "CMakeLists.txt").write_text(CONSUMER)
    (tmp_path / "consumer.c").write_text("int main(void) { return 0; }\n")
    run("cmake", "-S", tmp_path, "-B", tmp_path / "out", "-DIPC_INSTALL=ON")
    run("cmake", "--build", tmp_path / "out", "--parallel", "2")
    run("cmake", "--install", tmp_path / "out", "--prefix", tmp_path / "prefix")
    installed = {str(path.relative_to(tmp_path / "prefix"))
                 for path in (tmp_path / "prefix").rglob("*")}
    assert {"bin/consumer", "bin/central", "include/ipc/ipc.h"} <= installed
    assert [name for name in installed if name.endswith("/libipc.so.1")]
