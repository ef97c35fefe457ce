"""A robot whose links a publisher moves by its joints."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Mapping

from ._library import Owned, as_json, call, call_for_text
from ._numbers import Row
from ._shapes import pose

if TYPE_CHECKING:
    from ._publisher import Publisher


class PublishedRobot(Owned):
    """A robot in the world, made by Publisher.robot(). Its links stay claimed as long as the publisher lives."""

    _what = "the robot"

    def __init__(self, client: ctypes.c_void_p, publisher: Publisher, options: dict[str, Any]) -> None:
        handle = ctypes.c_void_p()
        call("robot_claim", client, publisher._handle, as_json(options, "robot"), ctypes.byref(handle))
        super().__init__(handle, "robot_close")
        self._publisher = publisher

    def _set(self, motion: dict[str, Any]) -> list[str]:
        _ = self._publisher._handle  # refuses a closed publisher, which the library must not use
        return list(call_for_text("robot_set", self._handle, as_json(motion, "robot")))

    def set_joints(self, positions: Mapping[str, float], *, teleport: bool = False) -> list[str]:
        """Moves the links to the given joint positions, in radians or metres; the publisher's flush() sends them. Joints that
        are not named stay. Returns warnings, such as a step in which a link deviates from its arc by more than 1 mm."""
        return self._set({"joints": list(positions.items()), "teleport": teleport})

    def set_base(self, position: Row, orientation: Row = (1.0, 0.0, 0.0, 0.0)) -> None:
        """Moves the whole robot."""
        self._set({"base": pose(position, orientation)})
