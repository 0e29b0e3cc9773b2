"""Starting torque: the smallest drive torque that keeps the gear turning against adhesion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from gearidae.archive.provenance import provenance
from gearidae.archive.variables import SAM_FRACTION
from gearidae.errors import SceneError, SolverError
from gearidae.runs.executors import check_jobs, own_executor, side_by_side
from gearidae.runs.running import prepare, runs_in_threads, solve_to_end
from gearidae.studies.release import holding_forces
from gearidae.studies.study_run import interruptible

if TYPE_CHECKING:
    from gearidae.scene import Scene

__all__ = ["starting_torque", "static_starting_torque"]

_FRACTIONS = np.round(np.linspace(1.0, 0.4, 13), 4)
_LOWEST = 1e-3
"""Torques below this part of the scene's are not looked at unless asked for."""
_HEAVIEST = 1e12
"""No torque above this many times the lowest is tried."""
_PATIENCE = 3.0
"""A gear that has not arrived after this many times the time it would take without adhesion has stuck."""
_STRIDE = 4.0
"""Factor by which the simulated search widens its bracket."""


def static_starting_torque(scene: Scene, *, impacts: int = 3, lowest: float | None = None) -> float:
    """Drive torque that pulls the leaving tooth off at every mesh exit, without help from inertia.

    Parameters
    ----------
    scene : Scene
        With gears.
    impacts : int, optional
        Mesh exits that have to be passed. A worn contact is pressed deeper by each one, and needs more torque the
        more there are.
    lowest : float, optional
        Torque below which nothing is looked for, beyond what the dry resistance takes [N m]; by default a thousandth
        of the scene's.

    Returns
    -------
    float
        Torque on the pinion [N m]: the M10 at which ``M10/R1 = max(-s' W_l) + M20/R2`` holds at the worst exit, see
        `gearidae.studies.release`. What the dry resistance takes (0 without one) if adhesion does not hold the gear
        even at the lowest torque; infinite if it does at any.

    Raises
    ------
    SceneError
        If the scene has no gears, or a setting is not allowed.
    """
    _require(scene, impacts)
    dry, lowest = _dry(scene), _lowest(scene, lowest)
    pinion = scene.geometry.base_radius_pinion

    def surplus(logarithm: float) -> float:
        adhesion = max(holding_forces(scene, (dry + math.exp(logarithm)) / pinion, impacts)) * pinion
        return math.exp(logarithm) - adhesion

    low = math.log(lowest)
    if surplus(low) > 0.0:
        return dry
    high = low
    while surplus(high) <= 0.0:
        if high > math.log(lowest * _HEAVIEST):
            return math.inf
        low, high = high, high + math.log(_STRIDE)
    return dry + math.exp(float(brentq(surplus, low, high, xtol=1e-3)))


def starting_torque(
    scene: Scene,
    sam_fraction: ArrayLike | None = None,
    *,
    impacts: int = 3,
    lowest: float | None = None,
    simulated: bool = True,
    tolerance: float = 0.1,
    jobs: int | None = None,
    backend: str = "auto",
) -> xr.Dataset:
    """Smallest drive torque that takes the gear through the mesh, against SAM fraction.

    Parameters
    ----------
    scene : Scene
        With gears. Its constant drive torque is replaced, a schedule taken away, its initial speed set to zero.
    sam_fraction : array_like, optional
        Fractions of the coating; by default 13 from 1 to 0.4.
    impacts : int, optional
        Pitches to be turned, each with its mesh exit.
    lowest : float, optional
        As for `static_starting_torque`.
    simulated : bool, optional
        Whether to simulate too.
    tolerance : float, optional
        Relative width at which the search among simulated torques ends, 0.001 .. 1.
    jobs, backend
        As for `sweep`.

    Returns
    -------
    Dataset, dims (sam_fraction)
        ``static_torque``: without inertia, see `static_starting_torque`. ``simulated_torque``: a run from rest turns
        the gear by `impacts` pitches at this torque and not at ``simulated_stuck``, which is smaller by `tolerance` or
        less. Both are what the dry resistance takes where adhesion does not hold even at the lowest torque, and NaN
        without `simulated`. All in N m on the pinion.

    Raises
    ------
    SceneError
        If the scene has no gears or a setting is not allowed.
    SolverError
        If a run could not be finished.
    Interrupted
        On Ctrl-C.

    Notes
    -----
    The two differ: a gear that comes along has momentum, which helps it over the first exits, and its contact has been
    pressed by the first touch harder than by the torque, which makes the next ones harder.
    """
    _require(scene, impacts)
    if not 0.001 <= tolerance <= 1.0:
        raise SceneError("tolerance", tolerance, "must lie in 0.001..1")
    given = np.atleast_1d(np.asarray(_FRACTIONS if sam_fraction is None else sam_fraction, dtype=np.float64))
    fractions = [float(value) for value in given]
    scenes = [
        prepare(
            scene.replace({"coating.sam_fraction": fraction}),
            rtol=None,
            t_end=None,
            samples=None,
            backend=backend,
        )
        for fraction in fractions
    ]
    with interruptible():
        static = [static_starting_torque(each, impacts=impacts, lowest=lowest) for each in scenes]
        searches = [
            _Search(each, impacts, _lowest(each, lowest), torque)
            for each, torque in zip(scenes, static, strict=True)
        ]
        if simulated:
            _search_all(searches, tolerance, check_jobs(jobs), backend)
    values: dict[str, tuple[list[float], str]] = {
        "static_torque": (static, "starting torque without inertia"),
        "simulated_torque": (
            [each.result[0] if simulated else math.nan for each in searches],
            "smallest simulated torque at which the gear turns from rest",
        ),
        "simulated_stuck": (
            [each.result[1] if simulated else math.nan for each in searches],
            "largest simulated torque at which the gear sticks",
        ),
    }
    return xr.Dataset(
        {
            name: ("sam_fraction", np.array(numbers), {"units": "N m", "long_name": text})
            for name, (numbers, text) in values.items()
        },
        coords={"sam_fraction": ("sam_fraction", np.array(fractions), SAM_FRACTION.attributes)},
        attrs={
            **provenance(scene, "searched the starting torque", swept=("coating.sam_fraction",)),
            "title": f"{scene.name}: starting torque",
            "summary": "Smallest drive torque that keeps the gear turning against adhesion, against SAM fraction.",
            "impacts": impacts,
            "tolerance": tolerance,
        },
    )


@dataclass
class _Search:
    """Bracket of one fraction's torque on its way to be narrow; torques are beyond the dry resistance."""

    scene: Scene
    impacts: int
    lowest: float
    static: float
    turns: float = math.inf
    sticks: float = 0.0

    def next_torque(self, tolerance: float) -> float | None:
        """Torque to try next; None when the bracket is narrow, or there is nothing in reach."""
        if math.isinf(self.turns):
            guess = self.static - _dry(self.scene)
            first = guess if self.lowest < guess < math.inf else self.lowest
            torque = first if self.sticks == 0.0 else self.sticks * _STRIDE
            return torque if torque <= self.lowest * _HEAVIEST else None
        if self.sticks == 0.0:
            return max(self.turns / _STRIDE, self.lowest) if self.turns > self.lowest else None
        return math.sqrt(self.turns * self.sticks) if self.turns > (1.0 + tolerance) * self.sticks else None

    def learn(self, torque: float, turned: bool) -> None:
        """Take in the outcome of a run."""
        if turned:
            self.turns = min(self.turns, torque)
        else:
            self.sticks = max(self.sticks, torque)

    @property
    def result(self) -> tuple[float, float]:
        """Smallest torque that turns and largest that sticks [N m]; alike if the gear turns at the lowest."""
        dry = _dry(self.scene)
        return (dry, dry) if self.sticks == 0.0 else (dry + self.turns, dry + self.sticks)


def _search_all(searches: Sequence[_Search], tolerance: float, workers: int, backend: str) -> None:
    """Narrow all brackets, the runs of each round side by side."""
    threads = runs_in_threads(backend, searches[0].scene.run.method)
    with own_executor(workers if threads else 1, len(searches), releases_gil=threads) as executor:
        while True:
            asked = [(each, each.next_torque(tolerance)) for each in searches]
            todo = [(each, torque) for each, torque in asked if torque is not None]
            if not todo:
                return
            arguments: list[list[Any]] = [list(column) for column in zip(*todo, strict=True)]
            outcomes = side_by_side(executor, _turns, *arguments, [backend] * len(todo))
            for (each, torque), turned in zip(todo, outcomes, strict=True):
                each.learn(torque, turned)


def _turns(search: _Search, torque: float, backend: str) -> bool:
    """Whether the gear, from rest, comes through its pitches at a torque beyond the dry resistance."""
    scene, geometry = search.scene, search.scene.geometry
    gears, load = scene.gears, scene.load
    assert gears is not None
    assert load is not None
    ratio = geometry.base_radius_gear / geometry.base_radius_pinion
    way = search.impacts * 2.0 * math.pi / gears.gear_teeth
    inertia = gears.gear_inertia + gears.pinion_inertia * ratio**2
    duration = math.sqrt(2.0 * way * inertia / (torque * ratio))
    if load.drag > 0.0:
        duration += way / math.sqrt(torque * ratio / load.drag)
    duration += way * load.viscous / (torque * ratio)
    others = ("schedule", "speed", "speed_gain")
    drive = {key: value for key, value in scene.to_dict()["drive"].items() if key not in others}
    changes = {
        "drive": {**drive, "torque": _dry(scene) + torque},
        "initial.gear_speed": 0.0,
        "run.duration": _PATIENCE * duration,
        "run.samples": 101,
    }
    solution = solve_to_end(scene.replace(changes), backend)
    if solution.status != "finished":
        raise SolverError(
            f"the run at {_dry(scene) + torque:g} N m could not be finished: {solution.message or solution.status}",
            time=solution.reached or 0.0,
            state={},
            last_event="not kept",
            advice="try another rtol (run.rtol)",
        )
    angle = solution.samples["gear_angle"]
    return bool(angle.max() - angle[0] >= way)


def _dry(scene: Scene) -> float:
    """Drive torque that the dry resistance takes [N m]: ``M20 R1/R2``."""
    assert scene.load is not None
    geometry = scene.geometry
    return scene.load.torque * geometry.base_radius_pinion / geometry.base_radius_gear


def _lowest(scene: Scene, given: float | None) -> float:
    assert scene.drive is not None
    lowest = _LOWEST * abs(scene.drive.torque) if given is None else given
    if not 0.0 < lowest < math.inf:
        allowed = "must be a positive torque; give it where the scene's own constant torque is 0"
        raise SceneError("lowest", given, allowed)
    return lowest


def _require(scene: Scene, impacts: int) -> None:
    if getattr(scene, "gears", None) is None:
        raise SceneError("scene", getattr(scene, "name", type(scene).__name__), "must be a scene with gears")
    if not isinstance(impacts, int) or isinstance(impacts, bool) or impacts < 1:
        raise SceneError("impacts", impacts, "must be a whole number, 1 or more")
