"""Builds the Python package ipc_cffi: what pyproject.toml cannot say.

Besides the extension module these are the programs of the project, which the package brings along:
the server central, the commands killCentral and killModule, and, where bison and flex are found,
xdrgen; and what C programs are built with: headers, the static library, a file for pkg-config.
With a library that is installed (IPC_CFFI_LIBRARY) they are expected to be so as well.
"""
import glob
import os
import shutil
import subprocess
import sys

from setuptools import Command, setup
from setuptools.command.build import build

ROOT = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(ROOT, "python", "ipc_cffi"))
import _build  # noqa: E402  pylint: disable=wrong-import-position

LOWER = ("base", "platform", "platform/posix", "format", "wire", "link")


def sources(*folders, without=()):
    """The C files in folders of src/c."""
    return [os.path.relpath(path) for folder in folders
            for path in sorted(glob.glob(os.path.join(ROOT, "src/c", folder, "*.c")))
            if os.path.basename(path) not in without]


def is_newer(target, files):
    """Whether the target is there and newer than all files."""
    return os.path.exists(target) and all(os.path.getmtime(target) > os.path.getmtime(file)
                                          for file in files)


def headers():
    """What else all that is compiled depends on."""
    return [*glob.glob(os.path.join(ROOT, "**/*.h"), recursive=True),
            os.path.join(ROOT, "CMakeLists.txt")]


PKG_CONFIG = """\
prefix=${{pcfiledir}}/../..

Name: ipc
Description: Inter-Process Communication for the modules of a robot
Version: {version}
Cflags: -I${{prefix}}/include -I${{prefix}}/include/ipc
Libs: -L${{prefix}}/lib -lipc -pthread
"""


class BuildPrograms(Command):
    """Compiles the programs into the package."""

    description = "build the programs that the package brings along"
    user_options = []

    def initialize_options(self):
        self.build_lib = self.build_temp = None

    def finalize_options(self):
        self.set_undefined_options("build", ("build_lib", "build_lib"),
                                   ("build_temp", "build_temp"))

    def run(self):
        from setuptools._distutils.ccompiler import new_compiler
        from setuptools._distutils.sysconfig import customize_compiler
        self.compiler = new_compiler()
        customize_compiler(self.compiler)
        self.macros = [*_build.versions().items(), ("IPC_BUILD_TIME", '""')]
        self.includes = [os.path.join(ROOT, "src/c"), os.path.join(ROOT, "include")]
        # Access control needs libwrap, which a package for any machine cannot count on.
        self.program("central", sources(*LOWER, "platform/server", "platform/posix/server",
                                        "central", "central/*",
                                        without=["rules.c"]))
        library = self.library()
        for command in ("killCentral", "killModule"):
            self.program(command, [os.path.join("src/c/shell", f"{command}.c"), library])
        if shutil.which("bison") and shutil.which("flex"):
            self.xdrgen()
        else:
            self.warn("no bison and flex here: the package is built without xdrgen")

    def program(self, name, files, includes=(), macros=()):
        """Compiles and links one program, of sources and libraries, if it is not up to date."""
        target = os.path.join(self.build_lib, "ipc_cffi", "bin", name)
        if is_newer(target, [*files, *headers()]):
            return
        libraries = [file for file in files if file.endswith(".a")]
        objects = self.compiler.compile(
            [file for file in files if file not in libraries],
            output_dir=os.path.join(self.build_temp, name),
            macros=[*self.macros, *macros], include_dirs=[*self.includes, *includes],
            extra_postargs=_build.FLAGS)
        self.compiler.link_executable([*objects, *libraries], name, output_dir=os.path.dirname(target),
                                      extra_postargs=["-pthread"])

    def library(self):
        """Adds what C programs need to be built against this copy of the library; its path."""
        package = os.path.join(self.build_lib, "ipc_cffi")
        files = sources(*LOWER, "libipc")
        folders = [os.path.join(package, name) for name in ("include/ipc", "lib/pkgconfig")]
        for folder in folders:
            os.makedirs(folder, exist_ok=True)
        for header in ("ipc.h", "ipcx.h"):
            shutil.copy(os.path.join(ROOT, "include/ipc", header), folders[0])
        with open(os.path.join(folders[1], "ipc.pc"), "w", encoding="utf-8") as file:
            file.write(PKG_CONFIG.format(version=_build.versions()["IPC_VERSION"].strip('"')))
        target = os.path.join(package, "lib", "libipc.a")
        if is_newer(target, [*files, *headers()]):
            return target
        objects = self.compiler.compile(
            files, output_dir=os.path.join(self.build_temp, "libipc"), macros=self.macros,
            include_dirs=self.includes, extra_postargs=[*_build.FLAGS, "-fPIC", "-fvisibility=hidden"])
        self.compiler.create_static_lib(objects, "ipc", output_dir=os.path.dirname(target))
        return target

    def xdrgen(self):
        """Makes the parser and builds xdrgen."""
        made = os.path.join(self.build_temp, "xdrgen-parser")
        os.makedirs(made, exist_ok=True)
        folder = os.path.join(ROOT, "xdrgen")
        parser, scanner = os.path.join(made, "grammar.c"), os.path.join(made, "scanner.c")
        if not is_newer(scanner, glob.glob(os.path.join(folder, "*.[yl]"))):
            subprocess.run(["bison", f"--defines={made}/grammar.h", "-o", parser,
                            os.path.join(folder, "grammar.y")], check=True)
            subprocess.run(["flex", f"--header-file={made}/scanner.h", "-o", scanner,
                            os.path.join(folder, "scanner.l")], check=True)
        files = [os.path.relpath(path) for path in sorted(
            glob.glob(os.path.join(folder, "*.c")) +
            glob.glob(os.path.join(folder, "platform/*.c")) +
            glob.glob(os.path.join(folder, "platform/posix/*.c")))]
        self.program("xdrgen", [*files, *sources("base", "platform", "platform/posix", "format"),
                                parser, scanner], [folder, made],
                     [("XDRGEN_VERSION", _build.versions()["IPC_VERSION"])])


class Build(build):
    """The usual build, and the programs."""

    sub_commands = [*build.sub_commands,
                    ("build_programs", lambda self: not os.environ.get("IPC_CFFI_LIBRARY"))]


setup(cffi_modules=["python/ipc_cffi/_build.py:ffibuilder"],
      cmdclass={"build": Build, "build_programs": BuildPrograms},
      options={"bdist_wheel": {"py_limited_api": "cp39"}})
