"""Groups of objects: how near they are to each other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from ._answers import Verdict

Vector = tuple[float, float, float]
_CONTAINED = {"": "", "a": "a_in_b", "b": "b_in_a"}


@dataclass(frozen=True)
class ClearancePair:
    """An object of the first group and one of the other. Metres; |truth - clearance| <= error."""

    a: str
    b: str
    verdict: Annotated[Verdict, "answer"]  #: HIT: they touch, or one lies within the other, which is solid
    clearance: float  #: their distance; where they touch minus the depth
    error: float
    #: "a_in_b" or "b_in_a" where one lies wholly within the other, a solid; else empty
    contained: Annotated[str, "contained", _CONTAINED]
    on_a: Vector
    on_b: Vector
    normal: Vector  #: unit, from a to b
    stale: bool  #: where one of them is now is not known


@dataclass(frozen=True)
class Clearance:
    """The nearest pairs of two groups. As a truth value it is its verdict's: some pair touches, or none does."""

    verdict: Annotated[Verdict, "answer"]
    pairs: tuple[ClearancePair, ...]  #: least clearance first; empty where all are farther apart than asked for
    cut: bool  #: more pairs are so near than were to be told
    late: bool  #: the deadline was over: a nearer pair may be missing
    stale: bool  #: an object of a lost publisher may by now be in a nearer pair
    version: int
    uncovered: Vector | None = None  #: a point nearer than the last pair in which the geometry is not known to be complete

    def __bool__(self) -> bool:
        return bool(self.verdict)
