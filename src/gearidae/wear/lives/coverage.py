"""The coverage of a life as a vector of numbers: what it means for a scene, and what each number is exposed to.

- ``uniform``: one share, of both sides alike; with independent sides one of the pinion and one of the gear.
- ``place``: a share for each place along the path of contact, of all teeth alike; with independent sides, of each side.
- ``tooth``: one for each tooth of the pinion and place. Each tooth of an independent gear meets those of the pinion in
  turn: it has one for each place, and is exposed to their mean.

Rates are taken from the drive flank, which carries the load: the coast flank has the same row of a table. A passage is
that of a tooth of the pinion through mesh; a tooth of the gear passes less often by the ratio of the teeth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gearidae.archive.exposures import exposure_coordinates, exposure_variables, gear_flank_areas
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.wear import Exposure

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import Coating, GearScene

RESOLUTIONS = ("uniform", "place", "tooth")


@dataclass(frozen=True, slots=True)
class Coverage:
    """How a coverage is resolved.

    Attributes
    ----------
    resolved : str
        One of `RESOLUTIONS`.
    shapes : tuple of tuple of int
        Teeth and places of each side; one place where it is uniform, one tooth where all are alike.
    start : ndarray
        State at the beginning: the sides one after the other.
    """

    resolved: str
    shapes: tuple[tuple[int, int], ...]
    start: Floats

    @property
    def independent(self) -> bool:
        """Whether each side is covered on its own."""
        return len(self.shapes) > 1

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of what is covered."""
        return ("pinion", "gear") if self.independent else ("interface",)

    @property
    def places(self) -> int:
        """Places along the path of contact; 1 where coverage is uniform."""
        return self.shapes[0][1]

    @property
    def teeth(self) -> int:
        """Number of teeth of the pinion with coverages of their own."""
        return self.shapes[0][0]

    def split(self, numbers: Floats) -> list[Floats]:
        """Take numbers of a state apart, into an array of teeth and places for each side."""
        ends = np.cumsum([teeth * places for teeth, places in self.shapes])[:-1]
        parts = np.split(np.asarray(numbers), ends)
        return [part.reshape(shape) for part, shape in zip(parts, self.shapes, strict=True)]

    def table(self, numbers: Floats) -> Floats:
        """Return numbers of a state by side, tooth and place; of a side whose teeth are alike, the same for all."""
        shape = self.shapes[0]
        return np.stack([np.broadcast_to(part, shape) for part in self.split(numbers)])

    def changes(self, state: Floats) -> dict[str, Any]:
        """Return what a state changes in the scene."""
        parts = self.split(np.clip(state, 0.0, 1.0))
        if self.resolved != "uniform":
            tables = {
                f"coating.{side}_table": part.tolist() for side, part in zip(_SIDES, parts, strict=False)
            }
            return {**tables, "coating.pinion_fraction": None, "coating.gear_fraction": None}
        if self.independent:
            return {f"coating.{side}_fraction": part.item() for side, part in zip(_SIDES, parts, strict=True)}
        return {"coating.sam_fraction": parts[0].item()}

    def exposure(self, scene: GearScene, solution: Solution, cycles: int, state: Floats) -> Exposure:
        """What each number of a state is exposed to in one passage.

        Parameters
        ----------
        scene : Scene
            Of the window.
        solution : Solution
            With the exposures of its cycles.
        cycles : int
            How many.
        """
        variables = exposure_variables(scene, [scene], [solution])
        names = [material.name for material in scene.materials()]
        contacts, work = (
            dict(zip(names, variables[name][1][0], strict=True))
            for name in ("asperity_contacts", "adhesion_work")
        )
        shared = [variables[name][1][0] for name in ("sliding_work", "friction_work") if name in variables]
        shared.append(variables["largest_pressure"][1][0])
        area = exposure_coordinates(scene)["flank_area"][1]
        if not self.independent:
            tables = (contacts["coated"], work["coated"], *shared)
            return _exposure([table.ravel() for table in _gathered(tables, area, cycles, self.shapes[0])])
        sides = []
        for other, shape in zip(self.split(np.clip(state, 0.0, 1.0))[::-1], self.shapes, strict=True):
            # what is covered meets a covered or a bare place of the other side
            met = [other * table["coated"] + (1.0 - other) * table["mixed"] for table in (contacts, work)]
            sides.append(_gathered((*met, *shared), area, cycles, shape))
        ratio = _gear_over_pinion(scene, self.places)
        gear = [table * ratio for table in sides[1][:-1]] + sides[1][-1:]
        return _exposure(
            [np.concatenate([a.ravel(), b.ravel()]) for a, b in zip(sides[0], gear, strict=True)]
        )


_SIDES = ("pinion", "gear")


def _exposure(numbers: Sequence[Floats]) -> Exposure:
    """Make an exposure of its arrays, pressures last; the work of friction before them is missing without friction."""
    contacts, adhesion, sliding, *friction, pressure = numbers
    return Exposure(
        contacts, adhesion, sliding, pressure, friction[0] if friction else np.zeros_like(sliding)
    )


def _gathered(tables: Sequence[Floats], area: Floats, cycles: int, shape: tuple[int, int]) -> list[Floats]:
    """Put exposures by tooth of the pinion and place together as a side has them, per passage; pressures last."""
    gathered = []
    for number, table in enumerate(tables):
        is_pressure = number == len(tables) - 1
        exposure = table if is_pressure else table * len(table) / cycles
        if shape[0] == 1:
            exposure = (exposure.max(axis=0) if is_pressure else exposure.mean(axis=0))[None, :]
        if shape[1] == 1:
            mean = (exposure * area).sum(axis=1) / area.sum()
            exposure = (exposure.max(axis=1) if is_pressure else mean)[:, None]
        gathered.append(exposure)
    return gathered


def _gear_over_pinion(scene: GearScene, places: int) -> Floats:
    """Exposure per area of the gear's flank and passage of the pinion's teeth, over that of the pinion's flank."""
    pinion, gear = exposure_coordinates(scene)["flank_area"][1], gear_flank_areas(scene)
    if places == 1:
        pinion, gear = pinion.sum(keepdims=True), gear.sum(keepdims=True)
    return np.asarray(pinion / gear * scene.gears.pinion_teeth / scene.gears.gear_teeth)


def coverage_of(scene: GearScene, resolved: str, places: int) -> Coverage:
    """Read the coverage that a life begins with.

    Raises
    ------
    SceneError
        If the scene's coating cannot be resolved so.
    """
    if resolved not in RESOLUTIONS:
        raise SceneError("resolved", resolved, "must be one of " + ", ".join(RESOLUTIONS))
    coating, gears = scene.coating, scene.gears
    independent = coating.pairing == "independent"
    if resolved == "uniform":
        if coating.by_place:
            key = "coating.pinion_table" if coating.pinion_table else "coating.gear_table"
            raise SceneError(key, "(given)", 'needs resolved = "place" or "tooth"')
        start = np.array(coating.fractions) if independent else np.array([coating.sam_fraction])
        return Coverage(resolved, ((1, 1),) * len(start), start)
    teeth = gears.pinion_teeth if resolved == "tooth" else 1
    shapes = ((teeth, places), (1, places))[: 2 if independent else 1]
    tables = [
        _spread_table(coating, f"{side}_table", number, shape)
        for number, (side, shape) in enumerate(zip(_SIDES, shapes, strict=False))
    ]
    return Coverage(resolved, shapes, np.concatenate([table.ravel() for table in tables]))


def _spread_table(coating: Coating, key: str, side: int, shape: tuple[int, int]) -> Floats:
    """Coverage of a side at the beginning, for as many teeth and places as are followed."""
    table = np.array(coating.tables[side])
    teeth, places = shape
    if table.shape[1] not in (1, places) or table.shape[0] not in (1, teeth):
        raise SceneError(
            f"coating.{key}",
            f"{table.shape[0]} teeth, {table.shape[1]} places",
            f"must have {'one tooth' if teeth == 1 else f'{teeth} teeth or one'}, and {places} places or one",
        )
    return np.broadcast_to(table, shape).copy()
