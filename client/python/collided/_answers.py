"""Answers: yes, no, or undecided, and what was hit."""

from __future__ import annotations

import array
import ctypes
import math
from dataclasses import dataclass
from typing import Any, Iterator

from . import _numbers
from ._contract import UNDECIDED_REASON
from ._described import Undecided, Verdict, read
from ._library import Owned, library, text, word
from ._schema import Hit
from ._structs import CAnswersInfo, CColumns


@dataclass(frozen=True)
class Answer:
    """The answer to one question. Its truth value is that of its verdict.

    verdict
    reason     if undecided: why, such as "stale_object"; else empty
    hits       nearest first, for spheres and boxes deepest first
    uncovered  with reason "not_covered": the point at which the question leaves the space with complete geometry
    covered    with reason "not_covered": metres before that point
    """

    verdict: Verdict
    reason: str
    hits: tuple[Hit, ...]
    uncovered: tuple[float, float, float] | None = None
    covered: float | None = None

    def __bool__(self) -> bool:
        return bool(self.verdict)


# Each column's element types (numpy, array) and its numbers per entry.
_TYPES = {
    "verdict": ("u1", "B", 1),
    "reason": ("u1", "B", 1),
    "hit_count": ("u4", "I", 1),
    "object_id": ("u8", "Q", 1),
    "triangle": ("u4", "I", 1),
    "distance_m": ("f8", "d", 1),
    "error_m": ("f8", "d", 1),
    "exit_m": ("f8", "d", 1),
    "point": ("f8", "d", 3),
    "point_error_m": ("f8", "d", 1),
    "normal": ("f8", "d", 3),
    "weights": ("f8", "d", 3),
    "time_low": ("f8", "d", 1),
    "time_high": ("f8", "d", 1),
    "inside": ("u1", "B", 1),
    "stale": ("u1", "B", 1),
    "by_winding": ("u1", "B", 1),
    "uncovered": ("f8", "d", 3),
    "covered_m": ("f8", "d", 1),
}
_OF_QUESTIONS = ("verdict", "reason", "hit_count", "uncovered", "covered_m")


class Answers(Owned):
    """The answers to one call, in the order of its questions, all about one state of the world.

    The columns (distance, point, object and so on) describe each question's first hit; NaN, 0 or None without a hit. They
    are numpy arrays if numpy is installed, else array.array or lists. hits() has all hits. A column is fetched when it is
    first read. If passed as `out=` to a later call, the memory is reused and the columns change.
    """

    _what = "the answers"

    def __init__(self) -> None:
        super().__init__(ctypes.c_void_p(), "free_answers")
        self._columns: dict[tuple[str, bool], Any] = {}
        self._info = CAnswersInfo(size=ctypes.sizeof(CAnswersInfo))
        self._names: dict[int, str] = {}

    def _empty(self) -> ctypes.c_void_p:
        """Drops the answers; returns the handle for the next ones."""
        self._columns.clear()
        self._names.clear()
        self._info = CAnswersInfo(size=ctypes.sizeof(CAnswersInfo))
        return self._handle

    def _refill(self) -> None:
        library.collided_get_info(self._handle, ctypes.byref(self._info))

    def _column(self, name: str, first_hits: bool = True) -> Any:
        kept = self._columns.get((name, first_hits))
        if kept is not None:
            return kept
        of_question = name in _OF_QUESTIONS
        count = self._info.questions if first_hits or of_question else self._info.hits
        dtype, code, width = _TYPES[name]
        if _numbers.numpy is not None:
            column = _numbers.numpy.empty((count, width) if width > 1 else count, dtype=dtype)
            address = column.ctypes.data
        else:
            column = array.array(code, bytes(array.array(code).itemsize * count * width))
            address = column.buffer_info()[0]
        wanted = CColumns(size=ctypes.sizeof(CColumns), first_hits=1 if first_hits else 0, **{name: address})
        library.collided_read_columns(self._handle, ctypes.byref(wanted))
        self._columns[(name, first_hits)] = column
        return column

    @property
    def epoch(self) -> int:
        """Grows with each start of a server."""
        return int(self._info.epoch)

    @property
    def version(self) -> int:
        """Number of the state of the world; grows with each change."""
        return int(self._info.version)

    @property
    def world_time_ns(self) -> int:
        """Time of that state, since 1970, by the publishers' clocks."""
        return int(self._info.world_time_ns)

    @property
    def oldest_pose_age_ns(self) -> int | None:
        """Age of the oldest pose that decided an answer; None: only static geometry decided."""
        return int(self._info.oldest_pose_age_ns) if self._info.has_oldest_pose else None

    @property
    def compute(self) -> float:
        """Computing time of the server in seconds, summed over its messages."""
        return float(self._info.compute_ns) * 1e-9

    @property
    def verdict(self) -> Any:
        """(n,) numbers of Verdict; compare them with Verdict.HIT and the others."""
        return self._column("verdict")

    @property
    def reason(self) -> Any:
        """(n,) numbers: 0 decided, 1 numeric, 2 stale_object, 3 recovering, 4 truncated, 5 deadline, 6 not_covered."""
        return self._column("reason")

    @property
    def hit_count(self) -> Any:
        """(n,) numbers of hits."""
        return self._column("hit_count")

    @property
    def object_id(self) -> Any:
        """(n,) the server's numbers of the objects."""
        return self._column("object_id")

    @property
    def triangle(self) -> Any:
        """(n,) numbers of triangles; 4294967295 for other shapes."""
        return self._column("triangle")

    @property
    def distance(self) -> Any:
        """(n,) metres: for a ray the distance from its origin, for a sphere or box the depth, for nearest the distance from the
        point."""
        return self._column("distance_m")

    @property
    def error(self) -> Any:
        """(n,) metres; |true distance - distance| at most."""
        return self._column("error_m")

    @property
    def exit(self) -> Any:
        """(n,) metres: distance along a ray at which it leaves a convex solid; else 0."""
        return self._column("exit_m")

    @property
    def point(self) -> Any:
        """(n, 3) metres, world coordinates."""
        return self._column("point")

    @property
    def normal(self) -> Any:
        """(n, 3) unit vectors: for rays against their direction, for nearest towards the point."""
        return self._column("normal")

    @property
    def time_low(self) -> Any:
        """(n,) for sweeps, 0 to 1: no contact before this time."""
        return self._column("time_low")

    @property
    def time_high(self) -> Any:
        """(n,) for sweeps: contact by this time."""
        return self._column("time_high")

    @property
    def inside(self) -> Any:
        """(n,) 1 if a ray begins, or a point lies, in a solid; 2 if that is by winding number; else 0."""
        return self._column("inside")

    @property
    def by_winding(self) -> Any:
        """(n,) 1 if the distance is to the surface of a mesh that does not close, and not a depth; else 0."""
        return self._column("by_winding")

    @property
    def uncovered(self) -> Any:
        """(n, 3) the point at which a question leaves the space with complete geometry; else NaN."""
        return self._column("uncovered")

    @property
    def covered(self) -> Any:
        """(n,) metres of the question before that point, with reason 6; else NaN."""
        return self._column("covered_m")

    @property
    def object(self) -> list[str | None]:
        """Name of the object that each question hit first; None without a hit."""
        names: list[str | None] = []
        hit = 0
        for count, number in zip(self.hit_count, self.object_id):
            names.append(self._name(hit, int(number)) if count else None)
            hit += int(count)
        return names

    def _name(self, hit: int, object_id: int) -> str:
        name = self._names.get(object_id)
        if name is None:
            name = text(library.collided_hit_object(self._handle, hit))
            self._names[object_id] = name
        return name

    def is_hit(self) -> Any:
        """(n,) true or false. Raises Undecided if an answer is neither."""
        for verdict in set(self.verdict.tolist()):
            bool(Verdict(verdict))
        if _numbers.numpy is not None:
            return self.verdict == int(Verdict.HIT)
        return [verdict == int(Verdict.HIT) for verdict in self.verdict]

    def hits(self) -> Any:
        """All hits of all questions as a structured numpy array: question, object_id, triangle, distance, error, point,
        normal and so on; without numpy a list of (question, Hit)."""
        if _numbers.numpy is None:
            return [(i, hit) for i, answer in enumerate(self) for hit in answer.hits]
        numpy = _numbers.numpy
        fields = [name for name in _TYPES if name not in _OF_QUESTIONS]
        layout = [(name.removesuffix("_m"), _TYPES[name][0], (3,) if _TYPES[name][2] == 3 else ()) for name in fields]
        table = numpy.empty(self._info.hits, dtype=[("question", "u4"), *layout])
        table["question"] = numpy.repeat(numpy.arange(len(self), dtype="u4"), self.hit_count)
        for name in fields:
            table[name.removesuffix("_m")] = self._column(name, first_hits=False)
        return table

    def __len__(self) -> int:
        return int(self._info.questions)

    def __getitem__(self, index: int) -> Answer:
        if not -len(self) <= index < len(self):
            raise IndexError(f"answer {index} of {len(self)}")
        index %= len(self)
        first = int(sum(self.hit_count[:index]))
        return self._answer(index, first)

    def __iter__(self) -> Iterator[Answer]:
        first = 0
        for index in range(len(self)):
            yield self._answer(index, first)
            first += int(self.hit_count[index])

    def _answer(self, index: int, first: int) -> Answer:
        reason = int(self.reason[index])
        return Answer(
            Verdict(int(self.verdict[index])),
            word(UNDECIDED_REASON, reason),
            tuple(self._hit(first + i) for i in range(int(self.hit_count[index]))),
            *self._uncovered(index, reason),
        )

    def _uncovered(self, index: int, reason: int) -> tuple[tuple[float, float, float] | None, float | None]:
        if word(UNDECIDED_REASON, reason) != "not_covered":
            return None, None
        point, covered = self._triple("uncovered", index), float(self._column("covered_m")[index])
        return (None, None) if math.isnan(point[0]) else (point, None if math.isnan(covered) else covered)

    def _triple(self, name: str, number: int) -> tuple[float, float, float]:
        column = self._column(name, first_hits=False)
        three = column[number] if _numbers.numpy is not None else column[3 * number : 3 * number + 3]
        return float(three[0]), float(three[1]), float(three[2])

    def _hit(self, number: int) -> Hit:
        row: dict[str, Any] = {}
        for name, (_, _, width) in _TYPES.items():
            if name not in _OF_QUESTIONS:
                value = self._triple(name, number) if width == 3 else self._column(name, first_hits=False)[number]
                row[name.removesuffix("_m")] = value
        return read(Hit, {"object": self._name(number, int(row["object_id"])), **row})

    def __bool__(self) -> bool:
        raise Undecided("many answers are neither true nor false together; is_hit() has one for each question")
