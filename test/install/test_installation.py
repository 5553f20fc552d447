"""`cmake --install`, and programs that are built with what it has installed."""
import os
import re
import shutil

import pytest

from install.tools import Installation, ROOT, links_to_files, run, tool

EXPECTED = {"central", "ipc.h", "ipcx.h", "ipc.pc", "ipcConfig.cmake", "ipcConfigVersion.cmake",
            "ipcTargets.cmake", "killCentral", "killModule", "libipc.a", "libipc.so", "libipc.so.1",
            "LICENSE", "xdrgen"}
PAGES = {"man1": {"xdrgen.1", "killCentral.1", "killModule.1"}, "man5": {"ipc-format.5"},
         "man7": {"ipc.7"}, "man3": {"IPC_connect.3", "IPC_errno.3", "IPCx_fd.3", "killModule.3"}}
OUTPUT = '{1, "two"}\n'


def test_everything_that_users_need_is_installed_in_its_place(installation):
    names = {os.path.basename(file) for file in installation.files}
    assert EXPECTED <= names
    assert "include/ipc/ipc.h" in installation.files
    assert "bin/central" in installation.files


def test_nothing_private_is_installed(installation):
    headers = [file for file in installation.files
               if file.endswith(".h") and not file.startswith("share/doc/")]
    assert headers == ["include/ipc/ipc.h", "include/ipc/ipcx.h"]


@pytest.mark.parametrize("folder", sorted(PAGES))
def test_manual_pages_are_where_man_looks_for_them(folder, installation):
    found = {os.path.basename(file) for file in installation.files
             if file.startswith(f"share/man/{folder}/")}
    assert PAGES[folder] <= found


@pytest.mark.parametrize("page", ["IPC_queryResponseData", "IPCx_process", "ipc", "ipc-format",
                                  "xdrgen", "killCentral"])
def test_man_finds_the_manual_pages(page, installation):
    path = run(tool("man"), "-M", os.path.join(installation.prefix, "share/man"), "-w", page)
    assert os.path.basename(path.strip()).startswith(f"{page}.")


def test_documents_are_installed_and_lead_to_each_other(installation):
    documents = [os.path.join(installation.prefix, file) for file in installation.files
                 if re.fullmatch(r"share/doc/.*\.md", file)]
    assert any(file.endswith("docs/manual/README.md") for file in documents)
    missing = {(document, link) for document in documents for link in links_to_files(document)
               if not os.path.exists(os.path.join(os.path.dirname(document), link))}
    assert not missing


def test_the_installed_server_runs(installation):
    assert "command line options" in run(installation.path("central"), "-h")


@pytest.mark.parametrize("command", ["killCentral", "killModule"])
def test_installed_commands_find_the_library_that_was_installed_with_them(installation, command):
    needed = run(tool("ldd"), installation.path(command))
    assert os.path.realpath(installation.path("libipc.so.1")) in {
        os.path.realpath(word) for word in needed.split()}


def test_destdir_stands_before_the_prefix(build, tmp_path):
    run("cmake", "--install", build.directory, "--prefix", "/opt/robot",
        env={"DESTDIR": str(tmp_path)})
    staged = Installation(str(tmp_path))
    assert "opt/robot/include/ipc/ipc.h" in staged.files
    assert all(file.startswith("opt/robot/") for file in staged.files)


def test_uninstalling_leaves_what_others_have_put_there(build, tmp_path):
    """By the list of an installation; see cmake/uninstall.cmake."""
    destdir = {"DESTDIR": str(tmp_path)}
    run("cmake", "--install", build.directory, "--prefix", "/opt/robot", env=destdir)
    manifest = shutil.copy(os.path.join(build.directory, "install_manifest.txt"), tmp_path)
    others = [tmp_path / "opt/robot" / name for name in ("bin/other", "include/ipc/other.h")]
    for file in others:
        file.touch()
    run("cmake", "-D", f"MANIFEST={manifest}", "-P", f"{ROOT}/cmake/uninstall.cmake", env=destdir)
    assert sorted(file for file in tmp_path.rglob("*") if not file.is_dir()) == others
    assert not list(tmp_path.rglob("cmake/ipc"))


def test_the_library_can_be_installed_without_xdrgen(build, tmp_path, consumer):
    run("cmake", "--install", build.directory, "--prefix", tmp_path / "prefix")
    installed = Installation(str(tmp_path / "prefix"))
    for file in installed.files:
        if "xdrgen" in file.lower():
            os.remove(os.path.join(installed.prefix, file))
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\n"
        "project(consumer LANGUAGES C)\n"
        "find_package(ipc REQUIRED)\n"
        f"add_executable(consumer {consumer})\n"
        "target_link_libraries(consumer PRIVATE ipc::ipc)\n")
    build_with_cmake(tmp_path, build, f"-DCMAKE_PREFIX_PATH={installed.prefix}")
    assert run(tmp_path / "out/consumer", env=installed.env) == OUTPUT


@pytest.mark.parametrize("linking", [[], ["--static"]], ids=["shared", "static"])
def test_pkg_config_gives_flags_that_work(linking, build, installation, consumer, tmp_path):
    flags = run(tool("pkg-config"), *linking, "--cflags", "--libs", "ipc",
                env=installation.env).split()
    if linking:
        flags = [installation.path("libipc.a") if flag == "-lipc" else flag for flag in flags]
    program = tmp_path / "consumer"
    run(build.compiler, *build.flags, consumer, "-o", program, *flags)
    assert ("libipc.so.1" in run(tool("readelf"), "-d", program)) == (not linking)
    assert run(program, env=installation.env) == OUTPUT


def test_pkg_config_knows_the_version(build, installation):
    version = run(tool("pkg-config"), "--modversion", "ipc", env=installation.env)
    assert version.strip() == build.cache["CMAKE_PROJECT_VERSION"]


@pytest.mark.parametrize("request_", ["", "3.9", "4.0"], ids=["any", "old", "new"])
@pytest.mark.parametrize("target", ["ipc::ipc", "ipc::ipc_static"])
def test_find_package_gives_targets_that_work(target, request_, build, installation, consumer,
                                              tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\n"
        "project(consumer LANGUAGES C)\n"
        f"find_package(ipc {request_} REQUIRED)\n"
        "add_executable(consumer consumer.c)\n"
        f"target_link_libraries(consumer PRIVATE {target})\n")
    build_with_cmake(tmp_path, build, f"-DCMAKE_PREFIX_PATH={installation.prefix}")
    assert run(tmp_path / "out/consumer", env=installation.env) == OUTPUT


def build_with_cmake(source, build, *options):
    """Builds the project in source, in out beside it, with the compiler and flags of the build."""
    out = source / "out"
    run("cmake", "-S", source, "-B", out, f"-DCMAKE_C_COMPILER={build.compiler}",
        f"-DCMAKE_C_FLAGS={' '.join(build.flags)}", *options)
    run("cmake", "--build", out, "--parallel", "2")
