"""Fixtures of the tests that look at the library as its users get it: built and installed."""
import os
import shutil

import pytest

from install.tools import BUILD, ROOT, Build, Installation, run


@pytest.fixture(scope="session")
def build():
    """The build under test: IPC_BUILD_DIR, by default build/dev."""
    if not os.path.exists(os.path.join(BUILD, "src/c/libipc/libipc.so.1")):
        pytest.skip(f"no libipc.so.1 in {BUILD}")
    return Build(BUILD)


@pytest.fixture(scope="session")
def installation(build, tmp_path_factory):
    """The build, installed under a prefix of its own."""
    prefix = tmp_path_factory.mktemp("prefix")
    run("cmake", "--install", build.directory, "--prefix", prefix)
    return Installation(str(prefix))


@pytest.fixture
def consumer(tmp_path):
    """A program that uses the library without a server: its source, in a folder of its own."""
    source = os.path.join(ROOT, "test/install/consumer.c")
    return shutil.copy(source, tmp_path)
