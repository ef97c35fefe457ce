"""Commands as JSON, which several of a Client's calls are made of."""

from __future__ import annotations

import ctypes
import json
from typing import Any

from ._errors import BadInput
from ._library import Owned, call, encoded, library, nanoseconds

_DAY_NS = 86_400 * 10**9


class Commanding(Owned):
    """An object that sends commands to a server."""

    def command(self, name: str, /, timeout: float = 10.0, **arguments: Any) -> dict[str, Any]:
        """Sends any command of the server, also one that has no call of its own; returns its answer as a dictionary.

        name       a word of the server, such as "figures", "steps", "audit", "menu" or "recording"
        arguments  as JSON has them: lengths in metres, times in nanoseconds"""
        text = encoded(json.dumps(arguments), "the arguments")
        said = ctypes.c_void_p()
        call("command", self._handle, encoded(name, "the command"), text, nanoseconds(timeout, "timeout"), ctypes.byref(said))
        try:
            answer = ctypes.string_at(said) if said else b""
        finally:
            library.collided_free_text(said)
        decoded = json.loads(answer) if answer else {}
        return decoded if isinstance(decoded, dict) else {"answer": decoded}


def deadline_ns(deadline: float, timeout: float) -> int:
    """How long the server works on an answer: without a deadline a little longer than the call waits, which ends first."""
    return nanoseconds(deadline, "deadline") or min(nanoseconds(timeout, "timeout"), _DAY_NS) + 10**8


def instant(as_of: str | int) -> str:
    """The instant that an answer is about, as commands have it."""
    if as_of == "latest":
        return ""
    if as_of == "settled" or (isinstance(as_of, int) and not isinstance(as_of, bool)):
        return str(as_of)
    raise BadInput(
        f"as_of is {as_of!r}; known are 'latest', 'settled', nanoseconds since 1970, and minus the nanoseconds before now",
        "nothing was sent",
    )
