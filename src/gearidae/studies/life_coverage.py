"""The coverage of a life as a vector of numbers: what it means for a scene, and what each number is exposed to.

- ``uniform``: one share, of both sides alike; with independent sides one of the pinion and one of the gear.
- ``place``: a share for each place along the flank, of all teeth alike.
- ``tooth``: one for each tooth of the pinion and place.

Rates are taken from the drive flank, which carries the load: the coast flank has the same row of a table. A passage is
that of a tooth of the pinion through mesh; a tooth of the gear passes less often by the ratio of the teeth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.exposures import exposure_coordinates, exposure_variables
from gearidae.errors import SceneError
from gearidae.wear import Exposure

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import Scene

__all__ = ["RESOLUTIONS", "Coverage", "coverage_of"]

Floats: TypeAlias = NDArray[np.float64]

RESOLUTIONS = ("uniform", "place", "tooth")


@dataclass(frozen=True, slots=True)
class Coverage:
    """How a coverage is resolved.

    Attributes
    ----------
    resolved : str
        One of `RESOLUTIONS`.
    shape : tuple of int
        Of a state: sides, teeth, places.
    independent : bool
        Whether each side is covered on its own.
    start : ndarray
        State at the beginning.
    """

    resolved: str
    shape: tuple[int, int, int]
    independent: bool
    start: Floats

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of what is covered."""
        return ("pinion", "gear") if self.independent else ("interface",)

    def changes(self, state: Floats) -> dict[str, Any]:
        """Return what a state changes in the scene."""
        table = np.clip(state, 0.0, 1.0).reshape(self.shape)
        if self.resolved != "uniform":
            return {"coating.pinion_table": table[0].tolist()}
        if self.independent:
            first, second = table[:, 0, 0].tolist()
            return {"coating.pinion_fraction": first, "coating.gear_fraction": second}
        return {"coating.sam_fraction": float(table[0, 0, 0])}

    def exposure(self, scene: Scene, solution: Solution, cycles: int, state: Floats) -> Exposure:
        """What each number of a state is exposed to in one passage.

        Parameters
        ----------
        scene : Scene
            Of the window.
        solution : Solution
            With the exposures of its cycles.
        cycles : int
            How many.
        state : ndarray
        """
        found = exposure_variables(scene, [scene], [solution])
        names = [each.name for each in scene.materials()]
        contacts, work = (
            dict(zip(names, found[name][1][0], strict=True))
            for name in ("asperity_contacts", "adhesion_work")
        )
        shared = (found["sliding_work"][1][0], found["largest_pressure"][1][0])
        if not self.independent:
            return self._gathered(scene, cycles, (contacts["coated"], work["coated"], *shared))
        sides = []
        other = np.clip(state, 0.0, 1.0)[::-1]
        for side in range(2):  # what is covered meets a covered or a bare place of the other side
            met = [
                other[side] * each["coated"] + (1.0 - other[side]) * each["mixed"]
                for each in (contacts, work)
            ]
            sides.append(self._gathered(scene, cycles, (*met, *shared)))
        ratio = _gear_over_pinion(scene)
        pinion, gear = sides
        return Exposure(
            np.concatenate([pinion.contacts, ratio * gear.contacts]),
            np.concatenate([pinion.adhesion_work, ratio * gear.adhesion_work]),
            np.concatenate([pinion.sliding_work, ratio * gear.sliding_work]),
            np.concatenate([pinion.pressure, gear.pressure]),
        )

    def _gathered(self, scene: Scene, cycles: int, tables: tuple[Floats, ...]) -> Exposure:
        """Put exposures by tooth and place together as the state has them, per passage."""
        area = exposure_coordinates(scene)["flank_area"][1]
        contacts, work, sliding, pressure = tables
        if self.resolved == "tooth":
            per = [(table * len(table) / cycles).ravel() for table in (contacts, work, sliding)]
            return Exposure(per[0], per[1], per[2], pressure.ravel())
        per = [table.sum(axis=0) / cycles for table in (contacts, work, sliding)]
        most = pressure.max(axis=0)
        if self.resolved == "uniform":
            per = [np.array([(each * area).sum() / area.sum()]) for each in per]
            most = np.array([most.max()])
        return Exposure(per[0], per[1], per[2], most)


def _gear_over_pinion(scene: Scene) -> float:
    """Exposure per area of the gear's flank and passage of the pinion's teeth, over that of the pinion's flank."""
    assert scene.gears is not None
    geometry = scene.geometry
    span = geometry.contact_ratio * geometry.base_pitch
    first = geometry.tangent_pinion - geometry.approach
    last = geometry.tangent_pinion + geometry.tangent_gear - first
    pinion = ((first + span) ** 2 - first**2) / geometry.base_radius_pinion
    gear = (last**2 - (last - span) ** 2) / geometry.base_radius_gear
    return pinion / gear * scene.gears.pinion_teeth / scene.gears.gear_teeth


def coverage_of(scene: Scene, resolved: str, places: int) -> Coverage:
    """Read the coverage that a life begins with.

    Raises
    ------
    SceneError
        If the scene's coating cannot be resolved so.
    """
    if resolved not in RESOLUTIONS:
        raise SceneError("resolved", resolved, "must be one of " + ", ".join(RESOLUTIONS))
    coating, gears = scene.coating, scene.gears
    assert gears is not None
    independent = coating.pairing == "independent"
    if resolved == "uniform":
        if coating.by_place:
            raise SceneError("coating.pinion_table", "(given)", 'needs resolved = "place" or "tooth"')
        start = np.array(coating.fractions) if independent else np.array([coating.sam_fraction])
        return Coverage(resolved, (len(start), 1, 1), independent, start)
    if independent:
        raise SceneError("coating.pairing", coating.pairing, f'must be patches with resolved = "{resolved}"')
    teeth = gears.pinion_teeth if resolved == "tooth" else 1
    table = np.full((teeth, places), coating.sam_fraction)
    if coating.pinion_table:
        given = np.array(coating.pinion_table)
        if given.shape[1] not in (1, places) or given.shape[0] not in (1, teeth):
            raise SceneError(
                "coating.pinion_table",
                f"{given.shape[0]} teeth, {given.shape[1]} places",
                f"must have {teeth} or one, and {places} or one",
            )
        table = np.broadcast_to(given, table.shape).copy()
    return Coverage(resolved, (1, teeth, places), False, table.ravel())
