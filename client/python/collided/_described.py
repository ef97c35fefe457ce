"""Answers of the server as instances of dataclasses, whose annotations say how they are read."""

from __future__ import annotations

import ctypes
import dataclasses
import functools
import math
import types
import typing
from typing import Any, TypeVar

from ._answers import Verdict
from ._contract import NO_TRIANGLE
from ._library import text, word

_VERDICTS = {
    **dict.fromkeys(("miss", "outside", "apart"), Verdict.MISS),
    **dict.fromkeys(("hit", "inside", "touching"), Verdict.HIT),
}
T = TypeVar("T")


def read(kind: type[T], row: dict[str, Any]) -> T:
    """The answer as a dataclass.

    A member comes from that of its own name, or of the path in its Annotated[type, "name", place in the value, ...]; a tuple or
    a dictionary in the path has the words for codes. A member that was not written is false, 0, empty or None, as its type has
    it."""
    return kind(**{name: _value(hint, _reached(row, path)) for name, hint, path in _members(typing.cast(Any, kind))})


def row_of(struct: ctypes.Structure) -> dict[str, Any]:
    """A struct of the C interface as the same kind of row: lengths without their unit, texts decoded."""
    return {name.removesuffix("_m"): _plain(getattr(struct, name)) for name, *_ in struct._fields_}


def _plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return text(value)
    return tuple(value) if isinstance(value, ctypes.Array) else value


@functools.cache
def _members(kind: type) -> list[tuple[str, Any, tuple[Any, ...]]]:
    members = []
    for name, hint in typing.get_type_hints(kind, include_extras=True).items():
        is_annotated = typing.get_origin(hint) is typing.Annotated
        members.append((name, hint.__origin__, hint.__metadata__) if is_annotated else (name, hint, (name,)))
    return members


def _reached(value: Any, path: tuple[Any, ...]) -> Any:
    for step in path:
        if value is None:
            return None
        if isinstance(step, str):
            value = value.get(step)
        elif isinstance(step, slice):
            value = value[step]
        elif isinstance(step, tuple):
            value = word(step, value)
        elif isinstance(step, dict):
            value = step[value]
        else:
            value = value[step] if step < len(value) else None
    return None if str(path[0]).endswith("triangle") and value == NO_TRIANGLE else value


def _value(hint: Any, value: Any) -> Any:
    kinds = typing.get_args(hint)
    if isinstance(hint, types.UnionType):
        return None if value is None else _value(kinds[0], value)
    if value is None:
        return hint()
    if hint is float:
        return math.inf if isinstance(value, str) else value
    if hint is Verdict:
        return Verdict(value) if isinstance(value, int) else _VERDICTS.get(value, Verdict.UNDECIDED)
    if hint is bool:
        return bool(value)
    if typing.get_origin(hint) is tuple:
        return tuple(_value(kinds[0], one) for one in value) if kinds[-1] is ... else tuple(value[: len(kinds)])
    return read(hint, value) if dataclasses.is_dataclass(hint) else value
