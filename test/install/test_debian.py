"""The files of the Debian packages that repeat what stands elsewhere."""
import os
import re

from install.tools import ROOT


def lines_of(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read().splitlines()


def test_the_package_of_the_library_lists_the_symbols_that_it_exports():
    exported = {line.split()[0] for line in lines_of("test/install/symbols.txt")
                if line and not line.startswith("#")}
    listed = [line.split("@")[0].strip() for line in lines_of("debian/libipc1.symbols")
              if line.startswith(" ")]
    assert listed == sorted(exported)


def test_packages_have_the_version_of_the_project():
    project = re.search(r"project\(ipc VERSION ([\d.]+)", "\n".join(lines_of("CMakeLists.txt")))
    assert lines_of("debian/changelog")[0].startswith(f"ipc ({project.group(1)})")
