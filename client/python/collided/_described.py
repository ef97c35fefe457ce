"""Answers of the server as frozen dataclasses, read by the names of their members."""

from __future__ import annotations

import ctypes
import dataclasses
import enum
import functools
import itertools
import types
import typing
from typing import Any, TypeVar

from ._contract import NO_TRIANGLE, VERDICT
from ._library import text

T = TypeVar("T")


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
    """The answer as a dataclass. A member that was not written is false, 0, empty or None, as its type has it.

    The metadata of a member may have its name in the row ("json"; empty: it is read from the whole row), and the words of Python
    for those of the row ("words")."""
    values = {}
    for name, hint, metadata in _members(typing.cast(Any, kind)):
        place = metadata.get("json", name)
        value = row.get(place) if place else row
        if name.endswith("triangle") and value == NO_TRIANGLE:
            value = None
        values[name] = _value(hint, metadata["words"].get(value, value) if "words" in metadata else value)
    return kind(**values)


@functools.cache
def _members(kind: Any) -> list[tuple[str, Any, Any]]:
    hints = typing.get_type_hints(kind)
    return [(member.name, hints[member.name], member.metadata) for member in dataclasses.fields(kind)]


def row_of(struct: ctypes.Structure) -> dict[str, Any]:
    """A struct of the C interface as the same kind of row: lengths without their unit, texts decoded."""
    return {name.removesuffix("_m"): _plain(getattr(struct, name)) for name, *_ in struct._fields_}


def _plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return text(value)
    return tuple(value) if isinstance(value, ctypes.Array) else value


def _named(kind: Any, numbers: list[Any]) -> dict[str, Any]:
    """A row that was written as numbers alone, a vector as three of them."""
    left, row = iter(numbers), {}
    for name, hint, metadata in _members(kind):
        value: Any = list(itertools.islice(left, 3 if typing.get_origin(hint) is tuple else 1))
        row[metadata.get("json", name)] = value if len(value) == 3 else value[0]
    return row


def _value(hint: Any, value: Any) -> Any:
    kinds = typing.get_args(hint)
    if isinstance(hint, types.UnionType):
        return None if value is None else _value(kinds[0], value)
    if dataclasses.is_dataclass(hint):
        return read(typing.cast(type, hint), _named(hint, value) if isinstance(value, list) else value or {})
    if hint is Verdict:
        return _VERDICTS.get(value, Verdict.UNDECIDED)
    if typing.get_origin(hint) is not tuple:
        return hint() if value is None else hint(value)
    if kinds[-1] is ...:
        return tuple(_value(kinds[0], each) for each in value or ())
    return tuple(_value(of, each) for of, each in itertools.zip_longest(kinds, value or ()))
