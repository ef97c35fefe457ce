"""What a recording tells; no server is needed."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from typing import Any, Callable, TypeVar, cast

from ._errors import BadInput
from ._events import FenceEvent, MarginEvent, NearestEvent, read_fence_event, read_margin_event, read_nearest_event
from ._library import call, encoded, library
from ._structs import (
    SINCE_1970,
    SINCE_BEGIN,
    SINCE_END,
    SINCE_NONE,
    CFenceEvent,
    CMarginEvent,
    CNearestEvent,
    CRecordedAbout,
    CRecordedOptions,
)

_SINCE = {"1970": SINCE_1970, "begin": SINCE_BEGIN, "end": SINCE_END}


@dataclass(frozen=True)
class RecordedFenceEvents:
    """The events of a recording's fences, margins and questions for the nearest."""

    fences: list[FenceEvent]
    margins: list[MarginEvent]
    nearest: list[NearestEvent]
    begin_ns: int  #: of the recording, since 1970
    end_ns: int
    lost: int  #: events of all three that are known to be missing
    warnings: list[str]  #: damage of the file, events that are lost, stays of unknown age


News = TypeVar("News", FenceEvent, MarginEvent, NearestEvent)


def _events(recorded: ctypes.c_void_p, count: int, kind: str, struct: type[Any], read: Callable[[Any], News]) -> list[News]:
    event = struct(size=ctypes.sizeof(struct))
    take = getattr(library, f"collided_recorded_{kind}_event")
    events = []
    for number in range(count):
        take(recorded, number, ctypes.byref(event))
        events.append(read(event))
    return events


def _since(word: str, time_ns: int | None) -> int:
    if word not in _SINCE:
        raise BadInput(f"since is {word!r}; known are {', '.join(_SINCE)}", "nothing was read")
    return SINCE_NONE if time_ns is None else _SINCE[word]


def recorded_fence_events(
    path: str | os.PathLike[str],
    *,
    only: str = "",
    skip: str = "",
    from_ns: int | None = None,
    to_ns: int | None = None,
    since: str = "1970",
) -> RecordedFenceEvents:
    """Reads what fences, margins and questions for the nearest told in a recording, as their watches had it.

    only, skip  globs, as those of the watches
    from_ns     what held then comes first, as "inside", "within" and "is"; None: from the recording's begin
    to_ns       included; None: to its end
    since       what both count from: "1970", or the recording's "begin" or "end" (then mostly negative)
    """
    options = CRecordedOptions(
        size=ctypes.sizeof(CRecordedOptions),
        from_since=_since(since, from_ns),
        to_since=_since(since, to_ns),
        from_ns=from_ns or 0,
        to_ns=to_ns or 0,
        only=encoded(only, "only"),
        skip=encoded(skip, "skip"),
    )
    recorded = ctypes.c_void_p()
    call("read_recorded_fences", encoded(os.fspath(path), "the path"), ctypes.byref(options), ctypes.byref(recorded))
    try:
        about = CRecordedAbout(size=ctypes.sizeof(CRecordedAbout))
        library.collided_about_recorded_fences(recorded, ctypes.byref(about))
        warnings = [cast(bytes, library.collided_recorded_warning(recorded, i)) for i in range(about.warnings)]
        return RecordedFenceEvents(
            _events(recorded, about.fences, "fence", CFenceEvent, read_fence_event),
            _events(recorded, about.margins, "margin", CMarginEvent, read_margin_event),
            _events(recorded, about.nearest, "nearest", CNearestEvent, read_nearest_event),
            about.begin_ns,
            about.end_ns,
            about.lost,
            [warning.decode("utf-8", "replace") for warning in warnings],
        )
    finally:
        library.collided_free_recorded_fences(recorded)
