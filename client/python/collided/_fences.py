"""Fences, margins and the nearest: who comes into a region, who comes near whom, and who is nearest."""

from __future__ import annotations

import ctypes
import time
from typing import Any, Callable, Generic, Iterator, Sequence, TypeVar, cast

from ._contract import TELLS_CROSS, TELLS_ENTER, TELLS_EXIT
from ._errors import BadInput
from ._events import FenceEvent, MarginEvent, NearestEvent, read_fence_event, read_margin_event, read_nearest_event
from ._library import Owned, call, encoded, library, nanoseconds
from ._shapes import Shape, encode_parts
from ._structs import NOTHING, CFence, CFenceEvent, CMargin, CMarginEvent, CNearest, CNearestEvent, CPart
from ._watch import SLICE_S

_TELLS = {"enter": TELLS_ENTER, "exit": TELLS_EXIT, "cross": TELLS_CROSS}
_ALL_LAYERS = 0xFFFFFFFF


def _left_out(mask: int) -> int:
    if not 0 <= mask <= _ALL_LAYERS:
        raise BadInput(f"mask is {mask}; allowed are 0 to 4294967295", "nothing was sent")
    return mask ^ _ALL_LAYERS


def add_fence(
    client: ctypes.c_void_p,
    name: str,
    shape: Shape | Sequence[Shape],
    to: str,
    only: str,
    skip: str,
    mask: int,
    tells: Sequence[str],
    keep: bool,
) -> None:
    """Client.add_fence."""
    unknown = [text for text in tells if text not in _TELLS]
    if unknown or not tells:
        raise BadInput(f"tells is {list(tells)!r}; known are {', '.join(_TELLS)}", "nothing was sent")
    kept: list[Any] = []
    parts = encode_parts(shape, kept)
    fence = CFence(
        size=ctypes.sizeof(CFence),
        left_out_layers=_left_out(mask),
        name=encoded(name, "the name"),
        parts=ctypes.cast(parts, ctypes.POINTER(CPart)),
        part_count=len(parts),
        to=encoded(to, "to"),
        only=encoded(only, "only"),
        skip=encoded(skip, "skip"),
        keep=int(keep),
        tells=sum(_TELLS[text] for text in set(tells)),
    )
    call("fence_add", client, ctypes.byref(fence))


def add_margin(
    client: ctypes.c_void_p,
    name: str,
    around: str,
    only: str,
    bands: Sequence[float],
    hysteresis: float,
    dwell: float,
    skip: str,
    mask: int,
    keep: bool,
) -> None:
    """Client.add_margin."""
    numbers = (ctypes.c_double * len(bands))(*bands)
    margin = CMargin(
        size=ctypes.sizeof(CMargin),
        left_out_layers=_left_out(mask),
        name=encoded(name, "the name"),
        around=encoded(around, "around"),
        only=encoded(only, "only"),
        skip=encoded(skip, "skip"),
        bands_m=ctypes.addressof(numbers),
        band_count=len(bands),
        hysteresis_m=hysteresis,
        dwell_ns=nanoseconds(dwell, "dwell"),
        keep=int(keep),
    )
    call("margin_add", client, ctypes.byref(margin))


def add_nearest(
    client: ctypes.c_void_p,
    name: str,
    only: str,
    to: str | Sequence[float],
    within: float,
    hysteresis: float,
    skip: str,
    mask: int,
    keep: bool,
) -> None:
    """Client.add_nearest."""
    nearest = CNearest(
        size=ctypes.sizeof(CNearest),
        left_out_layers=_left_out(mask),
        name=encoded(name, "the name"),
        only=encoded(only, "only"),
        skip=encoded(skip, "skip"),
        within_m=within,
        hysteresis_m=hysteresis,
        keep=int(keep),
    )
    if isinstance(to, str):
        if not to:
            raise BadInput("to is empty; the name of an object or a point is needed", "nothing was sent")
        nearest.to = encoded(to, "to")
    else:
        x, y, z = to
        nearest.point[:] = [float(x), float(y), float(z)]
    call("nearest_add", client, ctypes.byref(nearest))


def remove(client: ctypes.c_void_p, kind: str, name: str) -> int:
    """Client.remove_fences, remove_margins and remove_nearest; kind: fence, margin or nearest."""
    removed = ctypes.c_uint64()
    call(kind + "_remove", client, encoded(name, "the name"), ctypes.byref(removed))
    return removed.value


News = TypeVar("News", FenceEvent, MarginEvent, NearestEvent)


class _Follower(Owned, Generic[News]):
    """What the watches of fences, margins and the nearest have in common."""

    _kind = ""
    _event: type[Any]  # the struct, and how it is read
    _read: Callable[[Any], Any]

    def __init__(self, client: ctypes.c_void_p, only: str, skip: str) -> None:
        handle = ctypes.c_void_p()
        call(self._kind + "_watch_start", client, encoded(only, "only"), encoded(skip, "skip"), ctypes.byref(handle))
        super().__init__(handle, self._kind + "_watch_close")

    def _told(self, wait_ns: int) -> News | None:
        event = self._event(size=ctypes.sizeof(self._event))
        code = call(self._kind + "_watch_next", self._handle, wait_ns, ctypes.byref(event))
        return None if code == NOTHING else cast(News, type(self)._read(event))

    def next(self, wait: float | None = None) -> News | None:
        """The next event; None where none comes within `wait` seconds (None: however long it takes)."""
        until = None if wait is None else time.monotonic() + wait
        while True:
            left = SLICE_S if until is None else min(SLICE_S, max(0.0, until - time.monotonic()))
            event = self._told(nanoseconds(left, "wait"))
            if event is not None or (until is not None and time.monotonic() >= until):
                return event

    @property
    def lost(self) -> int:
        """Events dropped since they were not taken in time."""
        return int(getattr(library, f"collided_{self._kind}_watch_lost")(self._handle))

    @property
    def in_step(self) -> bool:
        """True when all that holds has been reported."""
        return bool(getattr(library, f"collided_{self._kind}_watch_in_step")(self._handle))

    def __iter__(self) -> Iterator[News]:
        while not self.closed:
            event = self.next()
            if event is not None:
                yield event

    def __enter__(self: Follower) -> Follower:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


Follower = TypeVar("Follower", bound=_Follower[Any])


class FenceWatch(_Follower[FenceEvent]):
    """A subscription to fences: `for event in watch`, or next(wait)."""

    _what = "the watch of fences"
    _kind = "fence"
    _event = CFenceEvent
    _read = staticmethod(read_fence_event)


class MarginWatch(_Follower[MarginEvent]):
    """A subscription to margins: `for event in watch`, or next(wait)."""

    _what = "the watch of margins"
    _kind = "margin"
    _event = CMarginEvent
    _read = staticmethod(read_margin_event)


class NearestWatch(_Follower[NearestEvent]):
    """A subscription to changes of what is nearest: `for event in watch`, or next(wait)."""

    _what = "the watch of the nearest"
    _kind = "nearest"
    _event = CNearestEvent
    _read = staticmethod(read_nearest_event)
