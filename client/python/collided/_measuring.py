"""The calls of a Client that measure objects, and those that explain an answer."""

from __future__ import annotations

import math
from typing import Any

from . import _numbers
from ._commands import Commanding, deadline_ns, instant
from ._described import read
from ._errors import BadInput
from ._library import nanoseconds
from ._numbers import Row
from ._schema import ClearanceAnswer, ExplainedEvent, ExplainedPair, ExplainedRay, ExplainedStanding, PairAnswer


class Measuring(Commanding):
    """The calls of a Client that measure objects, and those that explain an answer."""

    def pair(
        self,
        a: str,
        b: str,
        timeout: float = 10.0,
        *,
        certificate: bool = False,
        triangles: bool = False,
        most_triangle_pairs: int = 10_000,
        as_of: str | int = "latest",
        opinion: str = "",
        deadline: float = 0.0,
    ) -> PairAnswer:
        """Do two objects touch, how deep, or how far apart are they?

        certificate          add a proof of the answer
        triangles            add every pair of triangles that touch, for two meshes
        most_triangle_pairs  maximum number of these pairs, up to 100,000
        opinion              "fcl": add the answer of the library FCL; empty: none"""
        arguments: dict[str, Any] = {
            "a": a, "b": b, "certificate": certificate, "triangles": triangles, "most": most_triangle_pairs,
            "as_of": instant(as_of), "deadline_ns": deadline_ns(deadline, timeout),
        }
        if opinion:
            arguments["opinion"] = opinion  # an older server refuses unknown arguments
        return read(PairAnswer, self.command("pair", timeout=timeout, **arguments))

    def clearance(
        self,
        group: str,
        to: str = "",
        *,
        most: int = 1,
        nearer: float = math.inf,
        skip: str = "",
        with_filtered: bool = False,
        certificate: bool = False,
        as_of: str | int = "latest",
        deadline: float = 0.0,
        timeout: float = 10.0,
    ) -> ClearanceAnswer:
        """Which pairs of two groups are nearest to each other, and how near? It is one search over all pairs of one state.

        group, to      an object, a scene or a glob; to "": everything that is not in the first group
        most           pairs reported, 1 to 10,000, with certificates to 1,000
        nearer         metres; pairs certainly farther apart are not reported
        skip           glob of objects to leave out of both
        with_filtered  also report pairs that masks and groups exclude
        certificate    add a proof for each pair"""
        arguments: dict[str, Any] = {
            "from": group, "to": to, "most": most, "skip": skip, "with_filtered": with_filtered, "certificate": certificate,
            "as_of": instant(as_of), "deadline_ns": deadline_ns(deadline, timeout),
        }
        if nearer != math.inf:
            arguments["nearer_m"] = nearer
        return read(ClearanceAnswer, self.command("clearance", timeout=timeout, **arguments))

    def _explanation(self, timeout: float, deadline: float, arguments: dict[str, Any]) -> dict[str, Any]:
        return self.command("explain", timeout=timeout, deadline_ns=deadline_ns(deadline, timeout), **arguments)

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
        """Why does a ray hit what it hits, and not another object?

        why_not  an object that is reported in any case
        most     maximum number of missed objects reported"""
        numbers = [*_numbers.vector(origin, 3, "origin"), *_numbers.vector(direction, 3, "direction")]
        if not all(map(math.isfinite, numbers)):
            raise BadInput(f"the ray is {numbers}, which are not all finite", "nothing was sent")
        arguments: dict[str, Any] = {"ray": numbers, "only": only, "skip": skip, "mask": mask, "most": most}
        arguments.update(why_not=why_not, as_of=instant(as_of))
        if length != math.inf:
            arguments["length"] = length
        return read(ExplainedRay, self._explanation(timeout, deadline, arguments))

    def explain_pair(
        self, a: str, b: str, *, last: float = 0.0, as_of: str | int = "latest", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedPair:
        """Do two objects touch, how near did they come, and why are their contacts not reported?

        last  seconds: how far back their paths are searched; 0: as far as the server remembers"""
        arguments: dict[str, Any] = {"a": a, "b": b, "as_of": instant(as_of)}
        if last != 0:
            arguments["last_ns"] = nanoseconds(last, "last")
        return read(ExplainedPair, self._explanation(timeout, deadline, arguments))

    def explain_standing(
        self, name: str, *, why_not: str = "", most: int = 3, deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedStanding:
        """Which objects are in a region, or nearest; which come next, and which are left out, by how much and why?

        why_not  an object that is reported in any case
        most     maximum number of objects outside, or farther away, reported"""
        arguments = {"standing": name, "why_not": why_not, "most": most}
        return read(ExplainedStanding, self._explanation(timeout, deadline, arguments))

    def explain_event(
        self, sequence: int, *, of: str = "contacts", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedEvent:
        """What is the cause of a reported event? The server remembers the last 4,096 of each kind.

        of  "contacts", or "standing": of standing questions"""
        return read(ExplainedEvent, self._explanation(timeout, deadline, {"event": sequence, "of": of}))
