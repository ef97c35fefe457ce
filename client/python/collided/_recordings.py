"""The events that a recording holds; no server is needed."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from typing import cast

from ._errors import BadInput
from ._events import StandingEvent, read_standing_event
from ._library import call, encoded, library
from ._structs import SINCE_1970, SINCE_BEGIN, SINCE_END, SINCE_NONE, CRecordedAbout, CRecordedOptions, CStandingEvent

_SINCE = {"1970": SINCE_1970, "begin": SINCE_BEGIN, "end": SINCE_END}


@dataclass(frozen=True)
class RecordedStandingEvents:
    """The events of a recording's standing questions."""

    events: list[StandingEvent]
    begin_ns: int  #: of the recording, since 1970
    end_ns: int
    lost: int  #: events that are known to be missing
    warnings: list[str]  #: damage of the file, events that are lost, stays of unknown age


def _events(recorded: ctypes.c_void_p, count: int) -> list[StandingEvent]:
    event = CStandingEvent(size=ctypes.sizeof(CStandingEvent))
    events = []
    for number in range(count):
        library.collided_recorded_standing_event(recorded, number, ctypes.byref(event))
        events.append(read_standing_event(event))
    return events


def _since(word: str, time_ns: int | None) -> int:
    if word not in _SINCE:
        raise BadInput(f"since is {word!r}; known are {', '.join(_SINCE)}", "nothing was read")
    return SINCE_NONE if time_ns is None else _SINCE[word]


def recorded_standing_events(
    path: str | os.PathLike[str],
    *,
    only: str = "",
    skip: str = "",
    from_ns: int | None = None,
    to_ns: int | None = None,
    since: str = "1970",
) -> RecordedStandingEvents:
    """Reads what standing questions reported in a recording, as a watch reported it, in the order of the events' numbers.

    only, skip  globs, as those of Client.watch_standing
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
    call("read_recorded_standing", encoded(os.fspath(path), "the path"), ctypes.byref(options), ctypes.byref(recorded))
    try:
        about = CRecordedAbout(size=ctypes.sizeof(CRecordedAbout))
        library.collided_about_recorded_standing(recorded, ctypes.byref(about))
        warnings = [cast(bytes, library.collided_recorded_warning(recorded, i)) for i in range(about.warnings)]
        return RecordedStandingEvents(
            _events(recorded, about.events),
            about.begin_ns,
            about.end_ns,
            about.lost,
            [warning.decode("utf-8", "replace") for warning in warnings],
        )
    finally:
        library.collided_free_recorded_standing(recorded)
