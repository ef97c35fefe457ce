"""Arrays of numbers for C: numpy arrays, without a copy if their layout fits, or lists."""

from __future__ import annotations

import array
import ctypes
from typing import TYPE_CHECKING, Any, Sequence, Union

from ._errors import BadInput

try:
    import numpy as numpy
except ImportError:  # lists and arrays do too
    numpy = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    Rows = Union[ArrayLike, Sequence[Sequence[float]]]
    Row = Union[ArrayLike, Sequence[float]]
else:
    Rows = Row = Any

_NOTHING_SENT = "nothing was sent"


class Numbers:
    """`count` rows of `width` numbers as C reads them; keeps them alive."""

    def __init__(self, kept: Any, address: int, count: int, width: int) -> None:
        self.kept = kept
        self.width = width
        self.pointer = ctypes.c_void_p(address)
        self.count = count


Column = Union[Numbers, tuple[float, ...]]  # a tuple repeats in all rows


def _from_numpy(values: Any, width: int, what: str, kind: str) -> Numbers:
    wanted = {"d": "float64", "f": "float32", "I": "uint32"}[kind]
    given = numpy.asarray(values)
    shape = f"(n, {width})" if width > 1 else "(n,)"
    if given.ndim != (2 if width > 1 else 1) or (width > 1 and given.shape[1] != width):
        raise BadInput(f"{what} has the shape {given.shape}; wanted is {shape}", _NOTHING_SENT)
    if given.dtype.kind not in ("iu" if kind == "I" else "fiu"):
        raise BadInput(f"{what} holds {given.dtype}; wanted are numbers of {wanted}", _NOTHING_SENT)
    if kind == "I" and given.size > 0 and (given.min() < 0 or given.max() > 0xFFFFFFFF):
        raise BadInput(f"{what} has values beyond 0 to 4294967295", _NOTHING_SENT)
    held = numpy.ascontiguousarray(given, dtype=wanted)
    return Numbers(held, held.ctypes.data, held.shape[0], width)


def _from_sequence(values: Any, width: int, what: str, kind: str) -> Numbers:
    flat = array.array(kind)
    if flat.itemsize != {"d": 8, "f": 4, "I": 4}[kind]:
        raise BadInput(f"{what}: this Python has no 32-bit integers in arrays; install numpy", _NOTHING_SENT)
    count = 0
    try:
        for row in values:
            if width == 1:
                flat.append(row)
            else:
                before = len(flat)
                flat.extend(row)
                if len(flat) - before != width:
                    raise BadInput(f"row {count} of {what} has {len(flat) - before} numbers; wanted {width}", _NOTHING_SENT)
            count += 1
    except (TypeError, OverflowError) as cause:
        raise BadInput(f"row {count} of {what}: {cause}", _NOTHING_SENT) from cause
    return Numbers(flat, flat.buffer_info()[0], count, width)


def rows(values: Any, width: int, what: str, kind: str = "d") -> Numbers:
    """`values` as rows of `width` numbers; width 1: a row is a number."""
    if numpy is not None:
        try:
            return _from_numpy(values, width, what, kind)
        except (TypeError, ValueError) as cause:
            if isinstance(cause, BadInput):
                raise
            raise BadInput(f"{what}: {cause}", _NOTHING_SENT) from cause
    return _from_sequence(values, width, what, kind)


def same_length(first: Numbers, name: str, second: Numbers | None, other: str) -> None:
    """Refuses arrays of different lengths, which C would read past their ends."""
    if second is not None and first.count != second.count:
        raise BadInput(f"{first.count} {name} but {second.count} {other}", _NOTHING_SENT)


def one_or_many(value: Any, what: str) -> Column:
    """One number for all rows, or one for each."""
    if isinstance(value, (int, float)) or (numpy is not None and getattr(value, "ndim", None) == 0):
        return (float(value),)
    return rows(value, 1, what)


def joined(**columns: Column) -> Numbers:
    """Joins columns into the rows of one array. The first has numbers for each row."""
    (name, first), *others = columns.items()
    assert isinstance(first, Numbers)
    for other, column in others:
        same_length(first, name, column if isinstance(column, Numbers) else None, other)
    parts = [(column.kept, column.width) if isinstance(column, Numbers) else (column, 0) for column in columns.values()]
    width = sum(own or len(values) for values, own in parts)
    return _joined_by_numpy(parts, first.count, width) if numpy is not None else _joined_lists(parts, first.count, width)


def _joined_by_numpy(parts: list[tuple[Any, int]], count: int, width: int) -> Numbers:
    table, at = numpy.empty((count, width)), 0
    for values, own in parts:
        after = at + (own or len(values))
        table[:, at:after] = values.reshape(-1, own) if own else values
        at = after
    return Numbers(table, table.ctypes.data, count, width)


def _joined_lists(parts: list[tuple[Any, int]], count: int, width: int) -> Numbers:
    table, at = array.array("d", bytes(8 * width * count)), 0
    for values, own in parts:
        for i in range(own or len(values)):
            table[at::width] = values[i::own] if own else array.array("d", [values[i]]) * count
            at += 1
    return Numbers(table, table.buffer_info()[0], count, width)


def vector(values: Any, width: int, what: str) -> Any:
    """`width` numbers as a C array."""
    try:
        listed = [float(value) for value in values]
    except (TypeError, ValueError) as cause:
        raise BadInput(f"{what}: {cause}", _NOTHING_SENT) from cause
    if len(listed) != width:
        raise BadInput(f"{what} has {len(listed)} numbers; wanted {width}", _NOTHING_SENT)
    return (ctypes.c_double * width)(*listed)
