"""Contact events."""

from __future__ import annotations

import asyncio
import ctypes
import time
from dataclasses import dataclass
from typing import AsyncIterator, Iterator

from ._contract import CONTACT_EVENT_KIND, CONTAINMENT, DOUBT, END_REASON
from ._library import NOTHING, Owned, call, library, nanoseconds, word
from ._structs import CEvent

# How long a wait in C lasts, so that Ctrl-C is seen and another thread may close the watch.
SLICE_S = 0.1


@dataclass(frozen=True)
class Event:
    """News of a contact between two objects. Metres, world coordinates."""

    kind: str  #: open (held when the watch began), began, persisted, ended; contained, emerged: of a solid
    reason: str  #: why it ended, such as "separated"; else empty
    doubt: str  #: not empty: it is not known whether the two touch, and there is no point, normal or depth
    resync: bool  #: inferred from the contact state after a gap
    a: str
    b: str
    epoch: int
    sequence: int
    episode: int  #: the sequence of the pair's `began`
    world_time_ns: int  #: of the step that found it, since 1970, by the publishers' clocks
    began_ns: int
    bracket: tuple[float, float]  #: the change happened between these, in seconds before world_time_ns
    point: tuple[float, float, float]
    normal: tuple[float, float, float]  #: unit, from a to b
    depth: float
    depth_error: float
    relative_velocity: tuple[float, float, float]
    velocity_error: float
    contained: str  #: "a_in_b" or "b_in_a" where one lies wholly within the other, a declared solid; else empty
    #: Normal and depth with neighbouring bodies counted as one surface, as at the inner edges of a tiled floor; elsewhere equal
    #: to those above.
    surface_normal: tuple[float, float, float] = (0.0, 0.0, 0.0)
    surface_depth: float = 0.0
    surface_depth_error: float = 0.0
    poses_merged: bool = False  #: the server replaced poses of one of the two by newer ones; the event is of that way


def _event(told: CEvent) -> Event:
    def triple(values: ctypes.Array[ctypes.c_double]) -> tuple[float, float, float]:
        return values[0], values[1], values[2]

    return Event(
        word(CONTACT_EVENT_KIND, told.kind),
        word(END_REASON, told.reason),
        word(DOUBT, told.doubt),
        bool(told.resync),
        told.a.decode("utf-8", "surrogateescape"),
        told.b.decode("utf-8", "surrogateescape"),
        told.epoch,
        told.sequence,
        told.episode,
        told.world_time_ns,
        told.began_ns,
        (told.bracket_low_s, told.bracket_high_s),
        triple(told.point),
        triple(told.normal),
        told.depth_m,
        told.depth_error_m,
        triple(told.relative_velocity),
        told.velocity_error,
        word(CONTAINMENT, told.contained),
        triple(told.surface_normal),
        told.surface_depth_m,
        told.surface_depth_error_m,
        bool(told.poses_merged),
    )


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
                return _event(event)
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
