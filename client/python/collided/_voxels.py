"""Live obstacles from scans: cells that are occupied, free or unknown."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from . import _numbers
from ._contract import LOST_POLICY, UNKNOWN_CELLS
from ._described import read, row_of
from ._library import Owned, call, code_of, encoded, library, nanoseconds
from ._numbers import Row, Rows
from ._schema import VoxelScan
from ._structs import CVoxelScan, CVoxelOptions

if TYPE_CHECKING:
    from ._publisher import Publisher


class Voxels(Owned):
    """A grid of cells in the world, made by Publisher.voxels(). Its objects live as long as the publisher."""

    _what = "the grid of voxels"

    def __init__(self, handle: ctypes.c_void_p, publisher: Publisher) -> None:
        super().__init__(handle, "voxels_close")
        self._publisher = publisher

    def insert(self, points: Rows, origin: Row | None = None, *, time_ns: int = 0) -> VoxelScan:
        """Inserts a scan and publishes the changes. points: (n, 3), metres, in the world; float32 and float64 are not
        copied. origin: the sensor's; with it the space up to each point becomes free. time_ns: for decay (0: now)."""
        _ = self._publisher._handle  # refuses a closed publisher, which the library must not use
        given = _numbers.numpy.asarray(points) if _numbers.numpy is not None else points
        is_single = getattr(given, "dtype", None) == "float32"
        taken = _numbers.rows(given, 3, "points", "f" if is_single else "d")
        start: Any = None if origin is None else _numbers.vector(origin, 3, "origin")
        scan = CVoxelScan(size=ctypes.sizeof(CVoxelScan))
        name = "voxels_insert_floats" if is_single else "voxels_insert"
        call(name, self._handle, taken.count, taken.pointer, start, time_ns, ctypes.byref(scan))
        return read(VoxelScan, {"far": scan.far_off, **row_of(scan)})

    def decay(self, *, time_ns: int = 0) -> int:
        """Makes cells unknown that no scan has met for the time of decay, as insert() does too. Returns the number of changed
        blocks."""
        _ = self._publisher._handle
        changed = ctypes.c_size_t()
        call("voxels_decay", self._handle, time_ns, ctypes.byref(changed))
        return changed.value

    def clear(self) -> None:
        """Makes all cells unknown."""
        _ = self._publisher._handle
        call("voxels_clear", self._handle)

    def __enter__(self) -> Voxels:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def start(
    publisher: Publisher,
    name: str,
    cell: float,
    unknown: str,
    decay: float,
    reach: float,
    layers: int,
    lost: str,
    most_blocks: int,
) -> Voxels:
    """A grid of this publisher; see Publisher.voxels()."""
    options = CVoxelOptions()
    library.collided_voxel_defaults(ctypes.byref(options), ctypes.sizeof(options))
    options.cell_m, options.reach_m, options.layers, options.most_blocks = cell, reach, layers, most_blocks
    options.unknown, options.lost_policy = code_of(unknown, UNKNOWN_CELLS, "unknown"), code_of(lost, LOST_POLICY, "lost")
    options.decay_ns = nanoseconds(decay, "decay")
    handle = ctypes.c_void_p()
    call("voxels_start", publisher._handle, encoded(name, "the name"), ctypes.byref(options), ctypes.byref(handle))
    return Voxels(handle, publisher)
