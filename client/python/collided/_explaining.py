"""The calls of a Client that say why: the command `explain`, and its answers read."""

from __future__ import annotations

import math
from typing import Any

from . import _numbers
from ._answers import NO_TRIANGLE, Verdict
from ._commands import Commanding
from ._explanations import (
    ExplainedApproach,
    ExplainedBody,
    ExplainedEvent,
    ExplainedFence,
    ExplainedGap,
    ExplainedMeeting,
    ExplainedMiss,
    ExplainedNearest,
    ExplainedNews,
    ExplainedPair,
    ExplainedRay,
    ExplainedStale,
    ExplainedStanding,
    Vector,
)
from ._errors import BadInput
from ._library import nanoseconds
from ._numbers import Row

_VERDICTS = {
    "miss": Verdict.MISS,
    "hit": Verdict.HIT,
    "outside": Verdict.MISS,
    "inside": Verdict.HIT,
    "apart": Verdict.MISS,
    "touching": Verdict.HIT,
}


def _triple(numbers: list[float]) -> Vector:
    return numbers[0], numbers[1], numbers[2]


def _number(value: float | str) -> float:
    return math.inf if isinstance(value, str) else value


def _verdict(row: dict[str, Any]) -> Verdict:
    return _VERDICTS.get(row["answer"], Verdict.UNDECIDED)


def _triangle(row: dict[str, Any]) -> int | None:
    return None if row["triangle"] == NO_TRIANGLE else int(row["triangle"])


def _meeting(row: dict[str, Any]) -> ExplainedMeeting:
    return ExplainedMeeting(
        object=row["object"],
        kind=row["kind"],
        distance=row["distance"],
        error=_number(row["error"]),
        point=_triple(row["point"]),
        normal=_triple(row["normal"]),
        triangle=_triangle(row),
        part=row.get("part"),
        rung=row["level"],
        inside=row["inside"],
        stale=row.get("stale", False),
        age_ns=row.get("age_ns"),
        why_left_out=row.get("why", ""),
    )


def _miss(row: dict[str, Any]) -> ExplainedMiss:
    return ExplainedMiss(
        object=row["object"],
        verdict=_verdict(row),
        distance=_number(row["distance"]),
        error=_number(row["error"]),
        along=row["along"],
        on_ray=_triple(row["on_ray"]),
        on_object=_triple(row["on_object"]),
        triangle=_triangle(row),
        where=row["where"],
        box_met=row["box_met"],
        why_left_out=row.get("why", ""),
    )


def _standing(row: dict[str, Any]) -> ExplainedStanding:
    return ExplainedStanding(
        object=row["object"],
        verdict=_verdict(row),
        clearance=_number(row["clearance"]),
        error=_number(row["error"]),
        stale=row.get("stale", False),
        told=row.get("told", False),
        since_ns=row.get("since_ns"),
        episode=row.get("episode", 0),
        doubt=row.get("doubt", ""),
        why_left_out=row.get("why", ""),
    )


def _approach(row: dict[str, Any]) -> ExplainedApproach:
    return ExplainedApproach(
        end=row["end"],
        from_ns=row["from_ns"],
        to_ns=row["to_ns"],
        time_ns=row["time_ns"],
        distance=_number(row["distance"]),
        error=_number(row["error"]),
        at_least=_number(row["at_least"]),
    )


def _body(row: dict[str, Any]) -> ExplainedBody:
    pose = row.get("pose")
    return ExplainedBody(
        object=row["object"],
        remembered=row["remembered"],
        moving=row.get("moving", False),
        publisher=row.get("publisher", ""),
        position=None if pose is None else _triple(pose),
        orientation=None if pose is None else (pose[3], pose[4], pose[5], pose[6]),
        motion_ns=(row["motion_from_ns"], row["motion_to_ns"]) if "motion_from_ns" in row else None,
    )


def _gap(row: dict[str, Any] | None) -> ExplainedGap | None:
    return None if row is None else ExplainedGap(row["time_ns"], _verdict(row), row["clearance"], _number(row["error"]))


def read_ray(answer: dict[str, Any]) -> ExplainedRay:
    leaving = answer.get("not_covered")
    return ExplainedRay(
        verdict=_verdict(answer),
        reason=answer["reason"],
        rung=answer["level"],
        nodes=answer["nodes"],
        exact_tests=answer["exact_tests"],
        objects=answer["objects"],
        candidates=answer["boxes_met"],
        left_out_count=answer["left_out_count"],
        met=tuple(map(_meeting, answer["met"])),
        left_out=tuple(map(_meeting, answer["left_out"])),
        misses=tuple(map(_miss, answer["misses"])),
        stale=tuple(ExplainedStale(row["object"], row["age_ns"], row["from"]) for row in answer["stale"]),
        unknown=tuple(answer["unknown"]),
        covered=None if leaving is None else _number(leaving["covered"]),
        cut=answer.get("cut", False),
        late=answer.get("late", False),
        world_time_ns=answer["time_ns"],
        version=answer["version"],
    )


def read_pair(answer: dict[str, Any]) -> ExplainedPair:
    nearest = answer.get("nearest")
    verdict = _verdict(answer)
    return ExplainedPair(
        verdict=verdict,
        clearance=-answer["depth"] if verdict is Verdict.HIT else answer.get("distance", math.nan),
        error=_number(answer.get("error", "inf")),
        stale=answer.get("stale", False),
        why_not=tuple(answer["why_not"]),
        attached=answer["attached"],
        nearest=None if nearest is None else _approach(nearest),
        no_nearest=answer.get("no_nearest", ""),
        version=answer["version"],
    )


def read_fence(answer: dict[str, Any]) -> ExplainedFence:
    asked_for = answer.get("asked_for")
    return ExplainedFence(
        fence=answer["fence"],
        kind=answer["kind"],
        to=answer["to"],
        only=answer["only"],
        skip=answer["skip"],
        mask=answer["mask"],
        tells=tuple(answer["tells"]),
        keep=answer["keep"],
        placed=answer["placed"],
        looked_at=answer["looked_at"],
        inside=tuple(map(_standing, answer["inside"])),
        outside=tuple(map(_standing, answer["outside"])),
        left_out=tuple(map(_standing, answer["left_out"])),
        asked_for=None if asked_for is None else _standing(asked_for),
        events=tuple(ExplainedNews(**row) for row in answer["events"]),
        late=answer.get("late", False),
        world_time_ns=answer["time_ns"],
        version=answer["version"],
    )


def read_nearest(answer: dict[str, Any]) -> ExplainedNearest:
    asked_for, point = answer.get("asked_for"), answer.get("point")
    return ExplainedNearest(
        nearest=answer["nearest"],
        to=answer["to"],
        point=None if point is None else _triple(point),
        only=answer["only"],
        skip=answer["skip"],
        mask=answer["mask"],
        within=answer["within"],
        hysteresis=answer["hysteresis"],
        keep=answer["keep"],
        placed=answer["placed"],
        looked_at=answer["looked_at"],
        answer=_standing(answer["is"][0]) if answer["is"] else None,
        others=tuple(map(_standing, answer["others"])),
        left_out=tuple(map(_standing, answer["left_out"])),
        asked_for=None if asked_for is None else _standing(asked_for),
        events=tuple(ExplainedNews(**row) for row in answer["events"]),
        cut_short=answer["cut_short"],
        late=answer.get("late", False),
        world_time_ns=answer["time_ns"],
        version=answer["version"],
    )


def read_event(answer: dict[str, Any]) -> ExplainedEvent:
    return ExplainedEvent(
        sequence=answer["sequence"],
        of=answer["of"],
        what=answer["what"],
        why=answer["why"],
        doubt=answer["doubt"],
        a=answer["a"],
        b=answer["b"],
        margin=answer.get("margin", ""),
        within=answer.get("within", ""),
        low_ns=answer["low_ns"],
        high_ns=answer["high_ns"],
        why_wide=tuple(answer["why_wide"]),
        bodies=tuple(map(_body, answer["bodies"])),
        before=_gap(answer.get("before")),
        after=_gap(answer.get("after")),
        world_time_ns=answer["world_time_ns"],
        version=answer["version"],
    )


class Explaining(Commanding):
    """The calls of a Client that say why an answer is what it is."""

    def _explanation(self, timeout: float, deadline: float, arguments: dict[str, Any]) -> dict[str, Any]:
        # Without a deadline the server looks on for as long as the call waits.
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

        why_not  an object that is told of in any case
        most     objects passed that are told"""
        numbers = [*_numbers.vector(origin, 3, "origin"), *_numbers.vector(direction, 3, "direction")]
        if not all(map(math.isfinite, numbers)):
            raise BadInput(f"the ray is {numbers}, which are not all finite", "nothing was sent")
        arguments: dict[str, Any] = {"ray": numbers, "only": only, "skip": skip, "mask": mask, "most": most}
        arguments.update(why_not=why_not, as_of=_instant(as_of))
        if length != math.inf:
            arguments["length"] = length
        return read_ray(self._explanation(timeout, deadline, arguments))

    def explain_pair(
        self, a: str, b: str, *, last: float = 0.0, as_of: str | int = "latest", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedPair:
        """How do two objects stand to each other, how near did they come, and what keeps their contacts from being told?

        last  seconds: how far back their paths are looked at; 0: as far as the server remembers"""
        arguments: dict[str, Any] = {"a": a, "b": b, "as_of": _instant(as_of)}
        if last != 0:
            arguments["last_ns"] = nanoseconds(last, "last")
        return read_pair(self._explanation(timeout, deadline, arguments))

    def explain_fence(
        self, name: str, *, why_not: str = "", most: int = 3, deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedFence:
        """Who is in a fence and who is not, by how much and why?

        why_not  an object that is told of in any case
        most     objects outside that are told"""
        return read_fence(self._explanation(timeout, deadline, {"fence": name, "why_not": why_not, "most": most}))

    def explain_nearest(
        self, name: str, *, why_not: str = "", most: int = 3, deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedNearest:
        """What is nearest by a question that stays, what comes next, and what would be nearer but is left out?

        why_not  an object that is told of in any case
        most     others that are told"""
        return read_nearest(self._explanation(timeout, deadline, {"nearest": name, "why_not": why_not, "most": most}))

    def explain_event(
        self, sequence: int, *, of: str = "contacts", deadline: float = 0.0, timeout: float = 10.0
    ) -> ExplainedEvent:
        """What is behind an event that was told? The server remembers the last 4,096 of contacts, and of fences.

        of  "contacts", or "fences": of fences, margins and questions for the nearest, which are numbered together"""
        return read_event(self._explanation(timeout, deadline, {"event": sequence, "of": of}))


def _instant(as_of: str | int) -> str:
    if as_of == "latest":
        return ""
    if as_of == "settled" or (isinstance(as_of, int) and not isinstance(as_of, bool)):
        return str(as_of)
    raise BadInput(
        f"as_of is {as_of!r}; known are 'latest', 'settled', nanoseconds since 1970, and minus the nanoseconds before now",
        "nothing was sent",
    )
