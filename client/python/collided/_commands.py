"""Commands as JSON, the basis of several functions of Client."""

from __future__ import annotations

from typing import Any

from ._errors import BadInput
from ._library import Owned, as_json, call_for_text, encoded, nanoseconds
from ._shapes import Parts

_DAY_NS = 86_400 * 10**9


class Commanding(Owned):
    """An object that sends commands to a server."""

    def command(self, name: str, /, timeout: float = 10.0, **arguments: Any) -> dict[str, Any]:
        """Sends any command of the server, also one without a function of its own; returns its answer as a dictionary.

        name       of the command, such as "figures", "steps", "audit", "menu" or "recording"
        arguments  as in JSON: lengths in metres, times in nanoseconds"""
        return self._command(name, arguments, timeout)

    def _command(self, name: str, arguments: dict[str, Any], timeout: float = 10.0, parts: Parts | None = None) -> dict[str, Any]:
        """parts: the shape, for a command that takes one"""
        array, count = (None, 0) if parts is None else (parts.array, parts.count)
        words = encoded(name, "the command"), as_json(arguments, name)
        answer = call_for_text("command", self._handle, *words, array, count, nanoseconds(timeout, "timeout"))
        return answer if isinstance(answer, dict) else {"answer": answer}


def deadline_ns(deadline: float, timeout: float) -> int:
    """Time that the server may work on an answer; without a deadline slightly longer than the timeout of the call."""
    return nanoseconds(deadline, "deadline") or min(nanoseconds(timeout, "timeout"), _DAY_NS) + 10**8


def instant(as_of: str | int) -> str:
    """The instant that an answer is about, in the form of commands."""
    if as_of == "latest":
        return ""
    if as_of == "settled" or (isinstance(as_of, int) and not isinstance(as_of, bool)):
        return str(as_of)
    raise BadInput(
        f"as_of is {as_of!r}; known are 'latest', 'settled', nanoseconds since 1970, and minus the nanoseconds before now",
        "nothing was sent",
    )
