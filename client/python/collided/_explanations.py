"""Why an answer is what it is: of a ray, of two objects, of a standing question, of an event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from ._answers import Verdict

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class ExplainedMeeting:
    """An object that a ray meets. Metres; |truth - distance| <= error."""

    object: str
    kind: str  #: box, sphere, ..., mesh, compound
    distance: float
    error: float
    point: Vector
    normal: Vector
    triangle: int | None
    part: int | None  #: which of several primitives of the object
    rung: Annotated[str, "level"]  #: the arithmetic that decided: "double", "expansion" or "rational"
    inside: bool  #: the ray begins in it
    stale: bool  #: its publisher is lost, and it may be elsewhere
    age_ns: int | None  #: of its pose; None: it has stood since it was added
    why_left_out: Annotated[str, "why"]  #: empty: the filter lets it answer


@dataclass(frozen=True)
class ExplainedMiss:
    """An object that a ray does not meet, or of which that is open. Metres; |truth - distance| <= error."""

    object: str
    verdict: Annotated[Verdict, "answer"]  #: MISS or UNDECIDED
    distance: float  #: the least of any two points of ray and object
    error: float
    along: float  #: where on the ray that is, about
    on_ray: Vector
    on_object: Vector
    triangle: int | None
    where: str  #: "beside" the ray, at its "start", or at its "end", by its length
    box_met: bool  #: the ray meets its bounding box, so its parts were candidates
    why_left_out: Annotated[str, "why"]  #: empty: the filter lets it answer


@dataclass(frozen=True)
class ExplainedStale:
    """An object whose publisher is lost, and that may be in a ray's way by now."""

    object: str
    age_ns: int
    start: Annotated[float, "from"]  #: where along the ray that may be, at the earliest, in metres


@dataclass(frozen=True)
class ExplainedRay:
    """Why a ray meets what it meets. As a truth value it is its verdict's."""

    verdict: Annotated[Verdict, "answer"]
    reason: str  #: of an undecided one
    rung: Annotated[str, "level"]  #: the highest that the whole answer needed
    nodes: int  #: boxes of the indexes that were opened
    exact_tests: int
    objects: int  #: in the world
    candidates: Annotated[int, "boxes_met"]  #: whose boxes the ray meets and that may answer
    left_out_count: int  #: objects that the filter leaves out
    met: tuple[ExplainedMeeting, ...]  #: each object once, in order along the ray; the first is the answer
    left_out: tuple[ExplainedMeeting, ...]  #: would have come before the answer but for the filter
    misses: tuple[ExplainedMiss, ...]  #: nearest first, then the one asked for
    stale: tuple[ExplainedStale, ...]
    unknown: tuple[str, ...]  #: unknown space whose box the ray meets
    covered: Annotated[float | None, "not_covered", "covered"]  #: metres of the ray with complete geometry; None: all of it
    cut: bool  #: there are more hits than are looked at
    late: bool  #: the deadline was over: nearer misses may be missing
    world_time_ns: Annotated[int, "time_ns"]
    version: int

    def __bool__(self) -> bool:
        return bool(self.verdict)


@dataclass(frozen=True)
class ExplainedApproach:
    """How near two objects came on their ways, not only at the poses that were sent. Metres, world times."""

    end: str  #: "found"; "touched" and "undecided" at time_ns; "cut_short": the deadline was over, at_least holds
    from_ns: int
    to_ns: int
    time_ns: int
    distance: float  #: infinite: nothing was looked at in time
    error: float
    at_least: float  #: at no time of the stretch were they nearer


@dataclass(frozen=True)
class ExplainedPair:
    """How two objects stand to each other, and why no contact of them is reported. As a truth value it is its verdict's."""

    verdict: Annotated[Verdict, "answer"]
    clearance: float  #: the distance, or minus the depth; |truth - clearance| <= error; of no meaning where undecided
    error: float
    stale: bool  #: one of the two may be elsewhere
    why_not: tuple[str, ...]  #: what keeps contacts of the two from being reported, a sentence each
    attached: str  #: the one that moves along with the other; empty: neither
    nearest: ExplainedApproach | None
    no_nearest: str  #: why there is none
    version: int

    def __bool__(self) -> bool:
        return bool(self.verdict)


@dataclass(frozen=True)
class ExplainedObject:
    """How an object stands to a region, or to what a question for the nearest is about. Metres; |truth - clearance| <= error."""

    object: str
    verdict: Annotated[Verdict, "answer"]  #: HIT: it is in, or touches, by where both are now
    clearance: float  #: the distance, or in a region minus the depth; infinite: it was not looked at
    error: float
    on_other: Vector | None  #: the nearest points of two that are apart: of the region or the other object,
    on_object: Vector | None  #: and of this one
    stale: bool  #: its publisher is lost, and it may be elsewhere
    why_left_out: Annotated[str, "why"]  #: empty: the question looks at it
    reported: bool  #: an event has reported that it is in, or the nearest
    since_ns: int | None  #: of reported: since when
    episode: int  #: of reported: the sequence of that event
    doubt: str  #: of reported: why it was, although that is not known


@dataclass(frozen=True)
class ExplainedNews:
    """An event of a standing question that is remembered."""

    sequence: int
    what: str  #: enter, exit; nearest, no longer nearest
    object: str
    why: str
    doubt: str
    low_ns: int  #: it happened between these two
    high_ns: int


@dataclass(frozen=True)
class ExplainedStanding:
    """A region or a question for the nearest. Of the nearest, clearances are distances to what the question is about."""

    name: str
    form: str  #: region or nearest
    only: str
    skip: str
    mask: int
    keep: bool
    kind: str  #: of a region: what its shape is
    to: str  #: the object that a region moves along with, or that the distances are to; empty: none
    detect: tuple[str, ...]  #: of a region: which of enter, exit and cross it reports
    point: Vector | None  #: of the nearest, in place of `to`
    within: float  #: of the nearest: objects farther away do not count
    hysteresis: float  #: of the nearest
    placed: bool  #: False: the object `to` is not there, so the question looks at nothing
    looked_at: int  #: objects
    holds: tuple[ExplainedObject, ...]  #: what was reported: in the region, the deepest first; or the nearest
    others: tuple[ExplainedObject, ...]  #: the nearest others that it looks at, also beyond `within`
    left_out: tuple[ExplainedObject, ...]  #: in the region or nearer than the nearest, and not looked at
    asked_for: ExplainedObject | None
    events: tuple[ExplainedNews, ...]  #: the last that are remembered
    cut_short: int  #: of the nearest: searches cut short at their limit, in which a change may not have been reported
    late: bool  #: the deadline was over: some objects were not looked at
    world_time_ns: Annotated[int, "time_ns"]
    version: int


@dataclass(frozen=True)
class ExplainedBody:
    """One of the two of an event, at the time by which it had happened."""

    object: str
    remembered: bool  #: False: where it was then is not known any more
    moving: bool
    publisher: str
    position: Annotated[Vector | None, "pose"]
    orientation: Annotated[tuple[float, float, float, float] | None, "pose", slice(3, 7)]  #: w first
    motion_from_ns: int | None
    motion_to_ns: int | None

    @property
    def motion_ns(self) -> tuple[int, int] | None:
        """The two poses between which the change lies; None: at rest, or not remembered."""
        return None if self.motion_from_ns is None or self.motion_to_ns is None else (self.motion_from_ns, self.motion_to_ns)


@dataclass(frozen=True)
class ExplainedGap:
    """How the two of an event stood to each other at an end of its bracket."""

    time_ns: int
    verdict: Annotated[Verdict, "answer"]
    clearance: float
    error: float


@dataclass(frozen=True)
class ExplainedEvent:
    """What is behind an event that was reported."""

    sequence: int
    of: str  #: contacts or standing
    what: str  #: began, ended, ...; of standing questions enter, exit, nearest, no longer nearest
    why: str
    doubt: str
    a: str
    b: str
    margin: str  #: of bands: the question's name, and `b` is the object that has the band
    within: str  #: of bands: the band, in metres
    low_ns: int  #: it happened between these two
    high_ns: int
    why_wide: tuple[str, ...]  #: why these two are so far apart, a sentence each
    bodies: tuple[ExplainedBody, ...]
    before: ExplainedGap | None  #: at low_ns
    after: ExplainedGap | None  #: at high_ns
    world_time_ns: int
    version: int
