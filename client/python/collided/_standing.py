"""The calls of a Client for fences, margins and the nearest."""

from __future__ import annotations

from typing import Any, Sequence

from . import _fences
from ._commands import Commanding
from ._fences import FenceWatch, MarginWatch, NearestWatch
from ._shapes import Shape


class Standing(Commanding):
    """What stays in the server and tells of changes."""

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
