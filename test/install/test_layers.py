"""The layers of src/c: who may include whom (docs/architecture.md)."""
import os
import re

from install.tools import ROOT

SOURCES = os.path.join(ROOT, "src/c")

# Each part, and what it may include besides itself.  Nothing includes what is above it, so no
# cycles are possible, and library and server do not know each other.
BELOW = {
    "base": set(),
    "platform": {"base"},
    "format": {"base"},
    "wire": {"base", "format"},
    "link": {"base", "platform", "wire"},
    "libipc": {"base", "platform", "format", "wire", "link", "ipc"},
    "central": {"base", "platform", "format", "wire", "link"},
    "shell": set(),
}

# The files of libipc from the ground up: each includes only files that stand before it.
LIBIPC = """
    library address report known_arrays
    source event_set wait
    context callback timer watch_fd
    exchange peer formatter definition registry
    define subscription instance inbox
    receive watcher handler_watch notify deliver
    direct queue publish
    handshake reconnect
    closing report_result
    connect listen query
    api shell
    api_connect api_context api_format api_notify api_listen compat
    api_extensions api_message api_query
""".split()

# The folders of central from the ground up, likewise; the program itself is above them.
CENTRAL = ["settings", "model", "log", "routing", "service", "operator"]

# Headers of operating systems: only platform/ may include them.
SYSTEM = re.compile(r"^(sys/|netinet/|arpa/|net/|linux/|unistd|fcntl|poll|pthread|signal|netdb"
                    r"|dirent|pwd|grp|termios|winsock|windows|ws2|tcpd|semaphore|sched)")


def includes():
    """(part, file, header, whether in quotes) of every #include line."""
    for folder, _, names in os.walk(SOURCES):
        for name in sorted(names):
            if not name.endswith((".c", ".h")):
                continue
            path = os.path.relpath(os.path.join(folder, name), SOURCES)
            with open(os.path.join(SOURCES, path), encoding="utf-8") as text:
                for quote, header in re.findall(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)',
                                                text.read(), re.MULTILINE):
                    yield path.split("/")[0], path, header, quote == '"'


def test_there_is_something_to_look_at():
    assert {part for part, *_ in includes()} <= set(BELOW)
    assert len(list(includes())) > 100


def test_every_part_includes_only_itself_and_parts_below():
    wrong = [f"{path} includes {header}" for part, path, header, quoted in includes()
             if quoted and header.split("/")[0] not in BELOW[part] | {part}]
    assert not wrong


def test_files_of_the_library_include_only_files_below():
    def height(path):
        return LIBIPC.index(os.path.splitext(os.path.basename(path))[0])
    wrong = [f"{path} includes {header}" for part, path, header, _ in includes()
             if part == "libipc" and header.startswith("libipc/")
             and height(header) > height(path)]
    assert not wrong


def test_folders_of_the_server_include_only_folders_below():
    def height(path):
        folder = path.split("/")[1]
        return CENTRAL.index(folder) if "/" in path[len("central/"):] else len(CENTRAL)
    wrong = [f"{path} includes {header}" for part, path, header, _ in includes()
             if part == "central" and header.startswith("central/")
             and height(header) > height(path)]
    assert not wrong


def test_no_files_of_the_server_include_each_other_in_a_circle():
    """A source and its header are one file here."""
    below = {}
    for part, path, header, _ in includes():
        file, other = os.path.splitext(path)[0], os.path.splitext(header)[0]
        if part == "central" and other != file:
            below.setdefault(file, set()).add(other)
    while below:
        lowest = {file for file in below if not below[file] & below.keys()}
        assert lowest, f"circles among {sorted(below)}"
        below = {file: others for file, others in below.items() if file not in lowest}


def test_project_headers_are_named_from_the_root_of_the_sources():
    wrong = [f"{path} includes {header}" for _, path, header, quoted in includes()
             if quoted and header not in ("ipc/ipc.h", "ipc/ipcx.h")
             and not os.path.exists(os.path.join(SOURCES, header))]
    assert not wrong


def test_only_the_platform_knows_the_operating_system():
    wrong = [f"{path} includes {header}" for part, path, header, quoted in includes()
             if not quoted and part != "platform" and SYSTEM.match(header)]
    assert not wrong


def test_sources_are_not_included():
    assert not [path for _, path, header, _ in includes() if header.endswith(".c")]
