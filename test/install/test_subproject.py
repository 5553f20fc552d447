"""The project as a part of another one, by add_subdirectory as FetchContent does it."""
import re

import pytest

from install.tools import ROOT, run

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
