"""What the tests of the documents share with those of the installation."""
# pylint: disable=unused-import
from install.conftest import build, installation  # noqa: F401
