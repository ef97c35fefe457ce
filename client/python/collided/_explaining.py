"""The calls of a Client that say why: the command `explain`, and its answers read."""

from __future__ import annotations

import math
from typing import Any

from . import _numbers
from ._commands import Commanding
from ._described import read
from ._explanations import ExplainedEvent, ExplainedPair, ExplainedRay, ExplainedStanding
from ._errors import BadInput
from ._library import nanoseconds
from ._numbers import Row


class Explaining(Commanding):
    """The calls of a Client that say why an answer is what it is."""

    def _explanation(self, timeout: float, deadline: float, arguments: dict[str, Any]) -> dict[str, Any]:
        # Without a deadline the server goes on for nearly as long as the call waits.
        within = nanoseconds(deadline, "deadline") or nanoseconds(timeout, "timeout") * 9 // 10
        return self.command("explain", timeout=timeout, deadline_ns=within, **arguments)

    def explain_ray(
        self,
        origin: Row,
        direction: Row,
        length: float = math.inf,
        *,
        only: str = "",
        skip: str = "",
        mask: int = 0xFFFFFFFF,
        why_not: str = "",
        most: int = 3,
        as_of: str | int = "latest",
        deadline: float = 0.0,
        timeout: float = 10.0,
    ) -> ExplainedRay:
        """Why does a ray meet what it meets, and not another object?

        why_not  an object that is reported in any case
        most     objects passed that are reported"""
        numbers = [*_numbers.vector(origin, 3, "origin"), *_numbers.vector(direction, 3, "direction")]
        if not all(map(math.isfinite, numbers)):
            raise BadInput(f"the ray is {numbers}, which are not all finite", "nothing was sent")
        arguments: dict[str, Any] = {"ray": numbers, "only": only, "skip": skip, "mask": mask, "most": most}
        arguments.update(why_not=why_not, as_of=_instant(as_of))
        if length != math.inf:
            arguments["length"] = length
        return read(ExplainedRay, self._explanation(timeout, deadline, arguments))

    def explain_pair(
        self, a: str, b: str, *, last: float = 0.0, as_of: str | int = "latest", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedPair:
        """How do two objects stand to each other, how near did they come, and why are their contacts not reported?

        last  seconds: how far back their paths are looked at; 0: as far as the server remembers"""
        arguments: dict[str, Any] = {"a": a, "b": b, "as_of": _instant(as_of)}
        if last != 0:
            arguments["last_ns"] = nanoseconds(last, "last")
        answer = self._explanation(timeout, deadline, arguments)
        clearance = -answer["depth"] if answer["answer"] == "hit" else answer.get("distance", math.nan)
        return read(ExplainedPair, {"error": "inf", **answer, "clearance": clearance})

    def explain_standing(
        self, name: str, *, why_not: str = "", most: int = 3, deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedStanding:
        """What does a region hold, or what is nearest; what comes next, and what is left out, by how much and why?

        why_not  an object that is reported in any case
        most     objects outside, or farther away, that are reported"""
        arguments = {"standing": name, "why_not": why_not, "most": most}
        return read(ExplainedStanding, self._explanation(timeout, deadline, arguments))

    def explain_event(
        self, sequence: int, *, of: str = "contacts", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedEvent:
        """What is behind an event that was reported? The server remembers the last 4,096 of each kind.

        of  "contacts", or "standing": of standing questions"""
        return read(ExplainedEvent, self._explanation(timeout, deadline, {"event": sequence, "of": of}))


def _instant(as_of: str | int) -> str:
    if as_of == "latest":
        return ""
    if as_of == "settled" or (isinstance(as_of, int) and not isinstance(as_of, bool)):
        return str(as_of)
    raise BadInput(
        f"as_of is {as_of!r}; known are 'latest', 'settled', nanoseconds since 1970, and minus the nanoseconds before now",
        "nothing was sent",
    )
