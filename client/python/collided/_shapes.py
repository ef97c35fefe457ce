"""Shapes of objects. Metres, in the object's own frame."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, Literal, Sequence, Union

from . import _numbers, _structs
from ._errors import BadInput
from ._numbers import Row, Rows
from ._structs import CPart

#: Whether a mesh bounds a solid. True: refused if it does not close; "winding": it is then solid by its winding number.
Solid = Union[bool, Literal["winding"]]

_ORIGIN = (0.0, 0.0, 0.0)
_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Sphere:
    """A ball."""

    radius: float
    center: Row = _ORIGIN


@dataclass(frozen=True)
class Box:
    """half: half of each edge, along the box's own axes."""

    half: Row
    center: Row = _ORIGIN
    orientation: Row = _UPRIGHT  # w, x, y, z: from the box's axes to the object's frame


@dataclass(frozen=True)
class Capsule:
    """All points within radius of the segment from a to b."""

    a: Row
    b: Row
    radius: float


@dataclass(frozen=True)
class Cylinder:
    """A capsule cut flat at a and b."""

    a: Row
    b: Row
    radius: float


@dataclass(frozen=True)
class Cone:
    """The base is a disc of that radius about `base`, perpendicular to the axis from the apex."""

    apex: Row
    base: Row
    radius: float


@dataclass(frozen=True)
class Ellipsoid:
    """half: half axes, each above 0."""

    half: Row
    center: Row = _ORIGIN
    orientation: Row = _UPRIGHT


@dataclass(frozen=True)
class HalfSpace:
    """All points behind a plane: normal . (x - point) <= 0. Its object must not move."""

    normal: Row
    point: Row = _ORIGIN


@dataclass(frozen=True)
class Hull:
    """The convex hull of 4 to 4,096 points, (n, 3)."""

    points: Rows


@dataclass(frozen=True)
class Mesh:
    """A surface: vertices (n, 3) and triangles (m, 3) of vertex indices."""

    vertices: Rows
    triangles: Rows


@dataclass(frozen=True)
class HeightField:
    """Heights (rows, columns) over a grid that begins at the origin."""

    heights: Rows
    spacing_x: float = 1.0
    spacing_y: float = 1.0


@dataclass(frozen=True)
class Cloud:
    """A ball about each of many points, (n, 3)."""

    points: Rows
    radius: float


@dataclass(frozen=True)
class Polyline:
    """A capsule from each point, (n, 3), to the next."""

    points: Rows
    radius: float


Shape = Union[
    Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, HalfSpace, Hull, Mesh, HeightField, Cloud, Polyline
]


# The kinds of parts in C.
_KINDS = {
    Sphere: _structs.SPHERE,
    Box: _structs.BOX,
    Capsule: _structs.CAPSULE,
    Cylinder: _structs.CYLINDER,
    Cone: _structs.CONE,
    Ellipsoid: _structs.ELLIPSOID,
    HalfSpace: _structs.HALF_SPACE,
    Hull: _structs.HULL,
    Mesh: _structs.MESH,
    HeightField: _structs.HEIGHT_FIELD,
    Cloud: _structs.CLOUD,
    Polyline: _structs.POLYLINE,
}


def _numbers_of(part: Shape) -> list[float]:
    """The numbers of a part with a fixed count of numbers."""

    def three(values: Row, what: str) -> list[float]:
        return list(_numbers.vector(values, 3, what))

    if isinstance(part, Sphere):
        return [*three(part.center, "center"), float(part.radius)]
    if isinstance(part, (Box, Ellipsoid)):
        turned = list(_numbers.vector(part.orientation, 4, "orientation"))
        return [*three(part.half, "half"), *three(part.center, "center"), *turned]
    if isinstance(part, (Capsule, Cylinder)):
        return [*three(part.a, "a"), *three(part.b, "b"), float(part.radius)]
    if isinstance(part, Cone):
        return [*three(part.apex, "apex"), *three(part.base, "base"), float(part.radius)]
    if isinstance(part, HalfSpace):
        return [*three(part.normal, "normal"), *three(part.point, "point")]
    return [float(part.radius)] if isinstance(part, (Cloud, Polyline)) else []


def _encode_part(part: Shape, kept: list[Any]) -> CPart:
    if type(part) not in _KINDS:
        raise BadInput(f"{type(part).__name__} is no shape", "shapes are collided.Sphere, collided.Box and so on")
    encoded_part = CPart(size=ctypes.sizeof(CPart), kind=_KINDS[type(part)])
    points: _numbers.Numbers | None = None
    if isinstance(part, (Hull, Cloud, Polyline)):
        points = _numbers.rows(part.points, 3, "points")
    elif isinstance(part, Mesh):
        points = _numbers.rows(part.vertices, 3, "vertices")
        triangles = _numbers.rows(part.triangles, 3, "triangles", "I")
        kept.append(triangles)
        encoded_part.triangles, encoded_part.triangle_count = triangles.pointer, triangles.count
    elif isinstance(part, HeightField):
        heights: Sequence[Any] = part.heights  # type: ignore[assignment]
        columns = len(heights[0]) if len(heights) > 0 else 0
        encoded_part.numbers[0:3] = [columns, float(part.spacing_x), float(part.spacing_y)]
        points = _numbers.rows([value for row in heights for value in row], 1, "heights")
    numbers = _numbers_of(part)
    encoded_part.numbers[0 : len(numbers)] = numbers
    if points is not None:
        kept.append(points)
        encoded_part.points, encoded_part.point_count = points.pointer, points.count
    return encoded_part


class Parts:
    """The parts of a shape as an array for C, with the data that it points to."""

    def __init__(self, shape: Shape | Sequence[Shape]) -> None:
        listed: list[Shape] = list(shape) if isinstance(shape, (list, tuple)) else [shape]  # type: ignore[list-item]
        if not listed:
            raise BadInput("the shape has no part", "nothing was sent")
        self._kept: list[Any] = []
        self.array = (CPart * len(listed))(*[_encode_part(part, self._kept) for part in listed])
        self.count = len(listed)


def pose(position: Row, orientation: Row) -> list[float]:
    """A pose for JSON."""
    return [*_numbers.vector(position, 3, "position"), *_numbers.vector(orientation, 4, "orientation")]


def as_object(
    name: str, position: Row, orientation: Row, scale: Row, layers: int, mask: int, group: int, moving: bool, solid: Solid
) -> dict[str, Any]:
    """The arguments of the command `add`, without the shape."""
    if solid not in (True, False, "winding"):
        raise BadInput(f'solid is {solid!r}; known are True, False and "winding"', "nothing was sent")
    for value, what in ((layers, "layers"), (mask, "mask"), (group, "group")):
        if not 0 <= value <= 0xFFFFFFFF:
            raise BadInput(f"{what} is {value}; allowed are 0 to 4294967295", "nothing was sent")
    made: dict[str, Any] = {"name": name, "pose": pose(position, orientation), "scale": list(_numbers.vector(scale, 3, "scale"))}
    made.update(layers=layers, mask=mask, group=group, moving=bool(moving))
    if solid:
        made["solid"] = True
    if solid == "winding":
        made["solid_by"] = "winding"
    return made
