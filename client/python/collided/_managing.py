"""The calls of a Client about scenes, objects, rules and probes."""

from __future__ import annotations

import math
from typing import Any, Sequence

from . import _numbers
from ._commands import Commanding
from ._described import read
from ._numbers import Row
from ._schema import Cleared, ListedRule, Loaded, ObjectDetails, ObjectList, Plan, ProbeReading


class Managing(Commanding):
    """The calls of a Client about scenes, objects, rules and probes."""

    def load(
        self,
        path: str,
        timeout: float = 600.0,
        *,
        name: str = "",
        unit: float = 1.0,
        up: str = "",
        radius: float = 0.0,
        strict: bool = False,
        mend: bool = False,
        crack: float = 0.0,
        srdf: str = "",
        packages: Sequence[str] = (),
        replace: bool = False,
        moving: bool = False,
        solid: str = "",
        solid_by: str = "",
        covers: Sequence[Sequence[float]] = (),
    ) -> Loaded:
        """Loads a file that the server can read, as a scene: a mesh, a cloud, a table of boxes or a robot (.urdf).

        name      of the scene; empty: the file's name without its extension
        unit      metres: the length of the file's unit
        up        the file's axis that points up, "y" or "z"; empty: that of the format, or z
        radius    metres: of the balls about the points of a cloud
        strict    refuses faults that would otherwise be mended
        mend      cuts edges at T-vertices and closes cracks
        crack     metres: the widest crack to close; 0: a ten-thousandth of the diagonal
        srdf      for a robot: path, on the server, of the file that lists the links that may touch
        packages  for a robot: entries "NAME=DIR", the folder on the server of a package that its file refers to
        replace   replaces the scene of that name
        moving    its objects can be moved, by move() or by a publisher that claims them
        solid     name glob of the parts and objects whose meshes are solid; empty: none
        solid_by  "winding": those that do not close are solid by their winding number; empty: they stay surfaces
        covers    boxes (low x, y, z, high x, y, z) in which the geometry is complete; a side may be infinite"""
        arguments: dict[str, Any] = {
            "name": name, "unit_m": unit, "up": up, "radius_m": radius, "strict": strict, "mend": mend, "crack_m": crack,
            "srdf": srdf, "replace": replace,
        }
        # An older server refuses unknown arguments.
        boxes = [[side if math.isfinite(side) else str(side) for side in map(float, box)] for box in covers]
        meant = {"packages": list(packages), "moving": moving, "solid": solid, "solid_by": solid_by, "covers": boxes}
        arguments.update({key: value for key, value in meant.items() if value})
        return read(Loaded, self.command("load", timeout=timeout, path=path, **arguments))

    def clear(self, scene: str = "", *, moving: bool = False, timeout: float = 10.0) -> Cleared:
        """Removes scenes, moving objects, or both. Objects of living publishers stay.

        scene   only this scene; empty: all
        moving  also moving objects; without a scene only those"""
        return read(Cleared, self.command("clear", timeout=timeout, scene=scene, moving=moving))

    def list(
        self, name: str = "", *, moving: bool | None = None, limit: int = 10_000, timeout: float = 10.0
    ) -> ObjectList:
        """The objects in brief, and their number.

        name    name or glob; empty: all
        moving  True: only objects that move; False: only those that do not
        limit   maximum number of objects returned, up to 1,000,000"""
        return read(ObjectList, self.command("list", timeout=timeout, name=name, moving=moving, limit=limit))

    def get(self, name: str, *, timeout: float = 10.0) -> ObjectDetails:
        """One object in full."""
        return read(ObjectDetails, self.command("get", timeout=timeout, name=name))

    def rules(self, *, timeout: float = 10.0) -> tuple[ListedRule, ...]:
        """The rules about which pairs may touch (allow, deny), in order; the last one that matches a pair decides."""
        return tuple(read(ListedRule, row) for row in self.command("allowed", timeout=timeout)["rules"])

    def plan(self, *, timeout: float = 10.0) -> Plan:
        """Which index structures the server has built for its world, which it has left out, and why."""
        return read(Plan, self.command("plan", timeout=timeout))

    def add_probe(
        self,
        name: str,
        object: str,
        origin: Row = (0.0, 0.0, 0.0),
        direction: Row = (0.0, 0.0, -1.0),
        *,
        reach: float = 10.0,
        back: float = 1.0,
    ) -> None:
        """Adds a ray that is fixed to an object, or replaces the one of that name. It stays until it is removed.

        object             name of the object that carries it, which need not exist yet
        origin, direction  in the object's frame; the direction has any length but 0
        reach              metres ahead of the origin, may be infinite
        back               metres behind the origin"""
        arguments: dict[str, Any] = {
            "origin": list(_numbers.vector(origin, 3, "origin")), "direction": list(_numbers.vector(direction, 3, "direction")),
            "back_m": back,
        }
        if reach != math.inf:
            arguments["reach_m"] = reach
        self.command("probe", name=name, object=object, **arguments)

    def remove_probes(self, name: str) -> int:
        """Removes probes by name or glob, and returns how many there were."""
        return len(self.command("probe", name=name, remove=True)["probes"])

    def probes(self, name: str = "") -> tuple[ProbeReading, ...]:
        """The readings, in the newest state, of the probes whose names match the glob; empty: of all."""
        return tuple(read(ProbeReading, row) for row in self.command("probes", name=name)["probes"])
