"""The build under test, what is installed from it, and commands that must succeed."""
import os
import re
import shutil
import subprocess

import pytest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.environ.get("IPC_BUILD_DIR") or os.path.join(ROOT, "build", "dev")
PATIENCE = 300  # seconds for one command, on a slow machine


def run(*command, env=None, cwd=None):
    """Runs a command that must succeed, and returns what it wrote on standard output."""
    done = subprocess.run([str(word) for word in command], cwd=cwd, env={**os.environ, **(env or {})},
                          stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=PATIENCE, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def tool(name):
    """Path of a program; the test is skipped where there is none."""
    path = shutil.which(name)
    if path is None:
        pytest.skip(f"no {name} on this machine")
    return path


def links_to_files(document):
    """The targets of a Markdown document's links that are not elsewhere in the world."""
    with open(document, encoding="utf-8") as file:
        text = re.sub("```.*?```", "", file.read(), flags=re.DOTALL)
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
    return [link for link in links if not re.match(r"\w+:", link)]


class Build:
    """A finished build of the project."""

    def __init__(self, directory):
        self.directory = directory
        with open(os.path.join(directory, "CMakeCache.txt"), encoding="utf-8") as cache:
            self.cache = dict(re.findall(r"^(\w+):\w+=(.*)$", cache.read(), re.MULTILINE))
        sanitizers = self.cache.get("IPC_SANITIZE")
        self.shared_library = os.path.join(directory, "src/c/libipc/libipc.so.1")
        self.static_library = os.path.join(directory, "src/c/libipc/libipc.a")
        self.compiler = self.cache["CMAKE_C_COMPILER"]
        self.flags = [f"-fsanitize={sanitizers}"] if sanitizers else []


class Installation:
    """What `cmake --install` put somewhere."""

    def __init__(self, prefix):
        self.prefix = prefix
        self.files = sorted(os.path.relpath(os.path.join(folder, name), prefix)
                            for folder, _, names in os.walk(prefix) for name in names)
        self.pkgconfig = os.path.dirname(self.path("ipc.pc"))
        self.libdir = os.path.dirname(self.path("libipc.so.1"))
        # Programs find the shared library; a leak of the sanitizers' own making is of no interest.
        self.env = {"LD_LIBRARY_PATH": self.libdir, "PKG_CONFIG_PATH": self.pkgconfig,
                    "ASAN_OPTIONS": "detect_leaks=0"}

    def path(self, name):
        """Full path of the one installed file of that name."""
        found = [file for file in self.files if os.path.basename(file) == name]
        assert len(found) == 1, f"{name}: {found} among {self.files}"
        return os.path.join(self.prefix, found[0])
