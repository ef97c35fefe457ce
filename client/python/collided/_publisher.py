"""A source of objects and their poses."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from types import MappingProxyType
from typing import Mapping, Sequence

from . import _numbers
from ._contract import LOST_POLICY
from ._described import read
from ._library import Owned, as_json, call, call_for_text, code_of, encoded, library, nanoseconds
from ._numbers import Row, Rows
from ._robot import PublishedRobot
from ._shapes import Parts, Shape, Solid, as_object, pose
from ._voxels import Voxels


@dataclass(frozen=True)
class PublisherReport:
    """The objects and poses that the server did not apply as published."""

    refused: str  #: why the server accepts nothing from this publisher; empty: it does
    left_out: list[tuple[str, str]]  #: objects that are not in the world as defined, and why; at most 20
    left_out_count: int  #: number of all such objects
    merged_poses: int  #: poses that newer ones replaced, since the server had more than it could apply


class Publisher(Owned):
    """Objects live as long as their publisher, unless removed earlier. move() collects poses, flush() sends them.

    Only calls renew its lease: after 500 ms without one it counts as lost. Its objects are then stale, and some seconds
    later the server applies each object's `lost`. The next call restores everything, and flush() warns of the loss.
    """

    _what = "the publisher"

    def __init__(self, client: ctypes.c_void_p, name: str, lease: float, gap: float) -> None:
        handle = ctypes.c_void_p()
        options = {"lease_ns": nanoseconds(lease, "lease"), "gap_ns": nanoseconds(gap, "gap")}
        words = encoded(name, "the publisher's name"), as_json(options, "publish")
        call("publish", client, *words, ctypes.byref(handle))
        super().__init__(handle, "publisher_close")
        self._client = client

    def _defined(self, described: dict[str, object], lost: str, parts: Parts | None) -> int:
        code_of(lost, LOST_POLICY, "lost")
        handle = ctypes.c_uint32()
        array, count = (None, 0) if parts is None else (parts.array, parts.count)
        call("publisher_add", self._handle, as_json({**described, "lost": lost}, "add"), array, count, ctypes.byref(handle))
        return handle.value

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
        unknown: bool = False,
    ) -> int:
        """Defines an object and returns its handle. lost: "remove", "freeze" or "hold". solid: its mesh bounds a
        solid; wait_applied() raises if it is refused. "winding": a mesh that does not close is solid by its winding
        number. unknown: the content of the shape is unknown: it touches nothing, and a question that reaches into it is
        undecided, with the reason not_covered."""
        described = as_object(name, position, orientation, scale, layers, mask, group, moving, solid)
        return self._defined({**described, "unknown": bool(unknown)}, lost, Parts(shape))

    def remove(self, handle: int) -> None:
        """Removes an object from the world."""
        call("publisher_remove", self._handle, handle)

    def claim(
        self, name: str, position: Row, orientation: Row = (1.0, 0.0, 0.0, 0.0), *, lost: str = "remove"
    ) -> int:
        """Claims an existing object that has no living publisher; its shape stays. Returns its handle. It is released
        where it stands instead of being removed."""
        return self._defined({"claim": True, "name": name, "pose": pose(position, orientation)}, lost, None)

    def move(self, handle: int, position: Row, orientation: Row | None = None, *, teleport: bool = False) -> None:
        """Sets the newest pose of an object. Contacts on the path from its last pose count, unless it is teleported."""
        handles = (ctypes.c_uint32 * 1)(handle)
        at = _numbers.vector(position, 3, "position")
        turned = None if orientation is None else _numbers.vector(orientation, 4, "orientation")
        call("publisher_move", self._handle, 1, handles, at, turned, int(teleport))

    def move_many(
        self, handles: Rows | Sequence[int], positions: Rows, orientations: Rows | None = None, *, teleport: bool = False
    ) -> None:
        """Sets the poses of many: handles (n,), positions (n, 3), orientations (n, 4)."""
        numbers = _numbers.rows(handles, 1, "handles", "I")
        at = _numbers.rows(positions, 3, "positions")
        turned = None if orientations is None else _numbers.rows(orientations, 4, "orientations")
        _numbers.same_length(numbers, "handles", at, "positions")
        _numbers.same_length(numbers, "handles", turned, "orientations")
        pointer = None if turned is None else turned.pointer
        call("publisher_move", self._handle, numbers.count, numbers.pointer, at.pointer, pointer, int(teleport))

    def flush(self, source_time_ns: int = 0) -> int:
        """Sends the collected poses, and states that all other objects have been at rest until then (0: now). Returns the
        number of the last message. Warns (RuntimeWarning) if the server had counted this publisher as lost meanwhile."""
        sequence = ctypes.c_uint64()
        call("publisher_flush", self._handle, source_time_ns, ctypes.byref(sequence))
        return sequence.value

    def wait_applied(self, timeout: float = 10.0) -> None:
        """Waits until the server has applied everything sent so far."""
        call("publisher_wait_applied", self._handle, nanoseconds(timeout, "timeout"))

    def report(self, timeout: float = 10.0) -> PublisherReport:
        """Asks the server what it did not apply; after wait_applied() that covers everything sent before."""
        return read(PublisherReport, call_for_text("publisher_report", self._handle, nanoseconds(timeout, "timeout")))

    def keep_alive(self, source_time_ns: int = 0) -> None:
        """Renews the lease without stating, as flush() does, that objects have been at rest. source_time_ns: the
        publisher's current time, if it passes its own times to flush()."""
        call("publisher_keep_alive", self._handle, source_time_ns)

    def stream(self) -> None:
        """From now on a flush states nothing about objects that were not moved: each moves between its own poses."""
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
        clearing_delay: float = 0.5,
    ) -> Voxels:
        """Makes a grid of cells of this side that scans mark as occupied or free. unknown: how other cells count, "free",
        "undecided" (a question that reaches into them is undecided, with the reason not_covered) or "occupied". decay:
        seconds after which a cell that no scan has met becomes unknown (0: never). reach: points farther from their
        scan's origin are ignored. most_blocks: maximum number of blocks of 16 x 16 x 16 cells. clearing_delay: minimum
        seconds between two updates of a block in which cells have only become free."""
        return Voxels(self, name, cell, unknown, decay, reach, layers, lost, most_blocks, clearing_delay)

    def robot(
        self,
        urdf: str,
        *,
        scene: str = "",
        position: Row = (0.0, 0.0, 0.0),
        orientation: Row = (1.0, 0.0, 0.0, 0.0),
        joints: Mapping[str, float] = MappingProxyType({}),
        beyond_limits: bool = False,
        lost: str = "freeze",
    ) -> PublishedRobot:
        """Claims the links of a robot that was loaded with moving=True, and places them. urdf: path of its file, on this
        machine. scene: the scene as which it was loaded; empty: the robot's name. position, orientation: of its root
        link. joints: their positions in radians or metres; joints that are not named are at 0. beyond_limits: accept
        positions beyond the joints' limits. lost: "freeze", "hold", or "remove": the links are released where they
        stand."""
        code_of(lost, LOST_POLICY, "lost")
        options = {"urdf": urdf, "scene": scene, "base": pose(position, orientation), "joints": list(joints.items())}
        return PublishedRobot(self._client, self, {**options, "beyond_limits": beyond_limits, "lost": lost})
