"""The options that builds of CMU IPC set, and the two kinds of library."""
import pytest

from install.tools import ROOT, run

pytestmark = pytest.mark.usefixtures("once")


def configure(out, *options):
    """Configures the project and returns what CMake said, warnings included."""
    return run("sh", "-c", 'exec cmake -S "$0" -B "$@" 2>&1', ROOT, out, *options)


def cache_of(out):
    return (out / "CMakeCache.txt").read_text().splitlines()


def test_options_of_the_original_are_accepted(tmp_path):
    said = configure(tmp_path, "-DTHREADED=1", "-DBUILD_SHARED_LIBS=ON", "-DBUILD_TESTS=OFF")
    assert "not used by the project" not in said
    assert "Warning" not in said


@pytest.mark.parametrize("value", ["ON", "OFF"])
def test_build_tests_is_another_name_of_ipc_build_tests(tmp_path, value):
    configure(tmp_path, f"-DBUILD_TESTS={value}")
    assert f"IPC_BUILD_TESTS:BOOL={value}" in cache_of(tmp_path)


def test_an_unspecified_build_is_optimised_and_has_no_tests(tmp_path):
    configure(tmp_path)
    assert "CMAKE_BUILD_TYPE:STRING=Release" in cache_of(tmp_path)
    assert "IPC_BUILD_TESTS:BOOL=OFF" in cache_of(tmp_path)


@pytest.mark.parametrize("awk", ["awk", "OFF"])
def test_without_awk_only_the_pages_that_it_makes_are_left_out(tmp_path, awk):
    said = configure(tmp_path, f"-DIPC_AWK={awk}")
    targets = run("cmake", "--build", tmp_path, "--target", "help")
    assert ("ipc_manual" in targets) == ("No awk" not in said) == (awk == "awk")


@pytest.mark.parametrize("shared", ["ON", "OFF"])
def test_build_shared_libs_chooses_the_library(tmp_path, shared):
    configure(tmp_path, f"-DBUILD_SHARED_LIBS={shared}")
    targets = run("cmake", "--build", tmp_path, "--target", "help")
    assert ("ipc_static" in targets) == (shared == "ON")


def test_a_static_build_installs_a_working_package(tmp_path, consumer):
    out, prefix, user = tmp_path / "out", tmp_path / "prefix", tmp_path / "user"
    configure(out, "-DBUILD_SHARED_LIBS=OFF", "-DIPC_BUILD_EXAMPLES=OFF",
              f"-DCMAKE_INSTALL_PREFIX={prefix}")
    run("cmake", "--build", out, "--parallel", "2")
    run("cmake", "--install", out)
    assert list(prefix.rglob("libipc.a")) and not list(prefix.rglob("libipc.so*"))
    user.mkdir()
    (user / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\n"
        "project(user LANGUAGES C)\n"
        "find_package(ipc REQUIRED)\n"
        f"add_executable(user {consumer})\n"
        "target_link_libraries(user PRIVATE ipc::ipc)\n")
    run("cmake", "-S", user, "-B", user / "out", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", user / "out")
    assert run(user / "out/user") == '{1, "two"}\n'
