"""Contact events."""

from __future__ import annotations

import asyncio
import ctypes
import time
from typing import AsyncIterator, Iterator

from ._events import Event, read_event
from ._library import Owned, call, library, nanoseconds
from ._structs import NOTHING, CEvent

# How long a wait in C lasts, so that Ctrl-C is seen and another thread may close the watch.
SLICE_S = 0.1


class Watch(Owned):
    """A subscription to contact events: `for event in watch`, `async for event in watch`, or next(wait)."""

    _what = "the watch"

    def __init__(self, handle: ctypes.c_void_p) -> None:
        super().__init__(handle, "watch_close")

    def next(self, wait: float | None = None) -> Event | None:
        """The next event; None where none comes within `wait` seconds (None: however long it takes)."""
        until = None if wait is None else time.monotonic() + wait
        event = CEvent(size=ctypes.sizeof(CEvent))
        while True:
            left = SLICE_S if until is None else min(SLICE_S, max(0.0, until - time.monotonic()))
            if call("watch_next", self._handle, nanoseconds(left, "wait"), ctypes.byref(event)) != NOTHING:
                return read_event(event)
            if until is not None and time.monotonic() >= until:
                return None

    @property
    def lost(self) -> int:
        """Events dropped since they were not taken in time."""
        return int(library.collided_watch_lost(self._handle))

    @property
    def in_step(self) -> bool:
        """True when every contact that holds has been reported."""
        return bool(library.collided_watch_in_step(self._handle))

    def __iter__(self) -> Iterator[Event]:
        while not self.closed:
            event = self.next()
            if event is not None:
                yield event

    async def __aiter__(self) -> AsyncIterator[Event]:
        loop = asyncio.get_running_loop()
        while not self.closed:
            event = await loop.run_in_executor(None, self.next, SLICE_S)
            if event is not None:
                yield event

    def __enter__(self) -> Watch:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
