"""Standing questions: which objects are in a region, which pairs are near each other, and what is nearest."""

from __future__ import annotations

import ctypes
import time
from typing import Any, Iterator, Sequence

from ._commands import Commanding
from ._contract import STANDING_FORM, DETECT_CROSS, DETECT_ENTER, DETECT_EXIT
from ._described import read
from ._errors import BadInput
from ._events import StandingEvent, read_standing_event
from ._library import Owned, call, code_of, encoded, library, nanoseconds
from ._schema import ListedStanding
from ._shapes import Shape, encode_parts
from ._structs import FORM_ANY, NOTHING, CPart, CStanding, CStandingEvent
from ._watch import SLICE_S

_DETECT = {"enter": DETECT_ENTER, "exit": DETECT_EXIT, "cross": DETECT_CROSS}
_ALL_LAYERS = 0xFFFFFFFF


def _form(form: str | None) -> int:
    return FORM_ANY if form is None else code_of(form, STANDING_FORM, "form")


class StandingWatch(Owned):
    """A subscription to standing questions: `for event in watch`, or next(wait)."""

    _what = "the watch of standing questions"

    def __init__(self, client: ctypes.c_void_p, only: str, skip: str, form: str | None) -> None:
        handle = ctypes.c_void_p()
        call("standing_watch_start", client, encoded(only, "only"), encoded(skip, "skip"), _form(form), ctypes.byref(handle))
        super().__init__(handle, "standing_watch_close")

    def next(self, wait: float | None = None) -> StandingEvent | None:
        """The next event; None if none comes within `wait` seconds (None: however long it takes)."""
        until = None if wait is None else time.monotonic() + wait
        event = CStandingEvent(size=ctypes.sizeof(CStandingEvent))
        while True:
            left = SLICE_S if until is None else min(SLICE_S, max(0.0, until - time.monotonic()))
            if call("standing_watch_next", self._handle, nanoseconds(left, "wait"), ctypes.byref(event)) != NOTHING:
                return read_standing_event(event)
            if until is not None and time.monotonic() >= until:
                return None

    @property
    def lost(self) -> int:
        """Events dropped because they were not taken in time."""
        return int(library.collided_standing_watch_lost(self._handle))

    @property
    def in_step(self) -> bool:
        """True when all that holds has been reported."""
        return bool(library.collided_standing_watch_in_step(self._handle))

    def __iter__(self) -> Iterator[StandingEvent]:
        while not self.closed:
            event = self.next()
            if event is not None:
                yield event

    def __enter__(self) -> StandingWatch:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Standing(Commanding):
    """The calls of a Client for standing questions."""

    def _add_standing(self, form: str, name: str, only: str, skip: str, mask: int, keep: bool, **members: Any) -> int:
        if not 0 <= mask <= _ALL_LAYERS:
            raise BadInput(f"mask is {mask}; allowed are 0 to 4294967295", "nothing was sent")
        standing = CStanding(
            size=ctypes.sizeof(CStanding),
            form=_form(form),
            name=encoded(name, "the name"),
            only=encoded(only, "only"),
            skip=encoded(skip, "skip"),
            left_out_layers=mask ^ _ALL_LAYERS,
            keep=int(keep),
            **members,
        )
        parts = ctypes.c_uint64()
        call("standing_add", self._handle, ctypes.byref(standing), ctypes.byref(parts))
        return parts.value

    def add_region(
        self,
        name: str,
        shape: Shape | Sequence[Shape],
        *,
        to: str = "",
        only: str = "",
        skip: str = "",
        mask: int = _ALL_LAYERS,
        detect: Sequence[str] = ("enter", "exit", "cross"),
        keep: bool = False,
    ) -> None:
        """Adds a question: which moving objects are in a region.

        shape   solid, in the world, or in the frame of the object `to`, with which it then moves
        only    empty: all objects that move
        detect  what it reports; without "cross" a passage between two poses is an "enter" and an "exit"
        """
        unknown = [text for text in detect if text not in _DETECT]
        if unknown or not detect:
            raise BadInput(f"detect is {list(detect)!r}; known are {', '.join(_DETECT)}", "nothing was sent")
        kept: list[Any] = []
        parts = encode_parts(shape, kept)
        region = {
            "parts": ctypes.cast(parts, ctypes.POINTER(CPart)),
            "part_count": len(parts),
            "to": encoded(to, "to"),
            "detect": sum(_DETECT[text] for text in set(detect)),
        }
        self._add_standing("region", name, only, skip, mask, keep, **region)

    def add_bands(
        self,
        name: str,
        around: str,
        only: str,
        bands: Sequence[float],
        *,
        hysteresis: float = 0.0,
        dwell: float = 0.0,
        skip: str = "",
        mask: int = _ALL_LAYERS,
        keep: bool = False,
    ) -> int:
        """Adds a question: which objects of the glob `only` are within bands of distance of those of the glob `around`.

        bands       metres, the widest first; contact is always one
        hysteresis  metres: a pair within a band leaves it beyond the band plus this
        dwell       seconds: a change is reported once it has lasted so long; contact at once
        returns     how many parts of loaded scenes one of the globs matches; they have no bands
        """
        numbers = (ctypes.c_double * len(bands))(*bands)
        members = {
            "around": encoded(around, "around"),
            "bands_m": ctypes.addressof(numbers),
            "band_count": len(bands),
            "hysteresis_m": hysteresis,
            "dwell_ns": nanoseconds(dwell, "dwell"),
        }
        return self._add_standing("bands", name, only, skip, mask, keep, **members)

    def add_nearest(
        self,
        name: str,
        only: str,
        to: str | Sequence[float],
        within: float,
        *,
        hysteresis: float = 0.0,
        skip: str = "",
        mask: int = _ALL_LAYERS,
        keep: bool = False,
    ) -> None:
        """Adds a question: which object of the glob `only` is nearest.

        to          the name of an object, or a point (x, y, z)
        within      metres: objects farther away do not count
        hysteresis  metres: another one must be nearer by more than this
        """
        members: dict[str, Any] = {"within_m": within, "hysteresis_m": hysteresis}
        if isinstance(to, str):
            if not to:
                raise BadInput("to is empty; the name of an object or a point is needed", "nothing was sent")
            members["to"] = encoded(to, "to")
        else:
            x, y, z = to
            members["point"] = (float(x), float(y), float(z))
        self._add_standing("nearest", name, only, skip, mask, keep, **members)

    def remove_standing(self, name: str, form: str | None = None) -> int:
        """Removes standing questions by name or glob, and returns how many there were.

        form  "region", "bands" or "nearest": of this form alone
        """
        removed = ctypes.c_uint64()
        call("standing_remove", self._handle, encoded(name, "the name"), _form(form), ctypes.byref(removed))
        return removed.value

    def standing(self, name: str = "", form: str | None = None) -> list[ListedStanding]:
        """The standing questions whose names match the glob, and what each `holds`."""
        arguments: dict[str, Any] = {} if form is None else {"form": STANDING_FORM[_form(form)]}
        return [read(ListedStanding, row) for row in self.command("fences", name=name, **arguments)["standing"]]

    def watch_standing(self, only: str = "", skip: str = "", form: str | None = None) -> StandingWatch:
        """Subscribes to standing questions. What holds already comes first, as "inside", "within" and "is".

        only  name glob that the question or one of the two objects must match; empty: everything
        skip  name glob that none of them may match
        """
        return StandingWatch(self._handle, only, skip, form)
