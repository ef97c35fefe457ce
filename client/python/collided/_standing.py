"""Standing questions: which objects are in a region, which pairs are near each other, and what is nearest."""

from __future__ import annotations

from typing import Any, Sequence

from . import _numbers
from ._commands import Commanding
from ._contract import STANDING_FORM
from ._described import read
from ._errors import BadInput
from ._library import code_of, nanoseconds
from ._schema import ListedStanding
from ._shapes import Parts, Shape
from ._watch import StandingWatch

_DETECT = ("enter", "exit", "cross")
_ALL_LAYERS = 0xFFFFFFFF


def _named(name: str, form: str | None) -> dict[str, Any]:
    if form is None:
        return {"name": name}
    code_of(form, STANDING_FORM, "form")
    return {"name": name, "form": form}


class Standing(Commanding):
    """The functions of a Client for standing questions."""

    def _add_standing(
        self, name: str, only: str, skip: str, mask: int, keep: bool, members: dict[str, Any], parts: Parts | None = None
    ) -> int:
        if not 0 <= mask <= _ALL_LAYERS:
            raise BadInput(f"mask is {mask}; allowed are 0 to 4294967295", "nothing was sent")
        given = {"name": name, "mask": mask, "keep": bool(keep), **members}
        given.update((glob, words) for glob, words in (("only", only), ("skip", skip)) if words)
        return int(self._command("fence", given, parts=parts).get("parts", 0))

    def add_region(
        self,
        name: str,
        shape: Shape | Sequence[Shape],
        *,
        to: str = "",
        only: str = "",
        skip: str = "",
        mask: int = _ALL_LAYERS,
        detect: Sequence[str] = ("enter", "exit", "cross"),
        keep: bool = False,
    ) -> None:
        """Adds a question: which moving objects are in a region.

        shape   solid; in the world, or in the frame of the object `to`, with which it then moves
        only    empty: all objects that move
        detect  which events it reports; without "cross" a passage between two poses is an "enter" and an "exit"
        """
        unknown = [text for text in detect if text not in _DETECT]
        if unknown or not detect:
            raise BadInput(f"detect is {list(detect)!r}; known are {', '.join(_DETECT)}", "nothing was sent")
        region: dict[str, Any] = {"detect": sorted(set(detect))}
        if to:
            region["to"] = to
        self._add_standing(name, only, skip, mask, keep, region, Parts(shape))

    def add_bands(
        self,
        name: str,
        around: str,
        only: str,
        bands: Sequence[float],
        *,
        hysteresis: float = 0.0,
        dwell: float = 0.0,
        skip: str = "",
        mask: int = _ALL_LAYERS,
        keep: bool = False,
    ) -> int:
        """Adds a question: which objects of the glob `only` are within bands of distance of those of the glob `around`.

        bands       metres, the widest first; contact is always a band
        hysteresis  metres: a pair leaves a band beyond the band plus this
        dwell       seconds: a change is reported after it has lasted this long; contact at once
        returns     number of parts of loaded scenes that match one of the globs; they have no bands
        """
        members = {"around": around, "bands": list(bands), "hysteresis": hysteresis, "dwell_ns": nanoseconds(dwell, "dwell")}
        return self._add_standing(name, only, skip, mask, keep, members)

    def add_nearest(
        self,
        name: str,
        only: str,
        to: str | Sequence[float],
        within: float,
        *,
        hysteresis: float = 0.0,
        skip: str = "",
        mask: int = _ALL_LAYERS,
        keep: bool = False,
    ) -> None:
        """Adds a question: which object of the glob `only` is nearest.

        to          the name of an object, or a point (x, y, z)
        within      metres: objects farther away do not count
        hysteresis  metres: another object must be nearer by more than this
        """
        members: dict[str, Any] = {"within": within, "hysteresis": hysteresis}
        if isinstance(to, str):
            if not to:
                raise BadInput("to is empty; the name of an object or a point is needed", "nothing was sent")
            members["to"] = to
        else:
            members["point"] = list(_numbers.vector(to, 3, "to"))
        self._add_standing(name, only, skip, mask, keep, members)

    def remove_standing(self, name: str, form: str | None = None) -> int:
        """Removes standing questions by name or glob, and returns how many there were.

        form  "region", "bands" or "nearest": only this form
        """
        return len(self._command("fence", {**_named(name, form), "remove": True})["standing"])

    def standing(self, name: str = "", form: str | None = None) -> list[ListedStanding]:
        """The standing questions whose names match the glob, each with the objects that it `holds`."""
        return [read(ListedStanding, row) for row in self._command("fences", _named(name, form))["standing"]]

    def watch_standing(
        self, only: str = "", skip: str = "", form: str | None = None, *, capacity: int = 0
    ) -> StandingWatch:
        """Subscribes to standing questions. The current state comes first, as "inside", "within" and "is".

        only      name glob that the question or one of the two objects must match; empty: everything
        skip      name glob that none of them may match
        capacity  events that may wait to be read; 0: the default
        """
        return StandingWatch(self._handle, only=only, skip=skip, form=_named("", form).get("form"), capacity=capacity)
