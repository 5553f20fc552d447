"""Listening, descriptors and timers [manual 4.29 to 4.36, 8]."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, Optional, Tuple

from ._ffi import ffi, lib
from .arguments import number_argument
from .constants import (IPC_Argument_Out_Of_Range, IPC_Error, IPC_Null_Argument, IPC_OK,
                        IPC_RETURN_TYPE, TRIGGER_FOREVER)
from .errors import fail, result, warn
from .handlers import Handler, Registration, Table, check_handler, handler_name
from .library import begin, listen

Timeout = Any  # milliseconds: int, float, or None for ever


def IPC_listen(timeoutMSecs: Timeout) -> IPC_RETURN_TYPE:
    """Waits for events and handles those that are there then."""
    return listen(lib.IPC_listen, number_argument(timeoutMSecs, "timeoutMSecs"))


def IPC_listenClear(timeoutMSecs: Timeout) -> IPC_RETURN_TYPE:
    """IPC_listen, and then handles everything that waits."""
    return listen(lib.IPC_listenClear, number_argument(timeoutMSecs, "timeoutMSecs"))


def IPC_listenWait(timeoutMSecs: Timeout) -> IPC_RETURN_TYPE:
    """Listens for that time, whatever comes."""
    return listen(lib.IPC_listenWait, number_argument(timeoutMSecs, "timeoutMSecs"))


def IPC_handleMessage(timeoutMSecs: Timeout) -> IPC_RETURN_TYPE:
    """IPC_listen, but handles one event only."""
    return listen(lib.IPC_handleMessage, number_argument(timeoutMSecs, "timeoutMSecs"))


def IPC_dispatch() -> IPC_RETURN_TYPE:
    """Listens until there is no connection any more."""
    return listen(lib.IPC_dispatch)


# ----------------------------------------------------------------- descriptors

class Descriptor(Registration):
    """The handler of a descriptor; keeps the object that the descriptor is of."""

    def __init__(self, source: Any, handler: Handler, clientData: Any) -> None:
        super().__init__(0)
        self.source, self.handler, self.client_data = source, handler, clientData

    def happened(self, *arguments: Any) -> None:
        self.handler(*arguments, self.client_data)


_descriptors: Dict[int, Descriptor] = {}


def _number_of(fd: Any) -> int:
    """The number of a descriptor; that of a closed object is -1."""
    try:
        return int(fd.fileno()) if hasattr(fd, "fileno") else int(fd.__index__())
    except AttributeError:
        raise TypeError(f"a descriptor is needed, not {type(fd).__name__}") from None
    except ValueError:
        return -1


def IPC_subscribeFD(fd: Any, fdHandler: Callable[[int, Any], Any],
                    clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has a handler called by listening calls whenever fd can be read."""
    number = _number_of(fd)
    if fdHandler is None:
        return fail(IPC_Null_Argument)
    check_handler(fdHandler)
    begin()
    descriptor = Descriptor(fd, fdHandler, clientData)
    outcome = IPC_Error
    try:
        outcome = listen(lib.glue_subscribe_fd, number, descriptor.number)
    finally:
        if outcome != IPC_OK:
            descriptor.end()
    if outcome == IPC_OK:
        replaced = _descriptors.get(number)
        _descriptors[number] = descriptor
        if replaced is not None:
            replaced.end()
    return outcome


def IPC_unsubscribeFD(fd: Any, handler: Optional[Handler]) -> IPC_RETURN_TYPE:
    """Ends what IPC_subscribeFD began, whichever handler is given."""
    numbers = [known for known, descriptor in _descriptors.items() if descriptor.source is fd]
    number = numbers[0] if numbers else _number_of(fd)
    descriptor = _descriptors.pop(number, None)
    if descriptor is not None:
        descriptor.end()
    return listen(lib.glue_unsubscribe_fd, number)


# ---------------------------------------------------------------------- timers

class TIMER_REF:
    """One timer."""

    __slots__ = ("timer",)

    def __init__(self, timer: Timer) -> None:
        self.timer = timer

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TIMER_REF) and self.timer is other.timer

    def __hash__(self) -> int:
        return hash(self.timer)

    def __repr__(self) -> str:
        return f"<IPC timer {self.timer.number}>"


class Timer(Registration):
    """The handler of a timer, and how often it is still to be called."""

    def __init__(self, handler: Handler, clientData: Any, count: int, by_reference: bool) -> None:
        super().__init__(0)
        self.handler, self.client_data = handler, clientData
        self.left = count
        self.by_reference = by_reference
        self.reference: Any = ffi.NULL

    @property
    def has_ended(self) -> bool:
        """Whether it was called for the last time, or removed."""
        return self not in _timers.of(None)

    def happened(self, *arguments: Any) -> None:
        if self.left != TRIGGER_FOREVER:
            self.left -= 1
            if self.left == 0:
                _timers.remove(None, self)
        self.handler(self.client_data, *arguments)


_timers: Table[Timer] = Table()


def _delay(tdelay: Any) -> int:
    return int(math.ceil(tdelay))


def _add_timer(tdelay: Any, count: int, handler: Any, clientData: Any,
               by_reference: bool) -> Tuple[Optional[Timer], IPC_RETURN_TYPE]:
    delay = _delay(tdelay)
    if handler is None:
        return None, fail(IPC_Null_Argument)
    check_handler(handler)
    if not 0 < delay < 1 << 62 or not (0 < count < 1 << 62 or count == TRIGGER_FOREVER):
        return None, fail(IPC_Argument_Out_Of_Range)
    begin()
    timer = Timer(handler, clientData, count, by_reference)
    _timers.add(None, timer)
    reference = ffi.new("TIMER_REF *")
    number = lib.glue_add_timer(delay, count, timer.number, reference)
    if number == IPC_Error:
        _timers.remove(None, timer)
        return None, result(number)
    timer.reference = reference[0]
    return timer, IPC_OK


def _remove(timer: Timer) -> IPC_RETURN_TYPE:
    _timers.remove(None, timer)
    return result(lib.IPC_removeTimerByRef(timer.reference))


def _same(handler: Handler, by_reference: bool) -> Optional[Timer]:
    """The newest timer of a handler of either kind."""
    for timer in reversed(_timers.of(None)):
        if timer.by_reference == by_reference and timer.handler == handler:
            return timer
    return None


def IPC_addTimer(tdelay: Any, count: int, handler: Callable[[Any, int, int], Any],
                 clientData: Any = None) -> IPC_RETURN_TYPE:
    """Has handler called every tdelay milliseconds, count times.  Replaces its timer."""
    replaced = _same(handler, False)
    timer, outcome = _add_timer(tdelay, count, handler, clientData, False)
    if timer is not None and replaced is not None:
        _remove(replaced)
    return outcome


def IPC_addOneShotTimer(tdelay: Any, handler: Callable[[Any, int, int], Any],
                        clientData: Any = None) -> IPC_RETURN_TYPE:
    """IPC_addTimer for one call."""
    return IPC_addTimer(tdelay, 1, handler, clientData)


def IPC_addPeriodicTimer(tdelay: Any, handler: Callable[[Any, int, int], Any],
                         clientData: Any = None) -> IPC_RETURN_TYPE:
    """IPC_addTimer for calls without end."""
    return IPC_addTimer(tdelay, TRIGGER_FOREVER, handler, clientData)


def IPC_addTimerGetRef(tdelay: Any, count: int, handler: Callable[[Any, int, int], Any],
                       clientData: Any = None) -> Tuple[Optional[TIMER_REF], IPC_RETURN_TYPE]:
    """A new timer, whatever timers its handler has: its reference, and the result."""
    timer, outcome = _add_timer(tdelay, count, handler, clientData, True)
    return (None if timer is None else TIMER_REF(timer)), outcome


def IPC_removeTimer(handler: Optional[Handler]) -> IPC_RETURN_TYPE:
    """Removes the timer of a handler."""
    if handler is None:
        return fail(IPC_Null_Argument)
    timer = _same(handler, False) or _same(handler, True)
    if timer is None:
        warn(f"Timer for handler ({handler_name(handler)}) does not exist")
        return IPC_OK
    return _remove(timer)


def IPC_removeTimerByRef(timerRef: Optional[TIMER_REF]) -> IPC_RETURN_TYPE:
    """Removes one timer."""
    if timerRef is None:
        return fail(IPC_Null_Argument)
    if not isinstance(timerRef, TIMER_REF):
        raise TypeError(f"the reference of a timer is needed, not {type(timerRef).__name__}")
    if timerRef.timer not in _timers.of(None):
        warn(f"Timer with ref {timerRef!r} does not exist")
        return IPC_OK
    return _remove(timerRef.timer)


__all__ = ["IPC_listen", "IPC_listenClear", "IPC_listenWait", "IPC_handleMessage", "IPC_dispatch",
           "IPC_subscribeFD", "IPC_unsubscribeFD", "TIMER_REF", "IPC_addTimer",
           "IPC_addOneShotTimer", "IPC_addPeriodicTimer", "IPC_addTimerGetRef", "IPC_removeTimer",
           "IPC_removeTimerByRef"]
