"""Builds the Python package ipc_cffi: what pyproject.toml cannot say.

Besides the extension module these are the programs of the project, which the package brings along:
the server central, the commands killCentral and killModule, and, where bison and flex are found,
xdrgen.  With a library that is installed (IPC_CFFI_LIBRARY) they are expected to be so as well.
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
        self.program("central", sources(*LOWER, "platform/server", "platform/posix/server", "central",
                                        without=["rules.c"]))
        for command in ("killCentral", "killModule"):
            self.program(command, [*sources(*LOWER, "libipc"),
                                   os.path.relpath(os.path.join(ROOT, f"src/c/shell/{command}.c"))])
        if shutil.which("bison") and shutil.which("flex"):
            self.xdrgen()
        else:
            self.warn("no bison and flex here: the package is built without xdrgen")

    def program(self, name, files, includes=(), macros=()):
        """Compiles and links one program if it is not up to date."""
        target = os.path.join(self.build_lib, "ipc_cffi", "bin", name)
        headers = glob.glob(os.path.join(ROOT, "**/*.h"), recursive=True)
        if is_newer(target, [*files, *headers, os.path.join(ROOT, "CMakeLists.txt")]):
            return
        objects = self.compiler.compile(
            files, output_dir=os.path.join(self.build_temp, name),
            macros=[*self.macros, *macros], include_dirs=[*self.includes, *includes],
            extra_postargs=["-std=gnu99"])
        self.compiler.link_executable(objects, name, output_dir=os.path.dirname(target),
                                      extra_postargs=["-pthread"])

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
