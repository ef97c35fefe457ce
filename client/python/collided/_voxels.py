"""Live obstacles from scans: cells that are occupied, free or unknown."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from . import _numbers
from ._contract import LOST_POLICY, UNKNOWN_CELLS
from ._described import read
from ._library import Owned, as_json, call, call_for_text, code_of, encoded, nanoseconds, number
from ._numbers import Row, Rows
from ._schema import VoxelScan

if TYPE_CHECKING:
    from ._publisher import Publisher


class Voxels(Owned):
    """A grid of cells in the world, made by Publisher.voxels(). Its objects live as long as the publisher."""

    _what = "the grid of voxels"

    def __init__(
        self, publisher: Publisher, name: str, cell: float, unknown: str, decay: float, reach: float, layers: int, lost: str,
        most_blocks: int, clearing_delay: float,
    ) -> None:
        code_of(unknown, UNKNOWN_CELLS, "unknown")
        code_of(lost, LOST_POLICY, "lost")
        options = {
            "cell": cell, "unknown": unknown, "decay_ns": nanoseconds(decay, "decay"), "reach": number(reach), "layers": layers,
            "lost": lost, "most_blocks": most_blocks, "clearing_delay_ns": nanoseconds(clearing_delay, "clearing_delay"),
        }
        words = encoded(name, "the name"), as_json(options, "voxels")
        handle = ctypes.c_void_p()
        call("voxels_start", publisher._handle, *words, ctypes.byref(handle))
        super().__init__(handle, "voxels_close")
        self._publisher = publisher

    def _inserted(self, points: _numbers.Numbers | None, is_single: bool, origin: Any, time_ns: int) -> VoxelScan:
        _ = self._publisher._handle  # refuses a closed publisher, which the library must not use
        count, pointer = (0, None) if points is None else (points.count, points.pointer)
        arrays = (None, pointer) if is_single else (pointer, None)
        return read(VoxelScan, call_for_text("voxels_insert", self._handle, count, *arrays, origin, time_ns))

    def insert(self, points: Rows, origin: Row | None = None, *, time_ns: int = 0) -> VoxelScan:
        """Inserts a scan and publishes the changes. points: (n, 3), metres, in the world; float32 and float64 are not
        copied. origin: of the sensor: the space between it and each point becomes free. time_ns: for decay (0: now)."""
        given = _numbers.numpy.asarray(points) if _numbers.numpy is not None else points
        is_single = getattr(given, "dtype", None) == "float32"
        taken = _numbers.rows(given, 3, "points", "f" if is_single else "d")
        start = None if origin is None else _numbers.vector(origin, 3, "origin")
        return self._inserted(taken, is_single, start, time_ns)

    def decay(self, *, time_ns: int = 0) -> int:
        """Makes cells unknown that no scan has met for the decay time; insert() does so too. Returns the number of changed
        blocks."""
        return self._inserted(None, False, None, time_ns).changed

    def clear(self) -> None:
        """Makes all cells unknown."""
        _ = self._publisher._handle
        call("voxels_clear", self._handle)
