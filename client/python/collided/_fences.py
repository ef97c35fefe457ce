"""Fences, margins and the nearest: who comes into a region, who comes near whom, and who is nearest."""

from __future__ import annotations

import ctypes
import time
from dataclasses import dataclass
from typing import Any, Callable, Generic, Iterator, Sequence, TypeVar, cast

from ._contract import (
    DOUBT,
    END_REASON,
    FENCE_EVENT_KIND,
    MARGIN_EVENT_KIND,
    NEAREST_EVENT_KIND,
    TELLS_CROSS,
    TELLS_ENTER,
    TELLS_EXIT,
)
from ._errors import BadInput
from ._library import NOTHING, Owned, call, encoded, library, nanoseconds, word
from ._shapes import Shape, encode_parts
from ._structs import CFence, CFenceEvent, CMargin, CMarginEvent, CNearest, CNearestEvent, CPart
from ._watch import SLICE_S

_TELLS = {"enter": TELLS_ENTER, "exit": TELLS_EXIT, "cross": TELLS_CROSS}
_ALL_LAYERS = 0xFFFFFFFF


@dataclass(frozen=True)
class FenceEvent:
    """News of an object and a fence."""

    kind: str  #: inside (was in when the watch began), enter, exit, cross (in and out between two poses)
    reason: str  #: of an exit, such as "separated"; else empty
    doubt: str  #: not empty: it is not known whether the object is in, which is told as if it were
    resync: bool  #: inferred from the state after a gap
    object: str
    fence: str
    epoch: int
    sequence: int
    episode: int  #: the sequence of the coming in
    world_time_ns: int  #: of the step that found it, since 1970, by the publishers' clocks
    entered_ns: int
    bracket: tuple[float, float]  #: the change happened between these, in seconds before world_time_ns
    left: tuple[float, float]  #: of cross: the same of the going out
    point: tuple[float, float, float]
    poses_merged: bool = False  #: the server replaced poses by newer ones, as of contacts


@dataclass(frozen=True)
class MarginEvent:
    """News of two objects and a band of distance between them. Metres, seconds."""

    kind: str  #: within (was so when the watch began), approach, near, contact, leave
    reason: str  #: of a leave, such as "separated"; else empty
    doubt: str  #: not empty: it is not known whether the two are in the band, which is told as if they were
    resync: bool  #: inferred from the state after a gap
    margin: str
    object: str
    around: str  #: the object that has the bands
    band: float  #: 0: contact
    epoch: int
    sequence: int
    episode: int  #: the sequence of the coming into the band
    world_time_ns: int  #: of the step that told it, since 1970, by the publishers' clocks
    entered_ns: int
    bracket: tuple[float, float]  #: the change happened between these, in seconds before world_time_ns
    distance: float  #: of approach, near and contact, at the end of the bracket; so are the next
    distance_error: float
    point: tuple[float, float, float]  #: of the object, nearest to the other
    normal: tuple[float, float, float]  #: unit, from there to the other
    closing: float  #: how fast the distance shrinks, m/s
    closing_error: float
    contact_in: tuple[float, float] | None  #: when the two would touch if both went on so; None: not within a minute
    poses_merged: bool = False  #: the server replaced poses by newer ones, as of contacts


@dataclass(frozen=True)
class NearestEvent:
    """News of a question for the nearest. Metres, seconds."""

    kind: str  #: is (was nearest when the watch began), changed
    reason: str  #: why from_object is not nearest any more: "separated" where another is nearer or it is too far away
    doubt: str  #: not empty: one of the two is where a lost publisher said last, and there is no distance
    resync: bool  #: inferred from the state after a gap
    nearest: str  #: name of the question
    from_object: str  #: that was nearest; empty: none, or that is not known
    to: str  #: that is nearest; empty: nothing is near enough
    epoch: int
    sequence: int
    world_time_ns: int  #: of the step that told it, since 1970, by the publishers' clocks
    bracket: tuple[float, float]  #: the change happened between these, in seconds before world_time_ns
    distance: float  #: of `to` at the end of the bracket; 0: they touch
    distance_error: float
    point: tuple[float, float, float]  #: of `to`; zero where they touch
    normal: tuple[float, float, float]  #: unit, from there to what it is nearest to; zero where they touch
    poses_merged: bool = False  #: the server replaced poses by newer ones, as of contacts


def _triple(values: Any) -> tuple[float, float, float]:
    return values[0], values[1], values[2]


def _text(value: bytes) -> str:
    return value.decode("utf-8", "surrogateescape")


def _fence_event(told: CFenceEvent) -> FenceEvent:
    return FenceEvent(
        word(FENCE_EVENT_KIND, told.kind),
        word(END_REASON, told.reason),
        word(DOUBT, told.doubt),
        bool(told.resync),
        _text(told.object),
        _text(told.fence),
        told.epoch,
        told.sequence,
        told.episode,
        told.world_time_ns,
        told.entered_ns,
        (told.bracket_low_s, told.bracket_high_s),
        (told.left_low_s, told.left_high_s),
        _triple(told.point),
        bool(told.poses_merged),
    )


def _margin_event(told: CMarginEvent) -> MarginEvent:
    return MarginEvent(
        word(MARGIN_EVENT_KIND, told.kind),
        word(END_REASON, told.reason),
        word(DOUBT, told.doubt),
        bool(told.resync),
        _text(told.margin),
        _text(told.object),
        _text(told.around),
        told.band_m,
        told.epoch,
        told.sequence,
        told.episode,
        told.world_time_ns,
        told.entered_ns,
        (told.bracket_low_s, told.bracket_high_s),
        told.distance_m,
        told.distance_error_m,
        _triple(told.point),
        _triple(told.normal),
        told.closing_mps,
        told.closing_error_mps,
        (told.contact_in_low_s, told.contact_in_high_s) if told.has_contact_in else None,
        bool(told.poses_merged),
    )


def _nearest_event(told: CNearestEvent) -> NearestEvent:
    return NearestEvent(
        word(NEAREST_EVENT_KIND, told.kind),
        word(END_REASON, told.reason),
        word(DOUBT, told.doubt),
        bool(told.resync),
        _text(told.nearest),
        _text(told.from_object),
        _text(told.to),
        told.epoch,
        told.sequence,
        told.world_time_ns,
        (told.bracket_low_s, told.bracket_high_s),
        told.distance_m,
        told.distance_error_m,
        _triple(told.point),
        _triple(told.normal),
        bool(told.poses_merged),
    )


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
        bands_m=numbers,
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
    _read = staticmethod(_fence_event)


class MarginWatch(_Follower[MarginEvent]):
    """A subscription to margins: `for event in watch`, or next(wait)."""

    _what = "the watch of margins"
    _kind = "margin"
    _event = CMarginEvent
    _read = staticmethod(_margin_event)


class NearestWatch(_Follower[NearestEvent]):
    """A subscription to changes of what is nearest: `for event in watch`, or next(wait)."""

    _what = "the watch of the nearest"
    _kind = "nearest"
    _event = CNearestEvent
    _read = staticmethod(_nearest_event)
