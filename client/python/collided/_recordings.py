"""The events that a recording holds; no server is needed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

from ._described import read
from ._errors import BadInput
from ._events import StandingEvent
from ._library import as_json, call_for_text, encoded

_SINCE = ("1970", "begin", "end")


@dataclass(frozen=True)
class RecordedStandingEvents:
    """The events of a recording's standing questions."""

    events: list[StandingEvent]
    begin_ns: int  #: of the recording, since 1970
    end_ns: int
    lost: int  #: events that are known to be missing
    warnings: list[str]  #: damage of the file, events that are lost, stays of unknown age


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
    if since not in _SINCE:
        raise BadInput(f"since is {since!r}; known are {', '.join(_SINCE)}", "nothing was read")
    options: dict[str, Any] = {"only": only, "skip": skip}
    for name, offset in (("from", from_ns), ("to", to_ns)):
        if offset is not None:
            options[name] = {"since": since, "offset_ns": offset}
    words = encoded(os.fspath(path), "the path"), as_json(options, "recorded events")
    return read(RecordedStandingEvents, call_for_text("recorded_standing", *words))
