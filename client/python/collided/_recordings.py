"""Functions that need no Client: recordings, diagnosis and the list of servers."""

from __future__ import annotations

import os
from typing import Any

from ._described import read
from ._errors import BadInput
from ._library import as_json, call_for_text, connect_options, encoded, nanoseconds
from ._schema import Finding, Fleet, RecordedEvents, RecordedStandingEvents, ReplayReport

_SINCE = ("1970", "begin", "end")


def _library(name: str, arguments: dict[str, Any]) -> dict[str, Any]:
    answer: dict[str, Any] = call_for_text("library", encoded(name, "the function"), as_json(arguments, name))
    return answer


def _stretch(from_ns: int | None, to_ns: int | None, since: str) -> dict[str, Any]:
    if since not in _SINCE:
        raise BadInput(f"since is {since!r}; known are {', '.join(_SINCE)}", "nothing was read")
    ends = (("from", from_ns), ("to", to_ns))
    return {name: {"since": since, "offset_ns": offset} for name, offset in ends if offset is not None}


def _recorded(
    name: str, path: str | os.PathLike[str], only: str, skip: str, stretch: dict[str, Any]
) -> dict[str, Any]:
    return _library(name, {"path": os.fspath(path), "only": only, "skip": skip, **stretch})


def recorded_events(
    path: str | os.PathLike[str],
    *,
    only: str = "",
    skip: str = "",
    from_ns: int | None = None,
    to_ns: int | None = None,
    since: str = "1970",
) -> RecordedEvents:
    """Reads the contact events of a recording, in the order in which they happened.

    only, skip  globs, as for Client.watch
    from_ns     contacts that held at this time come first, as "open"; None: the recording's begin
    to_ns       inclusive; None: its end
    since       the origin of both times: "1970", or the recording's "begin" or "end" (then mostly negative)
    """
    return read(RecordedEvents, _recorded("recorded_events", path, only, skip, _stretch(from_ns, to_ns, since)))


def recorded_standing_events(
    path: str | os.PathLike[str],
    *,
    only: str = "",
    skip: str = "",
    from_ns: int | None = None,
    to_ns: int | None = None,
    since: str = "1970",
) -> RecordedStandingEvents:
    """Reads the events of standing questions in a recording, in the order of their numbers.

    only, skip  globs, as for Client.watch_standing
    from_ns     the state at this time comes first, as "inside", "within" and "is"; None: the recording's begin
    to_ns       inclusive; None: its end
    since       the origin of both times: "1970", or the recording's "begin" or "end" (then mostly negative)
    """
    return read(RecordedStandingEvents, _recorded("recorded_standing", path, only, skip, _stretch(from_ns, to_ns, since)))


def fetch_recording(path: str | os.PathLike[str], last: float, **connect: Any) -> int:
    """Writes the last seconds that the server's flight recorder holds to a file, as a recording, and returns its size in bytes.
    last: seconds; 0: only what publishers and commands have brought into the world. connect: the arguments of connect()."""
    wanted = {"path": os.fspath(path), "last_ns": nanoseconds(last, "last")}
    return int(_library("fetch_recording", {**connect_options(**connect), **wanted})["bytes"])


def replay(
    path: str | os.PathLike[str],
    *,
    rate: float = 1.0,
    ask: bool = False,
    from_ns: int | None = None,
    to_ns: int | None = None,
    since: str = "1970",
    **connect: Any,
) -> ReplayReport:
    """Publishes a recording's objects and poses again, and returns when that has ended.

    rate            2 is twice as fast as recorded; above 0 up to 1e6
    ask             asks the recorded questions again and compares the answers; the rate does not matter
    from_ns, to_ns  as for recorded_events(); what came before is published at once
    connect         the arguments of connect()
    """
    how = {"path": os.fspath(path), "rate": rate, "ask": bool(ask), **_stretch(from_ns, to_ns, since)}
    return read(ReplayReport, _library("replay", {**connect_options(**connect), **how}))


def diagnose(**connect: Any) -> tuple[Finding, ...]:
    """Checks what usually keeps programs from finding or hearing each other. Takes about a second, and as long as connect()
    waits where no server answers. connect: the arguments of connect()."""
    return tuple(read(Finding, row) for row in _library("diagnose", connect_options(**connect))["findings"])


def fleet(**connect: Any) -> Fleet:
    """Listens for 1.5 s for the servers of a namespace, and says what does not fit together. connect: the arguments of
    connect(). NoServer if there is none."""
    return read(Fleet, _library("fleet", connect_options(**connect)))
