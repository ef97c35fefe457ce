"""A source of objects and their poses."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Sequence

from . import _numbers, _voxels
from ._contract import LOST_POLICY
from ._library import Owned, call, code_of, encoded, library, nanoseconds, text
from ._numbers import Row, Rows
from ._shapes import Shape, Solid, encode_object
from ._structs import CReport
from ._voxels import Voxels


@dataclass(frozen=True)
class PublisherReport:
    """What the server has not taken as it was published."""

    refused: str  #: why the server takes nothing of this publisher; empty: it does
    left_out: list[tuple[str, str]]  #: objects that are not in the world as they were defined, and why; at most 20
    left_out_count: int  #: all of them
    merged_poses: int  #: poses that newer ones replaced, since the server had more than it could apply


class Publisher(Owned):
    """Objects live as long as their publisher, unless removed earlier. move() collects poses, flush() sends them.

    Only calls show the server that it is alive: after 500 ms without one (its lease) it counts as lost. Its objects are then
    stale, and leave some seconds later as each object's `lost` says. The next call brings everything back, and flush()
    warns of the loss.
    """

    _what = "the publisher"

    def __init__(self, handle: ctypes.c_void_p) -> None:
        super().__init__(handle, "publisher_close")

    def add(
        self,
        name: str,
        shape: Shape | Sequence[Shape],
        position: Row = (0.0, 0.0, 0.0),
        orientation: Row = (1.0, 0.0, 0.0, 0.0),
        *,
        scale: Row = (1.0, 1.0, 1.0),
        layers: int = 1,
        mask: int = 0xFFFFFFFF,
        group: int = 0,
        moving: bool = True,
        lost: str = "remove",
        solid: Solid = False,
    ) -> int:
        """Defines an object and returns its handle. lost: "remove", "freeze" or "hold". solid: its mesh is closed and
        holds what lies in it; wait_applied() tells where it is refused. "winding": a mesh that does not close is solid by
        its winding number."""
        made = encode_object(name, shape, position, orientation, scale, layers, mask, group, moving, lost, solid)
        handle = ctypes.c_uint32()
        call("publisher_add", self._handle, ctypes.byref(made.value), ctypes.byref(handle))
        return handle.value

    def remove(self, handle: int) -> None:
        """Takes an object out of the world."""
        call("publisher_remove", self._handle, handle)

    def claim(
        self, name: str, position: Row, orientation: Row = (1.0, 0.0, 0.0, 0.0), *, lost: str = "remove"
    ) -> int:
        """Takes over an object that is in the world and has no living publisher; its shape stays. Returns its handle.
        It goes back there instead of being removed."""
        at = _numbers.vector(position, 3, "position")
        turned = _numbers.vector(orientation, 4, "orientation")
        handle = ctypes.c_uint32()
        policy = code_of(lost, LOST_POLICY, "lost")
        call("publisher_claim", self._handle, encoded(name, "the name"), at, turned, policy, ctypes.byref(handle))
        return handle.value

    def move(self, handle: int, position: Row, orientation: Row | None = None, *, teleport: bool = False) -> None:
        """The newest pose of an object. Contacts on the way from its last pose count, unless it is teleported."""
        handles = (ctypes.c_uint32 * 1)(handle)
        at = _numbers.vector(position, 3, "position")
        turned = None if orientation is None else _numbers.vector(orientation, 4, "orientation")
        call("publisher_move", self._handle, 1, handles, at, turned, int(teleport))

    def move_many(
        self, handles: Rows | Sequence[int], positions: Rows, orientations: Rows | None = None, *, teleport: bool = False
    ) -> None:
        """The same for many: handles (n,), positions (n, 3), orientations (n, 4)."""
        numbers = _numbers.rows(handles, 1, "handles", "I")
        at = _numbers.rows(positions, 3, "positions")
        turned = None if orientations is None else _numbers.rows(orientations, 4, "orientations")
        _numbers.same_length(numbers, "handles", at, "positions")
        _numbers.same_length(numbers, "handles", turned, "orientations")
        pointer = None if turned is None else turned.pointer
        call("publisher_move", self._handle, numbers.count, numbers.pointer, at.pointer, pointer, int(teleport))

    def flush(self, source_time_ns: int = 0) -> int:
        """Sends what was moved, and says that what was not moved has rested until then (0: now). Returns the number of
        the last message. Warns (RuntimeWarning) if the server had counted this publisher as lost since the last flush."""
        sequence = ctypes.c_uint64()
        call("publisher_flush", self._handle, source_time_ns, ctypes.byref(sequence))
        return sequence.value

    def wait_applied(self, timeout: float = 10.0) -> None:
        """Waits until the server has applied everything sent so far."""
        call("publisher_wait_applied", self._handle, nanoseconds(timeout, "timeout"))

    def report(self, timeout: float = 10.0) -> PublisherReport:
        """Asks the server what it has not taken; after wait_applied() that counts everything sent before."""
        told = CReport(size=ctypes.sizeof(CReport))
        call("publisher_report", self._handle, nanoseconds(timeout, "timeout"), ctypes.byref(told))
        left_out = [(text(told.names[i]), text(told.reasons[i])) for i in range(told.name_count)]
        return PublisherReport(text(told.refused), left_out, told.left_out_count, told.merged_poses)

    def keep_alive(self, source_time_ns: int = 0) -> None:
        """Shows the server that this publisher is alive, and says nothing about its objects: flush() says that what was
        not moved has rested. source_time_ns: the publisher's time now, for one that gives flush() its own times."""
        call("publisher_keep_alive_at", self._handle, source_time_ns)

    def stream(self) -> None:
        """From now on a flush says nothing about objects that were not moved: each moves between its own poses."""
        library.collided_publisher_stream(self._handle)

    def voxels(
        self,
        name: str,
        cell: float = 0.05,
        *,
        unknown: str = "free",
        decay: float = 0.0,
        reach: float = float("inf"),
        layers: int = 1,
        lost: str = "freeze",
        most_blocks: int = 32_768,
    ) -> Voxels:
        """A grid of cells of this side that scans make occupied or free. unknown: what the other cells are, "free",
        "undecided" (a question that reaches into them is undecided, with the reason not_covered) or "occupied". decay:
        seconds after which a cell that no scan has met is unknown again (0: never). reach: points farther from their
        scan's origin do not count. most_blocks: of 16 x 16 x 16 cells that may be in use."""
        return _voxels.start(self, name, cell, unknown, decay, reach, layers, lost, most_blocks)

    def __enter__(self) -> Publisher:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
