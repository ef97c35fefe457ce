"""The questions that a Client asks: rays, spheres, boxes, nearest points, points in solids, sweeps, and what if."""

from __future__ import annotations

import ctypes
import math
from typing import Any, Sequence

from . import _numbers
from ._answers import Answer, Answers
from ._commands import Commanding
from ._contract import HIT_MODE, IMPORTANCE, INSTANT_KIND
from ._errors import BadInput
from ._library import as_json, call, code_of, encoded, library, nanoseconds, number
from ._numbers import Row, Rows
from ._shapes import Parts, Shape
from ._structs import ASK_BOXES, ASK_INSIDE, ASK_NEAREST, ASK_RAYS, ASK_SPHERES, ASK_SWEEPS, CAskOptions


def _set_instant(options: CAskOptions, as_of: str | int) -> None:
    if as_of == "latest":
        return
    if as_of == "settled":
        options.instant = INSTANT_KIND.index("settled")
    elif isinstance(as_of, int) and not isinstance(as_of, bool):
        options.instant, options.instant_ns = INSTANT_KIND.index("at" if as_of >= 0 else "back"), abs(as_of)
    else:
        raise BadInput(
            f"as_of is {as_of!r}; known are 'latest', 'settled', nanoseconds since 1970, and minus the nanoseconds before now",
            "nothing was sent",
        )


def _ask_options(
    mode: str = "closest",
    only: str = "",
    skip: str = "",
    mask: int = 0xFFFFFFFF,
    max_hits: int | None = None,
    error: float = 0.0,
    deadline: float = 0.0,
    timeout: float = 2.0,
    fresh: bool = False,
    as_of: str | int = "latest",
    importance: str = "normal",
) -> CAskOptions:
    options = CAskOptions()
    library.collided_ask_defaults(ctypes.byref(options), ctypes.sizeof(CAskOptions))
    options.mode = code_of(mode, HIT_MODE, "mode")
    options.importance = code_of(importance, IMPORTANCE, "importance")
    options.only = encoded(only, "only")
    options.skip = encoded(skip, "skip")
    if not 0 <= mask <= 0xFFFFFFFF:
        raise BadInput(f"mask is {mask}; allowed are 0 to 4294967295", "nothing was sent")
    options.mask = mask
    if max_hits is not None:
        if not 1 <= max_hits <= 0xFFFFFFFF:
            raise BadInput(f"max_hits is {max_hits}; allowed from 1 on", "nothing was sent")
        options.max_hits = max_hits
    options.error_m = error
    options.deadline_ns = nanoseconds(deadline, "deadline")
    options.timeout_ns = nanoseconds(timeout, "timeout")
    if options.timeout_ns == 0:
        raise BadInput("timeout is 0 s; allowed above 0", "nothing was sent")
    options.fresh = 1 if fresh else 0
    _set_instant(options, as_of)
    return options


class Asking(Commanding):
    """The questions of a Client; help(Client) explains their keywords."""

    def _ask(
        self, name: str, kind: int, rows: _numbers.Numbers, keywords: dict[str, Any], parts: Parts | None = None
    ) -> Answers:
        out = keywords.pop("out", None)
        try:
            options = _ask_options(**keywords)
        except TypeError as cause:
            raise BadInput(str(cause).replace("_ask_options()", name), "help(collided.Client) lists the keywords") from None
        if parts is not None:
            options.shape, options.shape_parts = parts.array, parts.count
        answers: Answers = Answers() if out is None else out
        kept = answers._empty()
        call("ask", self._handle, kind, rows.pointer, rows.count, ctypes.byref(options), ctypes.byref(kept))
        answers._refill()
        return answers

    def rays(self, origins: Rows, directions: Rows, lengths: Rows | Row | float | None = None, **options: Any) -> Answers:
        """What do rays hit? origins and directions (n, 3), directions of any length but 0; lengths (n,) or one number in
        metres, None: unlimited. 1 to 100,000 rays."""
        rows = _numbers.joined(
            origins=_numbers.rows(origins, 3, "origins"),
            directions=_numbers.rows(directions, 3, "directions"),
            lengths=_numbers.one_or_many(math.inf if lengths is None else lengths, "lengths"),
        )
        return self._ask("rays", ASK_RAYS, rows, options)

    def spheres(self, centers: Rows, radii: Rows | Row | float, **options: Any) -> Answers:
        """What touches spheres, and how deep? centers (n, 3); radii (n,) or one number."""
        rows = _numbers.joined(centers=_numbers.rows(centers, 3, "centers"), radii=_numbers.one_or_many(radii, "radii"))
        return self._ask("spheres", ASK_SPHERES, rows, options)

    def boxes(self, centers: Rows, half: Rows, orientations: Rows | None = None, **options: Any) -> Answers:
        """What touches boxes, and how deep? centers and half edges (n, 3); orientations (n, 4), w first, from each box's
        axes to the world."""
        rows = _numbers.joined(
            centers=_numbers.rows(centers, 3, "centers"),
            halves=_numbers.rows(half, 3, "half"),
            orientations=(1.0, 0.0, 0.0, 0.0) if orientations is None else _numbers.rows(orientations, 4, "orientations"),
        )
        return self._ask("boxes", ASK_BOXES, rows, options)

    def nearest(self, points: Rows, within: Rows | Row | float | None = None, **options: Any) -> Answers:
        """Which objects are nearest to points? points (n, 3); within (n,) or one number: the largest distance, None:
        unlimited; max_hits: number of objects, 1 by default."""
        reach = _numbers.one_or_many(math.inf if within is None else within, "within")
        rows = _numbers.joined(points=_numbers.rows(points, 3, "points"), within=reach)
        return self._ask("nearest", ASK_NEAREST, rows, options)

    def inside(self, points: Rows, **options: Any) -> Answers:
        """Which solids contain points? points (n, 3). Primitives, hulls and declared meshes are solid; the distance of a
        hit is the depth below the surface."""
        return self._ask("inside", ASK_INSIDE, _numbers.rows(points, 3, "points"), options)

    def sweep(self, shape: Shape | Sequence[Shape], starts: Rows, ends: Rows, **options: Any) -> Answers:
        """What does a shape meet first on each of 1 to 100,000 motions, while everything else stays? starts and ends (n, 7):
        poses, x y z, then w x y z. It goes straight and turns evenly while time runs from 0 to 1; a hit has the time
        (time_low, time_high), and a miss means that the motion is free."""
        rows = _numbers.joined(starts=_numbers.rows(starts, 7, "starts"), ends=_numbers.rows(ends, 7, "ends"))
        return self._ask("sweep", ASK_SWEEPS, rows, options, Parts(shape))

    def ray(self, origin: Row, direction: Row, length: float = math.inf, **options: Any) -> Answer:
        """What does one ray hit?"""
        return self.rays([list(origin)], [list(direction)], [length], **options)[0]  # type: ignore[arg-type]

    def sphere(self, center: Row, radius: float, **options: Any) -> Answer:
        """What touches one sphere?"""
        return self.spheres([list(center)], [radius], **options)[0]  # type: ignore[arg-type]

    def what_if(
        self,
        objects: Sequence[str],
        poses: Rows,
        against: str = "",
        *,
        clearance: bool = False,
        nearer: float = math.inf,
        with_filtered: bool = False,
        attached: Sequence[tuple[str, str]] = (),
        timeout: float = 60.0,
        **options: Any,
    ) -> Answers:
        """Would configurations be free of contact? Nothing is moved. A miss means free.

        objects        names of the moved objects
        poses          (n * len(objects), 7) or (n, len(objects), 7): x y z, then w x y z; each configuration has one for
                       each object, in order
        against        an object, a scene or a glob; "": everything else
        clearance      an answer's distance is its least clearance, negative for a contact, and `object` is the moved
                       object; hits() has both objects of the pair. Without it: the names of the first contact found
        nearer         metres; with clearance: pairs certainly farther apart are ignored
        with_filtered  also test pairs that masks and groups exclude
        attached       pairs (name, name of the object that it moves with)
        skip, mask, deadline, as_of, importance, fresh: as for other questions"""
        if _numbers.numpy is not None and getattr(poses, "ndim", 2) == 3:
            poses = _numbers.numpy.asarray(poses).reshape(-1, 7)
        numbers = _numbers.rows(poses, 7, "poses")
        count, left_over = divmod(numbers.count, max(1, len(objects)))
        if left_over:
            raise BadInput(f"{numbers.count} poses for {len(objects)} objects", "each configuration has one for each")
        asked = _ask_options(mode="closest" if clearance else "any", only=against, timeout=timeout, **options)
        imagined = {
            "objects": list(objects), "attached": [list(pair) for pair in attached], "nearer": number(nearer),
            "with_filtered": bool(with_filtered),
        }
        answers = Answers()
        kept = answers._empty()
        words = as_json(imagined, "what_if"), numbers.pointer, count
        call("what_if", self._handle, *words, ctypes.byref(asked), ctypes.byref(kept))
        answers._refill()
        return answers
