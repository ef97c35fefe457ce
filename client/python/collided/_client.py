"""The connection to one server."""

from __future__ import annotations

import ctypes
from typing import Any, Sequence

from . import _numbers
from ._asking import Asking
from ._described import read, row_of
from ._library import call, encoded, library, nanoseconds
from ._managing import Managing
from ._measuring import Measuring
from ._numbers import Row
from ._publisher import Publisher
from ._schema import ServerStatus
from ._shapes import Shape, Solid, encode_object
from ._standing import Standing
from ._structs import CConnectOptions, CStatus, CPublishOptions, CWatchOptions
from ._watch import Watch


class Client(Asking, Measuring, Standing, Managing):
    """A connection to one server, made by connect(). Several threads may call at once.

    Questions take these keywords:
      mode        "closest" (default), "any" or "all": which hits of rays, spheres and boxes are wanted; "verdict": none,
                  only whether there is one; "signed_near", of nearest: minus the depth where a solid holds the point
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
    pair, clearance and explanations take as_of, deadline and timeout of these.

    Standing questions, which the server keeps and whose changes it reports, take these:
      name  unique among standing questions
      only  name glob of the objects that the question looks at
      skip  name glob of objects that it leaves out; empty: none
      mask  bits; it looks at objects with one of these layers
      keep  the question stays until it is removed, and outlives the server; otherwise it goes with this client
    """

    _what = "the client"

    def __init__(self, handle: ctypes.c_void_p) -> None:
        super().__init__(handle, "close")

    def status(self) -> ServerStatus:
        """The newest status that the server has published, which it does twenty times a second."""
        told = CStatus(size=ctypes.sizeof(CStatus))
        call("get_status", self._handle, ctypes.byref(told))
        return read(ServerStatus, row_of(told))

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

    def watch(self, only: str = "", skip: str = "", *, persisted: bool = False, capacity: int = 0, since_ns: int = 0) -> Watch:
        """Subscribes to contact events. What holds already comes first, as events of kind "open"."""
        options = CWatchOptions(
            size=ctypes.sizeof(CWatchOptions),
            persisted=int(persisted),
            only=encoded(only, "only"),
            skip=encoded(skip, "skip"),
            capacity=capacity,
            since_ns=since_ns,
        )
        started = ctypes.c_void_p()
        call("watch_start", self._handle, ctypes.byref(options), None, None, ctypes.byref(started))
        return Watch(started)

    def publish(self, name: str, *, lease: float = 0.5, gap: float = 1.5) -> Publisher:
        """Becomes a publisher of objects and their poses. Without a call of its for `lease` seconds (0.1 s to a day) the
        server counts it as lost. Between two poses an object goes straight if they are at most `gap` seconds apart (0.001
        to 8); beyond, it rested until one gap before the later pose. Choose it longer than the period of the source."""
        made = ctypes.c_void_p()
        words = encoded(name, "the publisher's name")
        options = CPublishOptions(
            size=ctypes.sizeof(CPublishOptions), lease_ns=nanoseconds(lease, "lease"), gap_ns=nanoseconds(gap, "gap")
        )
        call("publish_with", self._handle, words, ctypes.byref(options), ctypes.byref(made))
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
    options = CConnectOptions(
        size=ctypes.sizeof(CConnectOptions),
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
