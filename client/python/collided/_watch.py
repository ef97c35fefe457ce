"""Subscriptions to events of contacts, standing questions and probes."""

from __future__ import annotations

import asyncio
import ctypes
import time
from typing import Any, AsyncIterator, Generic, Iterator, TypeVar

from ._described import read
from ._events import Event, StandingEvent
from ._library import Owned, as_json, call, call_for_text, library, nanoseconds
from ._schema import ProbeReading
from ._structs import WATCH_CONTACTS, WATCH_PROBES, WATCH_STANDING

# Duration of a wait in C, short enough for Ctrl-C and for another thread to close the watch.
_SLICE_S = 0.1
News = TypeVar("News", Event, StandingEvent, ProbeReading)


class Subscription(Owned, Generic[News]):
    """A subscription: `for event in watch`, `async for event in watch`, or next(wait)."""

    _what = "the watch"
    _followed: int
    _kind: type[News]

    def __init__(self, client: ctypes.c_void_p, **options: Any) -> None:
        """options: those of collided_watch_start; None or empty selects the default"""
        given = {name: value for name, value in options.items() if value}
        handle = ctypes.c_void_p()
        call("watch_start", client, self._followed, as_json(given, "watch"), ctypes.byref(handle))
        super().__init__(handle, "watch_close")

    def next(self, wait: float | None = None) -> News | None:
        """The next event; None if none comes within `wait` seconds (None: waits without limit)."""
        until = None if wait is None else time.monotonic() + wait
        while True:
            left = _SLICE_S if until is None else min(_SLICE_S, max(0.0, until - time.monotonic()))
            event = call_for_text("watch_next", self._handle, nanoseconds(left, "wait"))
            if event is not None:
                return read(self._kind, event)
            if until is not None and time.monotonic() >= until:
                return None

    @property
    def lost(self) -> int:
        """Events dropped because they were not read in time."""
        lost = ctypes.c_uint64()
        library.collided_watch_health(self._handle, ctypes.byref(lost), None)
        return lost.value

    @property
    def in_step(self) -> bool:
        """True when the current state has been reported."""
        in_step = ctypes.c_int32()
        library.collided_watch_health(self._handle, None, ctypes.byref(in_step))
        return bool(in_step)

    def __iter__(self) -> Iterator[News]:
        while not self.closed:
            event = self.next()
            if event is not None:
                yield event

    async def __aiter__(self) -> AsyncIterator[News]:
        loop = asyncio.get_running_loop()
        while not self.closed:
            event = await loop.run_in_executor(None, self.next, _SLICE_S)
            if event is not None:
                yield event


class Watch(Subscription[Event]):
    """A subscription to contact events: `for event in watch`, `async for event in watch`, or next(wait)."""

    _followed, _kind = WATCH_CONTACTS, Event


class StandingWatch(Subscription[StandingEvent]):
    """A subscription to standing questions, used like a Watch."""

    _followed, _kind = WATCH_STANDING, StandingEvent


class ProbeWatch(Subscription[ProbeReading]):
    """A subscription to the readings of probes after every step, used like a Watch."""

    _followed, _kind = WATCH_PROBES, ProbeReading
