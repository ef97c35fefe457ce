"""Reads answers and events of the server into frozen dataclasses, by the names of their members."""

from __future__ import annotations

import dataclasses
import enum
import functools
import itertools
import types
import typing
from typing import Any, Callable, Mapping, TypeVar

from ._contract import NO_TRIANGLE, VERDICT

T = TypeVar("T")
Reader = Callable[[Any], Any]


class Undecided(Exception):
    """An answer that is neither yes nor no was used as a truth value."""


class Verdict(enum.IntEnum):
    """MISS and HIT are false and true. bool() of the others raises Undecided, since "not known to hit" must not be read as
    "free"."""

    MISS = VERDICT.index("miss")
    HIT = VERDICT.index("hit")
    UNDECIDED = VERDICT.index("undecided")
    INVALID = VERDICT.index("invalid")

    def __bool__(self) -> bool:
        if self in (Verdict.UNDECIDED, Verdict.INVALID):
            raise Undecided(f"the answer is {self.name.lower()}, which is neither a hit nor a miss")
        return self is Verdict.HIT


# The words of answers.
_VERDICTS = {
    **dict.fromkeys(("miss", "outside", "apart"), Verdict.MISS),
    **dict.fromkeys(("hit", "inside", "touching"), Verdict.HIT),
}


class Judged:
    """An answer whose truth value is that of its verdict, its first member."""

    def __bool__(self) -> bool:
        return bool(next(iter(vars(self).values())))


def read(kind: type[T], row: dict[str, Any]) -> T:
    """Reads a row as a dataclass. A missing member is false, 0, empty or None, depending on its type.

    The metadata of a member may have these:
      json   its name in the row; empty: it is read from the whole row
      words  Python's words by those of the row
      ends   names of numbers that form a tuple"""
    return kind(**{name: value(row.get(place) if place else row) for name, place, value in _members(typing.cast(Any, kind))})


@functools.cache
def _hints(kind: Any) -> dict[str, Any]:
    return typing.get_type_hints(kind)


@functools.cache
def _members(kind: Any) -> list[tuple[str, str, Reader]]:
    hints = _hints(kind)
    return [(member.name, member.metadata.get("json", member.name), _reading(member.name, hints[member.name], member.metadata))
            for member in dataclasses.fields(kind)]


def _reading(name: str, hint: Any, metadata: Mapping[str, Any]) -> Reader:
    value = _value(hint)
    if name.endswith("triangle"):
        return lambda given: value(None if given == NO_TRIANGLE else given)
    if "words" in metadata:
        words = metadata["words"]
        return lambda given: value(words.get(given, given))
    if "ends" in metadata:
        ends = metadata["ends"]
        return lambda given: value(None if given is None else [given.get(end) for end in ends])
    return value


def _value(hint: Any) -> Reader:
    kinds, several = typing.get_args(hint), typing.cast(Any, typing.get_origin(hint))
    if isinstance(hint, types.UnionType):
        inner = _value(kinds[0])
        return lambda value: None if value is None else inner(value)
    if dataclasses.is_dataclass(hint):
        return lambda value: read(typing.cast(type, hint), _named(hint, value) if isinstance(value, list) else value or {})
    if hint is Verdict:
        return lambda value: _VERDICTS.get(value, Verdict.UNDECIDED)
    if several is None:
        return lambda value: hint() if value is None else hint(value)
    values = [_value(each) for each in kinds if each is not ...]
    if several is list or kinds[-1] is ...:
        return lambda value: several(map(values[0], value or ()))
    return lambda value: tuple(one(each) for one, each in itertools.zip_longest(values, value or ()))


def _named(kind: Any, numbers: list[Any]) -> dict[str, Any]:
    """Names the numbers of a row that was written without names, a vector as three numbers."""
    left, row = iter(numbers), {}
    for name, place, _ in _members(kind):
        value: Any = list(itertools.islice(left, 3 if typing.get_origin(_hints(kind)[name]) is tuple else 1))
        row[place] = value if len(value) == 3 else value[0]
    return row
