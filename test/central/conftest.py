"""What the tests of how central is operated share."""
import pytest

from support.peer import Peer


@pytest.fixture
def connect(stack):
    """Connects a hand-made module to a central."""
    return lambda central, name="PEER", **options: stack.enter_context(
        Peer(central, name, **options)).connect()
