"""Which asperities of a population are joined at a time, and what they bear: from the events of a run."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.select import first_travel
from gearidae.arrays import Floats
from gearidae.asperities import tip_law
from gearidae.mesh.involute import curvature_radii, flank_arc
from gearidae.populations.flanks import flanks_digest, flanks_of
from gearidae.populations.materials import materials_at
from gearidae.records import EventKind, Flank
from gearidae.scene import MATERIAL_NAMES, GearScene
from gearidae.scene.coating_table import met_teeth

Integers = NDArray[np.int64]


class MetFlank(NamedTuple):
    """The asperities of a pinion's flank, with the materials that they meet on the gear's.

    Attributes
    ----------
    arc : ndarray, shape (n,)
        Places from the base circle [m].
    height : ndarray, shape (n,)
        Over the mean plane, less the recess where the monolayer is lost [m].
    radius : ndarray, shape (n,)
        Of the tips [m].
    material : ndarray of int, shape (n,)
        Among `gearidae.scene.MATERIAL_NAMES`.
    """

    arc: Floats
    height: Floats
    radius: Floats
    material: Integers

    def some(self, which: Integers | NDArray[np.bool_]) -> MetFlank:
        """Return some of them, by their numbers or by a mask."""
        return MetFlank(self.arc[which], self.height[which], self.radius[which], self.material[which])

    def overlaps(self, scene: GearScene, place: float, gap: float) -> Floats:
        """Overlap of each with the gear's flank [m], where the pair touches at a place on its path with a gap [m]."""
        x = self.arc - contact_arc(scene, place)
        return np.asarray(self.height - gap - x**2 / (2.0 * _radius(scene, place)))


def met_flank(scene: GearScene, pair: int, flank: Flank) -> MetFlank:
    """Return the asperities of the pinion's flank in a pair of teeth.

    Parameters
    ----------
    scene : Scene
        With ``contact.roughness = "discrete"``.
    """
    coast = flank == Flank.COAST
    tooth, gear_tooth = (int(one) for one in met_teeth(pair, coast=coast))
    which = tooth % scene.gears.pinion_teeth, int(coast)
    one = next(one for one in flanks_of(scene) if (one.tooth, one.flank) == which)
    material = materials_at(scene, one, gear_tooth)
    recess = {each.name: each.gap_offset for each in scene.materials()}
    recesses = np.array([recess.get(name, 0.0) for name in MATERIAL_NAMES])
    return MetFlank(one.arc, one.height - recesses[material], one.radius, material)


def contact_arc(scene: GearScene, place: float) -> float:
    """Arc on the pinion's flank at which a pair touches [m]: outside its path at its end."""
    return float(flank_arc(scene.geometry, min(max(place, 0.0), scene.geometry.path_length)))


class JoinedAsperities:
    """Joined asperities of a run, from its events.

    Parameters
    ----------
    run : xarray.Dataset
        One run of a gear pair with a population of asperities.
    scene : Scene
        Its scene.

    Attributes
    ----------
    recovered : bool
        Whether the events are there, and the asperities those of the run.
    first_motion : tuple of float
        Gear's travel and transmission error at the first sample [m].
    """

    def __init__(self, run: xr.Dataset, scene: GearScene) -> None:
        self._scene = scene
        single = run["event_asperity"].values >= 0
        pair, flank, self._times, self._asperities, kind = (
            run[f"event_{name}"].values[single] for name in ("pair", "flank", "time", "asperity", "kind")
        )
        self._joins = kind == EventKind.ASPERITY_ONSET
        self._of_pair: dict[tuple[int, int], Integers] = {}
        which, first = np.unique(np.stack([pair, flank]), axis=1, return_inverse=True)
        for number, (one, side) in enumerate(which.T.tolist()):
            self._of_pair[one, side] = np.flatnonzero(first.ravel() == number)
        self._flanks: dict[tuple[int, int], MetFlank] = {}
        self.first_motion = (
            float(run["gear_angle"][0]) * scene.geometry.base_radius_gear + first_travel(run, scene),
            float(run["transmission_error"][0]),
        )
        digest = flanks_digest(flanks_of(scene))
        self.recovered = bool(scene.run.asperity_events and run.attrs.get("asperities_sha256") == digest)

    def of(self, pair: int, flank: Flank, time: float, first: tuple[float, float]) -> Integers:
        """Return the asperities of a pair that are joined at a time, by their numbers on its flank.

        Parameters
        ----------
        time : float
            [s].
        first : tuple of float
            Place and gap of the pair at the first sample [m]: what overlaps there has been joined from the start.
        """
        joined = self._flank(pair, flank).overlaps(self._scene, *first) > 0.0
        mine = self._of_pair.get((pair, int(flank)), np.empty(0, np.int64))
        mine = mine[: np.searchsorted(self._times[mine], time, side="right")]
        joined[self._asperities[mine]] = self._joins[mine]  # the last of each counts
        return np.flatnonzero(joined)

    def loads(
        self, pair: int, flank: Flank, joined: Integers, place: float, gap: float
    ) -> tuple[Floats, Floats, list[str]]:
        """Overlaps [m], loads [N] and names of the materials of joined asperities."""
        scene = self._scene
        some = self._flank(pair, flank).some(joined)
        overlaps, surfaces = (
            some.overlaps(scene, place, gap),
            {one.name: one.surface for one in scene.materials()},
        )
        names, loads = [MATERIAL_NAMES[number] for number in some.material], np.zeros_like(overlaps)
        for k, (name, radius) in enumerate(zip(names, some.radius, strict=True)):
            law, length, load = tip_law(scene.contact.asperity, surfaces[name], float(radius))
            # a sample beside a detachment may lie a rounding error beyond it
            displacement = max(float(overlaps[k]) / length, -law.detach)
            loads[k] = load * float(law.load(displacement))
        return overlaps, loads, names

    def _flank(self, pair: int, flank: Flank) -> MetFlank:
        if (pair, int(flank)) not in self._flanks:
            self._flanks[pair, int(flank)] = met_flank(self._scene, pair, flank)
        return self._flanks[pair, int(flank)]


def _radius(scene: GearScene, place: float) -> float:
    """Reduced radius of curvature where a pair touches [m]."""
    return float(curvature_radii(scene.geometry, place)[2])
