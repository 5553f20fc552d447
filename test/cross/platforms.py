"""Other machines: what builds for them here, what runs their programs, and what is missing for it."""
import dataclasses
import os
import shutil
import subprocess
import tempfile

from support.driver import FLAGS, SOURCE
from support.waiting import SLOW

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
INCLUDES = [f"-I{os.path.join(ROOT, 'include', folder)}" for folder in ("ipc", "")]
BUILD_SECONDS = 600 * SLOW


class Missing(Exception):
    """Why there can be no program for a platform, or none can run."""


@dataclasses.dataclass(frozen=True)
class Platform:
    """A kind of machine, of C library, or of system."""

    name: str
    toolchain: str  # a file of CMake's
    compiler: str
    order: str
    long_size: int
    runner: tuple = ()  # the command before a program
    link: tuple = ()    # what the linker is told besides
    windows: bool = False

    def check(self):
        """Raises Missing with the reason."""
        for command in (self.compiler, *self.runner[:1]):
            if shutil.which(command) is None:
                raise Missing(f"no {command}")


def _debian(name, triple, order, long_size, *runner):
    return Platform(name, f"cmake/toolchains/{triple}.cmake", f"{triple}-gcc", order, long_size,
                    runner)


PLATFORMS = {platform.name: platform for platform in (
    _debian("s390x", "s390x-linux-gnu", ">", 8, "qemu-s390x", "-L", "/usr/s390x-linux-gnu"),
    _debian("powerpc", "powerpc-linux-gnu", ">", 4, "qemu-ppc", "-L", "/usr/powerpc-linux-gnu"),
    _debian("i686", "i686-linux-gnu", "<", 4, "/usr/i686-linux-gnu/lib/ld-linux.so.2",
            "--library-path", "/usr/i686-linux-gnu/lib"),
    Platform("musl", "cmake/toolchains/musl.cmake", "musl-gcc", "<", 8, link=("-static",)),
    Platform("windows", "Windows/mingw.cmake", "x86_64-w64-mingw32-gcc", "<", 4, runner=("wine",),
             link=("-static-libgcc", "-Wl,-Bstatic"), windows=True))}


class Wine:
    """What wine needs to run programs: a folder that is its Windows, and processes that serve it,
    until close()."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="wine-")
        self.environment = {"WINEPREFIX": os.path.join(self.folder, "prefix"), "WINEDEBUG": "-all",
                            "TMPDIR": self.folder,  # for the server's lock
                            "WINEDLLOVERRIDES": "mscoree=;mshtml="}  # installs nothing then
        os.mkdir(self.environment["WINEPREFIX"])
        patience = os.path.join(self.folder, "patience.so")
        self._run("cc", "-shared", "-fPIC", "-o", patience,
                  os.path.join(ROOT, "test/cross/patient_wineserver.c"))
        if not os.path.exists(patience):
            raise Missing("cc makes no library for wineserver")
        # It stays, and so do the services that wineboot starts, so that programs start fast and
        # leave nothing behind.
        self._run("wineserver", "-p", LD_PRELOAD=patience)
        self._run("wineboot", "-i")

    def _run(self, *command, **environment):
        try:
            subprocess.run(command, env={**os.environ, **self.environment, **environment},
                           check=False, timeout=BUILD_SECONDS, stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except FileNotFoundError:
            raise Missing(f"no {command[0]}") from None

    def close(self):
        self._run("wineserver", "-k")
        self._run("wineserver", "-w")
        shutil.rmtree(self.folder, ignore_errors=True)


class Machine:
    """The project, built for a platform; its programs can be started like those of this machine."""

    def __init__(self, platform, directory):
        self.platform, self.directory = platform, directory
        self.order, self.long_size = platform.order, platform.long_size
        self.wine = None
        platform.check()
        os.makedirs(directory, exist_ok=True)
        self._run("cmake", "-S", ROOT, "-B", directory, "-DIPC_BUILD_TESTS=ON",
                  "-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DIPC_WERROR=ON",
                  f"-DCMAKE_TOOLCHAIN_FILE={ROOT}/{platform.toolchain}")
        self._run("cmake", "--build", directory, "--parallel", "2")
        if platform.windows:
            self.wine = Wine()
        self.environment = self.wine.environment if self.wine else {}
        self.central = self.program("src/c/central/central")
        self._check_that_programs_run()
        self._build_driver()
        self.driver = self.program("module_driver")

    def close(self):
        """Ends what serves its programs."""
        wine, self.wine = self.wine, None
        if wine:
            wine.close()

    @staticmethod
    def _run(*command):
        done = subprocess.run(command, capture_output=True, text=True, timeout=BUILD_SECONDS,
                              stdin=subprocess.DEVNULL, check=False)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-3000:]}\n{done.stderr}"

    def _check_that_programs_run(self):
        try:
            done = subprocess.run([self.central, "-v"], capture_output=True, text=True,
                                  timeout=60 * SLOW, stdin=subprocess.DEVNULL, check=False)
        except OSError as error:
            raise Missing(f"its programs do not run here: {error}") from None
        if "Task Control Server" not in done.stdout + done.stderr:
            raise Missing(f"its programs do not run here: {done.stderr.strip()}")

    def _build_driver(self):
        library = os.path.join(self.directory, "src/c/libipc")
        self._run(self.platform.compiler, "-g", "-o", self._path("module_driver"), SOURCE, *FLAGS,
                  *INCLUDES, f"-L{library}", f"-Wl,-rpath,{library}", "-lipc",
                  *self.platform.link, "-lpthread")

    def _path(self, program):
        if self.platform.windows:  # all beside the DLL
            program = f"bin/{os.path.basename(program)}.exe"
        return os.path.join(self.directory, program)

    def program(self, path):
        """A command of one word that runs the program with that path in the build, and becomes it."""
        command = os.path.join(self.directory, f"run-{os.path.basename(path)}")
        with open(command, "w", encoding="utf-8") as script:
            script.write("#!/bin/sh\n")
            script.writelines(f"export {variable}='{value}'\n"
                              for variable, value in self.environment.items())
            script.write(f'exec {" ".join((*self.platform.runner, self._path(path)))} "$@"\n')
        os.chmod(command, 0o755)
        return command

    def unit_tests(self, *selection):
        """Runs the unit tests that the options of ctest select; returns status and output."""
        done = subprocess.run(
            ["ctest", "--test-dir", self.directory, "--output-on-failure", "--no-tests=error",
             *selection], capture_output=True, text=True, timeout=BUILD_SECONDS,
            stdin=subprocess.DEVNULL, check=False, env={**os.environ, **self.environment})
        return done.returncode, done.stdout + done.stderr
