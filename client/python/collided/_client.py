"""The connection to one server."""

from __future__ import annotations

import ctypes
from typing import Any, Sequence

from ._asking import Asking
from ._described import read
from ._library import as_json, call, connect_options
from ._managing import Managing
from ._measuring import Measuring
from ._numbers import Row
from ._publisher import Publisher
from ._schema import ServerStatus
from ._shapes import Parts, Shape, Solid, as_object, pose
from ._standing import Standing
from ._watch import ProbeWatch, Watch


class Client(Asking, Measuring, Standing, Managing):
    """A connection to one server, made by connect(). Several threads may call at once.

    Questions take these keywords:
      mode        "closest" (default), "any" or "all": which hits of rays, spheres and boxes to return; "verdict": only
                  whether there is one; "signed_near", for nearest: minus the depth if a solid contains the point
      only, skip  name globs of objects that may answer, and of objects to leave out
      mask        bits; objects with one of these layers may answer
      max_hits    per question; further hits are cut off and the answer is undecided (truncated)
      error       allowed error of distances in metres; 0: exact arithmetic if in doubt
      deadline    seconds on the server; answers after it are undecided; 0: none
      timeout     seconds that the call waits
      fresh       answer only after this client's own last write is applied
      as_of       "latest" (default), "settled", nanoseconds since 1970, or minus nanoseconds before now
      importance  "normal", "low" or "high"
      out         Answers of an earlier call, whose memory is reused
    pair, clearance and explanations take as_of, deadline and timeout.

    Standing questions, which the server evaluates continuously, take these keywords:
      name  unique among standing questions
      only  name glob of the objects that the question monitors
      skip  name glob of objects to leave out; empty: none
      mask  bits; it monitors objects with one of these layers
      keep  the question stays until it is removed, and survives a restart of the server; otherwise it is removed when
            this client disconnects
    """

    _what = "the client"

    def __init__(self, handle: ctypes.c_void_p) -> None:
        super().__init__(handle, "close")

    def status(self) -> ServerStatus:
        """The newest status of the server, which it publishes twenty times a second."""
        return read(ServerStatus, self.command("status"))

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
        """Adds an object that stays until it is removed, even after this client disconnects. Returns its number.

        solid: its mesh bounds a solid; refused with the reason if it does not close. "winding": a mesh that does not
        close is solid by its winding number."""
        described = as_object(name, position, orientation, scale, layers, mask, group, moving, solid)
        return int(self._command("add", described, parts=Parts(shape))["id"])

    def move(self, name: str, position: Row, orientation: Row = (1.0, 0.0, 0.0, 0.0), *, teleport: bool = False) -> None:
        """Moves an object that has no living publisher. Contacts on the path count, unless it is teleported."""
        self._command("move", {"name": name, "pose": pose(position, orientation), "teleport": teleport})

    def remove(self, name: str) -> int:
        """Removes objects by name or glob, and returns their number."""
        return len(self._command("remove", {"name": name})["removed"])

    def allow(self, a: str, b: str, because: str = "") -> int:
        """Allows each object of glob a to touch each of glob b: their contacts are not reported. Returns how many ended."""
        return int(self.command("allow", a=a, b=b, because=because)["ended"])

    def deny(self, a: str, b: str) -> int:
        """Removes such a rule. Returns how many contacts began."""
        return int(self.command("deny", a=a, b=b)["began"])

    def attach(self, child: str, parent: str) -> None:
        """Attaches an object without a publisher to another one: it moves along until it is detached or one of the two is
        removed."""
        self.command("attach", child=child, parent=parent)

    def detach(self, child: str) -> None:
        """Detaches an object, which stays where it is."""
        self.command("detach", child=child)

    def watch(self, only: str = "", skip: str = "", *, persisted: bool = False, capacity: int = 0, since_ns: int = 0) -> Watch:
        """Subscribes to contact events. Existing contacts come first, as events of kind "open"."""
        return Watch(self._handle, only=only, skip=skip, persisted=persisted, capacity=capacity, since_ns=since_ns)

    def watch_probes(self, only: str = "", skip: str = "", *, capacity: int = 0) -> ProbeWatch:
        """Subscribes to the readings of probes after every step. only, skip: globs of their names. capacity: readings that
        may wait to be read; 0: the default."""
        return ProbeWatch(self._handle, only=only, skip=skip, capacity=capacity)

    def publish(self, name: str, *, lease: float = 0.5, gap: float = 1.5) -> Publisher:
        """Creates a publisher of objects and their poses. Without a call for `lease` seconds (0.1 s to a day) the server
        counts it as lost. Between two poses at most `gap` seconds apart (0.001 to 8) an object moves straight; otherwise
        it rests until one gap before the later pose. Choose `gap` longer than the period of the source."""
        return Publisher(self._handle, name, lease, gap)


def connect(
    domain: int | None = None,
    name_space: str | None = None,
    interface: str | None = None,
    *,
    peers: Sequence[str] = (),
    wait: float = 2.0,
    keys: str = "",
    replicas: bool = True,
    wait_is_limit: bool = False,
) -> Client:
    """Waits until a server answers, at most `wait` seconds.

    Without arguments it reads the environment (COLLIDED_DOMAIN, else ROS_DOMAIN_ID, COLLIDED_NAMESPACE,
    COLLIDED_INTERFACE, COLLIDED_KEYS), as the command line does; with any argument it ignores the environment.

    keys           the folder that `collide keys add` made for this program
    replicas       also send questions to replicas of the server
    wait_is_limit  never wait longer than `wait`; otherwise a busy server on this machine gets more time
    """
    given = connect_options(domain, name_space, interface, peers, wait, keys, replicas, wait_is_limit)
    made = ctypes.c_void_p()
    call("connect", as_json(given, "connect") if given else None, ctypes.byref(made))
    return Client(made)
