"""How long a test waits: every wait is bounded, and one factor stretches them all."""
import os
import time

#: Stretches every time-out, for sanitizer builds, valgrind and busy machines.
SLOW = float(os.environ.get("IPC_TEST_SLOW", "1"))

#: Seconds after which something that should happen is taken not to happen.
PATIENCE = 5 * SLOW


class TimedOut(AssertionError):
    """Something that a test waited for did not happen in time."""


class Deadline:
    """A point in time up to which several waits may go on together."""

    def __init__(self, seconds=None):
        self._end = time.monotonic() + (PATIENCE if seconds is None else seconds)

    def left(self):
        """Seconds that are left, never negative."""
        return max(0.0, self._end - time.monotonic())

    def passed(self):
        return time.monotonic() >= self._end


def wait_until(condition, what, seconds=None):
    """Returns the first true value of condition(); raises TimedOut when there is none in time."""
    deadline = Deadline(seconds)
    while True:
        value = condition()
        if value:
            return value
        if deadline.passed():
            raise TimedOut(f"waited in vain until {what}")
        time.sleep(0.002)
