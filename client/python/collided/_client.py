"""The connection to one server."""

from __future__ import annotations

import ctypes
import json
import math
from dataclasses import dataclass
from typing import Any, Sequence

from . import _numbers
from ._answers import NO_TRIANGLE, REASONS, Answer, Answers, Verdict
from . import _fences
from ._fences import FenceWatch, MarginWatch, NearestWatch
from ._groups import Clearance, read_clearance
from ._library import (
    AskOptions,
    BadInput,
    ConnectOptions,
    CPairAnswer,
    CStatus,
    Owned,
    WatchOptions,
    call,
    encoded,
    library,
    nanoseconds,
)
from ._numbers import Row, Rows
from ._publisher import Publisher
from ._shapes import Shape, Solid, encode_object
from ._watch import Watch

_MODES = {"closest": 0, "any": 1, "all": 2}
_IMPORTANCES = {"normal": 0, "low": 1, "high": 2}


@dataclass(frozen=True)
class Status:
    """What the server said of itself last."""

    name_space: str
    version_text: str
    pid: int
    state: str  #: starting, recovering, ready or stopping
    epoch: int
    version: int
    world_time_ns: int
    static_triangles: int
    objects: int
    moving: int
    contacts: int
    contacts_truncated: bool
    poses_applied: int
    poses_dropped: int
    questions_answered: int
    questions_refused: int
    undecided_answers: int


@dataclass(frozen=True)
class PairAnswer:
    """How two objects stand to each other. As a truth value it is its verdict's: they touch, or they do not."""

    verdict: Verdict
    reason: str
    stale: bool
    contained: str  #: "a_in_b" or "b_in_a" where one lies within the other's closed mesh; else empty
    distance: float  #: of a miss; |truth - distance| <= error
    depth: float  #: of a hit; |truth - depth| <= error
    error: float
    normal: tuple[float, float, float]  #: unit, from a to b
    on_a: tuple[float, float, float]
    on_b: tuple[float, float, float]
    point: tuple[float, float, float]
    a_triangle: int | None
    b_triangle: int | None
    version: int

    def __bool__(self) -> bool:
        return bool(self.verdict)


def _triple(values: ctypes.Array[ctypes.c_double]) -> tuple[float, float, float]:
    return values[0], values[1], values[2]


def _chosen(value: str, known: dict[str, int], what: str) -> int:
    if value not in known:
        raise BadInput(f"{what} is {value!r}; known are {', '.join(known)}", "nothing was sent")
    return known[value]


def _set_instant(options: AskOptions, as_of: str | int) -> None:
    if as_of == "latest":
        return
    if as_of == "settled":
        options.instant = 1
    elif isinstance(as_of, int) and not isinstance(as_of, bool):
        options.instant, options.instant_ns = (2, as_of) if as_of >= 0 else (3, -as_of)
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
) -> AskOptions:
    options = AskOptions()
    library.collided_ask_defaults(ctypes.byref(options), ctypes.sizeof(AskOptions))
    options.mode = _chosen(mode, _MODES, "mode")
    options.importance = _chosen(importance, _IMPORTANCES, "importance")
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


class Client(Owned):
    """A connection to one server, made by connect(). Several threads may call at once.

    Questions take these keywords:
      mode        "closest" (default), "any" or "all": which hits of rays, spheres and boxes are wanted
      only, skip  name globs of objects that may answer, and that are left out
      mask        bits; objects with one of these layers may answer
      max_hits    of each question; beyond it hits are cut off and the answer is undecided (truncated)
      error       metres of error allowed in distances; 0: computed exactly where in doubt
      deadline    seconds on the server; answers after it are undecided; 0: none
      timeout     seconds that the call waits
      fresh       answer only after what this client itself wrote last is applied
      as_of       "latest" (default), "settled", nanoseconds since 1970, or minus nanoseconds before now
      importance  "normal", "low" or "high"
      out         Answers of an earlier call, whose memory is used again
    """

    _what = "the client"

    def __init__(self, handle: ctypes.c_void_p) -> None:
        super().__init__(handle, "close")

    def _ask(self, name: str, arrays: Sequence[_numbers.Numbers | None], count: int, keywords: dict[str, Any]) -> Answers:
        out = keywords.pop("out", None)
        try:
            options = _ask_options(**keywords)
        except TypeError as cause:
            raise BadInput(str(cause).replace("_ask_options()", name), "help(collided.Client) lists the keywords") from None
        answers: Answers = Answers() if out is None else out
        pointers = [None if numbers is None else numbers.pointer for numbers in arrays]
        kept = answers._empty()
        call(name, self._handle, count, *pointers, ctypes.byref(options), ctypes.byref(kept))
        answers._refill()
        return answers

    def rays(self, origins: Rows, directions: Rows, lengths: Rows | Row | float | None = None, **options: Any) -> Answers:
        """What do rays hit? origins and directions (n, 3), directions of any length but 0; lengths (n,) or one number in
        metres, None: unlimited. 1 to 100,000 rays."""
        first = _numbers.rows(origins, 3, "origins")
        second = _numbers.rows(directions, 3, "directions")
        third = None if lengths is None else _numbers.repeated(lengths, first.count, "lengths")
        _numbers.same_length(first, "origins", second, "directions")
        _numbers.same_length(first, "origins", third, "lengths")
        return self._ask("ask_rays", (first, second, third), first.count, options)

    def spheres(self, centers: Rows, radii: Rows | Row | float, **options: Any) -> Answers:
        """What touches spheres, and how deep? centers (n, 3); radii (n,) or one number."""
        first = _numbers.rows(centers, 3, "centers")
        second = _numbers.repeated(radii, first.count, "radii")
        _numbers.same_length(first, "centers", second, "radii")
        return self._ask("ask_spheres", (first, second), first.count, options)

    def boxes(self, centers: Rows, half: Rows, orientations: Rows | None = None, **options: Any) -> Answers:
        """What touches boxes, and how deep? centers and half edges (n, 3); orientations (n, 4), w first, from each box's
        axes to the world."""
        first = _numbers.rows(centers, 3, "centers")
        second = _numbers.rows(half, 3, "half")
        third = None if orientations is None else _numbers.rows(orientations, 4, "orientations")
        _numbers.same_length(first, "centers", second, "halves")
        _numbers.same_length(first, "centers", third, "orientations")
        return self._ask("ask_boxes", (first, second, third), first.count, options)

    def nearest(self, points: Rows, within: Rows | Row | float | None = None, **options: Any) -> Answers:
        """Which objects are nearest to points? points (n, 3); within (n,) or one number: the largest distance, None:
        unlimited; max_hits: how many objects, 1 where it is not given."""
        first = _numbers.rows(points, 3, "points")
        second = None if within is None else _numbers.repeated(within, first.count, "within")
        _numbers.same_length(first, "points", second, "within")
        return self._ask("ask_nearest", (first, second), first.count, options)

    def inside(self, points: Rows, **options: Any) -> Answers:
        """Which solids hold points? points (n, 3). Primitives, hulls and declared meshes are solid; the distance of a
        hit is the depth below the surface."""
        first = _numbers.rows(points, 3, "points")
        return self._ask("ask_inside", (first,), first.count, options)

    def ray(self, origin: Row, direction: Row, length: float = math.inf, **options: Any) -> Answer:
        """What does one ray hit?"""
        return self.rays([list(origin)], [list(direction)], [length], **options)[0]  # type: ignore[arg-type]

    def sphere(self, center: Row, radius: float, **options: Any) -> Answer:
        """What touches one sphere?"""
        return self.spheres([list(center)], [radius], **options)[0]  # type: ignore[arg-type]

    def pair(self, a: str, b: str, timeout: float = 10.0) -> PairAnswer:
        """Do two objects touch, how deep, or how far apart are they?"""
        told = CPairAnswer(size=ctypes.sizeof(CPairAnswer))
        names = encoded(a, "the name"), encoded(b, "the name")
        call("pair", self._handle, *names, nanoseconds(timeout, "timeout"), ctypes.byref(told))
        contained = ("", "a_in_b", "b_in_a")
        return PairAnswer(
            Verdict(told.verdict),
            REASONS[told.reason] if told.reason < len(REASONS) else str(told.reason),
            bool(told.stale),
            contained[told.contained],
            told.distance_m,
            told.depth_m,
            told.error_m,
            _triple(told.normal),
            _triple(told.on_a),
            _triple(told.on_b),
            _triple(told.point),
            None if told.a_triangle == NO_TRIANGLE else told.a_triangle,
            None if told.b_triangle == NO_TRIANGLE else told.b_triangle,
            told.version,
        )

    def clearance(
        self,
        group: str,
        to: str = "",
        *,
        most: int = 1,
        nearer: float = math.inf,
        skip: str = "",
        with_filtered: bool = False,
        deadline: float = 0.0,
        timeout: float = 10.0,
    ) -> Clearance:
        """Which pairs of two groups are nearest to each other, and how near? One search over all pairs, on one state.

        group, to      an object, a scene or a glob each; to "": everything that the first group has not
        most           pairs told, 1 to 10,000
        nearer         metres; pairs surely farther apart are not told
        skip           glob of objects that are left out of both
        with_filtered  also pairs that masks and groups let pass through each other"""
        arguments: dict[str, Any] = {"from": group, "to": to, "most": most, "skip": skip, "with_filtered": with_filtered}
        if nearer != math.inf:
            arguments["nearer_m"] = nearer
        if deadline != 0:
            arguments["deadline_ns"] = nanoseconds(deadline, "deadline")
        return read_clearance(self.command("clearance", timeout=timeout, **arguments))

    def what_if(
        self,
        objects: Sequence[str],
        poses: Rows,
        against: str = "",
        *,
        clearance: bool = False,
        nearer: float = math.inf,
        attached: Sequence[tuple[str, str]] = (),
        timeout: float = 60.0,
        **options: Any,
    ) -> Answers:
        """Whether configurations would be free, with nothing moved: of each answer a miss is free.

        objects    names of those thought elsewhere
        poses      (n * len(objects), 7) or (n, len(objects), 7): x y z, then w x y z; in each configuration one for each
                   object, in order
        against    an object, a scene or a glob; "": everything else
        clearance  the distance of an answer is its least clearance, negative where something touches, and object names
                   the moved one; hits() has both of the pair. Without it the first contact found, only its names
        nearer     metres; with clearance: pairs surely farther apart do not count
        attached   (name, name of what it moves with)
        skip, mask, deadline, as_of, importance, fresh: as of other questions"""
        if _numbers.numpy is not None and getattr(poses, "ndim", 2) == 3:
            poses = _numbers.numpy.asarray(poses).reshape(-1, 7)
        numbers = _numbers.rows(poses, 7, "poses")
        count, left_over = divmod(numbers.count, max(1, len(objects)))
        if left_over:
            raise BadInput(f"{numbers.count} poses for {len(objects)} objects", "each configuration has one for each")
        asked = _ask_options(mode="closest" if clearance else "any", only=against, timeout=timeout, **options)
        names = (ctypes.c_char_p * len(objects))(*[encoded(name, "the name") for name in objects])
        tied = (ctypes.c_char_p * (2 * len(attached)))(*[encoded(name, "the name") for pair in attached for name in pair])
        answers = Answers()
        kept = answers._empty()
        call(
            "what_if", self._handle, names, len(objects), count, numbers.pointer, tied, len(attached), nearer,
            ctypes.byref(asked), ctypes.byref(kept),
        )
        answers._refill()
        return answers

    def status(self) -> Status:
        """What the server said of itself last, twenty times a second."""
        told = CStatus(size=ctypes.sizeof(CStatus))
        call("get_status", self._handle, ctypes.byref(told))
        return Status(
            told.name_space.decode("utf-8", "replace"),
            told.version_text.decode("utf-8", "replace"),
            told.pid,
            told.state.decode("utf-8", "replace"),
            told.epoch,
            told.version,
            told.world_time_ns,
            told.static_triangles,
            told.objects,
            told.moving,
            told.contacts,
            bool(told.contacts_truncated),
            told.poses_applied,
            told.poses_dropped,
            told.questions_answered,
            told.questions_refused,
            told.undecided_answers,
        )

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
        solid: Solid = False,
    ) -> int:
        """Adds an object that stays until it is removed, even when this client has gone. Returns its number.

        solid: its mesh is closed and holds what lies in it; refused with the reason where it does not close. "winding": a
        mesh that does not close is solid by its winding number."""
        made = encode_object(name, shape, position, orientation, scale, layers, mask, group, moving, "remove", solid)
        number = ctypes.c_uint64()
        call("add", self._handle, ctypes.byref(made.value), ctypes.byref(number))
        return number.value

    def move(self, name: str, position: Row, orientation: Row = (1.0, 0.0, 0.0, 0.0), *, teleport: bool = False) -> None:
        """Moves an object that has no living publisher. Contacts on the way count, unless it is teleported."""
        at = _numbers.vector(position, 3, "position")
        turned = _numbers.vector(orientation, 4, "orientation")
        call("move", self._handle, encoded(name, "the name"), at, turned, int(teleport))

    def remove(self, name: str) -> int:
        """Removes objects by name or glob and returns how many."""
        removed = ctypes.c_uint64()
        call("remove", self._handle, encoded(name, "the name"), ctypes.byref(removed))
        return removed.value

    def allow(self, a: str, b: str, because: str = "") -> int:
        """Lets each object of glob a touch each of glob b: their contacts are none. Returns how many ended with it."""
        ended = ctypes.c_uint64()
        texts = [encoded(a, "a"), encoded(b, "b"), encoded(because, "because")]
        call("allow", self._handle, *texts, ctypes.byref(ended))
        return ended.value

    def deny(self, a: str, b: str) -> int:
        """Takes that back. Returns how many contacts began with it."""
        began = ctypes.c_uint64()
        call("deny", self._handle, encoded(a, "a"), encoded(b, "b"), ctypes.byref(began))
        return began.value

    def attach(self, child: str, parent: str) -> None:
        """Has an object that no publisher has move along with another one, until it is detached or one of the two is
        removed."""
        call("attach", self._handle, encoded(child, "the child"), encoded(parent, "the parent"))

    def detach(self, child: str) -> None:
        """It stays where it is."""
        call("detach", self._handle, encoded(child, "the child"))

    def load(self, path: str, timeout: float = 600.0, **arguments: Any) -> dict[str, Any]:
        """Loads a file that the server can read, as a scene: meshes, clouds, tables of boxes, robots (.urdf). The
        arguments are those of the command `load`, such as name, unit, up and replace."""
        return self.command("load", timeout=timeout, path=path, **arguments)

    def command(self, name: str, /, timeout: float = 10.0, **arguments: Any) -> dict[str, Any]:
        """Sends any command; its answer as a dictionary."""
        text = encoded(json.dumps(arguments), "the arguments")
        said = ctypes.c_void_p()
        call("command", self._handle, encoded(name, "the command"), text, nanoseconds(timeout, "timeout"), ctypes.byref(said))
        try:
            answer = ctypes.string_at(said) if said else b""
        finally:
            library.collided_free_text(said)
        decoded = json.loads(answer) if answer else {}
        return decoded if isinstance(decoded, dict) else {"answer": decoded}

    def watch(self, only: str = "", skip: str = "", *, persisted: bool = False, capacity: int = 0, since_ns: int = 0) -> Watch:
        """Subscribes to contact events. What holds already comes first, as events of kind "open"."""
        options = WatchOptions(
            size=ctypes.sizeof(WatchOptions),
            persisted=int(persisted),
            only=encoded(only, "only"),
            skip=encoded(skip, "skip"),
            capacity=capacity,
            since_ns=since_ns,
        )
        started = ctypes.c_void_p()
        call("watch_start", self._handle, ctypes.byref(options), None, None, ctypes.byref(started))
        return Watch(started)

    def add_fence(
        self,
        name: str,
        shape: Shape | Sequence[Shape],
        *,
        to: str = "",
        only: str = "",
        skip: str = "",
        mask: int = 0xFFFFFFFF,
        tells: Sequence[str] = ("enter", "exit", "cross"),
        keep: bool = False,
    ) -> None:
        """Adds a fence, which goes with this client unless it is kept.

        shape  solid, in the world, or in the frame of the object `to`, with which it then moves
        only   name glob of the objects that it looks at; empty: all that move
        """
        _fences.add_fence(self._handle, name, shape, to, only, skip, mask, tells, keep)

    def remove_fences(self, name: str) -> int:
        """Removes fences by name or glob and returns how many."""
        return _fences.remove(self._handle, "fence", name)

    def fences(self, name: str = "") -> list[dict[str, Any]]:
        """The fences and who is in them, as the command `fences` lists them."""
        return list(self.command("fences", name=name)["fences"])

    def watch_fences(self, only: str = "", skip: str = "") -> FenceWatch:
        """Subscribes to who comes into fences and goes out. Who is in already comes first, as "inside"."""
        return FenceWatch(self._handle, only, skip)

    def add_margin(
        self,
        name: str,
        around: str,
        only: str,
        bands: Sequence[float],
        *,
        hysteresis: float = 0.0,
        dwell: float = 0.0,
        skip: str = "",
        mask: int = 0xFFFFFFFF,
        keep: bool = False,
    ) -> None:
        """Adds distance bands between the objects of two globs; they go with this client unless they are kept.

        bands       metres, the widest first; contact is always one
        hysteresis  metres: who is within a band leaves it so much farther out
        dwell       seconds: a change is told once it has lasted so long; contact at once
        """
        _fences.add_margin(self._handle, name, around, only, bands, hysteresis, dwell, skip, mask, keep)

    def remove_margins(self, name: str) -> int:
        """Removes margins by name or glob and returns how many."""
        return _fences.remove(self._handle, "margin", name)

    def margins(self, name: str = "") -> list[dict[str, Any]]:
        """The margins and which pairs are within their bands, as the command `fences` lists them."""
        return list(self.command("fences", name=name, margins=True)["margins"])

    def watch_margins(self, only: str = "", skip: str = "") -> MarginWatch:
        """Subscribes to who comes within bands and leaves them. Who is near already comes first, as "within"."""
        return MarginWatch(self._handle, only, skip)

    def add_nearest(
        self,
        name: str,
        only: str,
        to: str | Sequence[float],
        within: float,
        *,
        hysteresis: float = 0.0,
        skip: str = "",
        mask: int = 0xFFFFFFFF,
        keep: bool = False,
    ) -> None:
        """Adds a question that stays: which object of the glob `only` is nearest. It goes with this client unless kept.

        to          the name of an object, or a point (x, y, z)
        within      metres: what is farther away does not count
        hysteresis  metres: another one must be nearer by more than this
        """
        _fences.add_nearest(self._handle, name, only, to, within, hysteresis, skip, mask, keep)

    def remove_nearest(self, name: str) -> int:
        """Removes questions for the nearest by name or glob and returns how many."""
        return _fences.remove(self._handle, "nearest", name)

    def nearest_questions(self, name: str = "") -> list[dict[str, Any]]:
        """The questions for the nearest and their answers, as the command `fences` lists them."""
        return list(self.command("fences", name=name, nearest=True)["nearest"])

    def watch_nearest(self, only: str = "", skip: str = "") -> NearestWatch:
        """Subscribes to changes of what is nearest. What is nearest already comes first, as "is"."""
        return NearestWatch(self._handle, only, skip)

    def publish(self, name: str, *, lease: float = 0.5) -> Publisher:
        """Becomes a publisher of objects and their poses. Without a call of its for `lease` seconds (0.1 s to a day) the
        server counts it as lost."""
        made = ctypes.c_void_p()
        words = encoded(name, "the publisher's name")
        call("publish_leased", self._handle, words, max(nanoseconds(lease, "lease"), 1), ctypes.byref(made))
        return Publisher(made)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def connect(
    domain: int | None = None,
    name_space: str | None = None,
    interface: str | None = None,
    *,
    peers: Sequence[str] = (),
    wait: float = 2.0,
    keys: str = "",
) -> Client:
    """Waits until a server answers, at most `wait` seconds.

    Without arguments it looks where the environment says (COLLIDED_DOMAIN, else ROS_DOMAIN_ID, COLLIDED_NAMESPACE,
    COLLIDED_INTERFACE, COLLIDED_KEYS), as the command line does; with one, nothing of the environment counts.

    keys: the folder that `collide keys add` made for this program
    """
    made = ctypes.c_void_p()
    if domain is None and name_space is None and interface is None and not peers and wait == 2.0 and not keys:
        call("connect", None, ctypes.byref(made))
        return Client(made)
    addresses = (ctypes.c_char_p * len(peers))(*[encoded(peer, "peer") for peer in peers])
    options = ConnectOptions(
        size=ctypes.sizeof(ConnectOptions),
        domain=domain or 0,
        name_space=encoded(name_space or "", "name_space"),
        interface_name=encoded(interface or "", "interface"),
        wait_ns=nanoseconds(wait, "wait"),
        peers=addresses,
        peer_count=len(peers),
        keys=encoded(keys, "keys"),
    )
    call("connect", ctypes.byref(options), ctypes.byref(made))
    return Client(made)
