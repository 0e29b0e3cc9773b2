"""The stress run: random scenes through the engine, every ending accounted for, every sample held against the physics.

A scene may end finished, with the step budget used up, or with a named status. What it may not do is raise anything
but `SceneError`, hand up a number that is not finite, an event out of order, or a sample that no state of the contact
could produce: gaps are worked out again from the angles, forces must lie between those of a contact that has just
been made and of one stretched to its limit (by quadrature, not by the engine's tables). The motion up to its first
few impacts is then solved again at a tenth of the tolerance, which shows the error against the tolerance asked for.
"""

from __future__ import annotations

import math
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearidae.bench.random_scenes import random_scene
from gearidae.contact.jkr import asperity_of
from gearidae.contact.line import line_force
from gearidae.engine import layout as at
from gearidae.engine.backend import run_blocks
from gearidae.engine.problem import make_problem
from gearidae.engine.run import Tally
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii, separation
from gearidae.records import EventKind
from gearidae.scene import Scene

__all__ = ["Outcome", "run_one", "run_stress"]

Floats = NDArray[np.float64]

STEP_BUDGET = 50_000
"""Steps after which a scene is left alone; the engine hands out no smaller stretch."""

_CHECKED_SAMPLES = 24
_HORIZON_EVENTS = 3  # turning points, sticks or slips up to which two tolerances are compared
_GAP_TOLERANCE = 1e-7  # of the roughness: rounding of angles and radii
_FORCE_TOLERANCE = 1e-5  # of what pushes and pulls: e^6 of the gap's tolerance per roughness, and the tables
_NEGLECTED = (
    1e-11  # of the scene's reference force: beyond the cut-off the engine takes less than 1e-13 as nothing
)


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one scene ended.

    Attributes
    ----------
    number : int
        Of the scene, for `random_scene`.
    status : str
        ``finished``, ``budget`` (stopped after `STEP_BUDGET` steps), ``refused`` (a SceneError), one of the engine's
        named endings, or ``raised``, which is a defect.
    message : str
        The reason in words.
    complaint : str
        What is wrong with the samples or events; empty if nothing is.
    rtol, error : float
        Tolerance, and error up to the first few impacts over what the motion covers there (at least a roughness, or a
        roughness per time unit), a shift in time over the time; NaN where there was nothing to compare.
    steps, wall_time, reached : int, float, float
        Steps, wall time [s], and share of the simulated time that was reached.
    """

    number: int
    status: str
    message: str = ""
    complaint: str = ""
    rtol: float = math.nan
    error: float = math.nan
    steps: int = 0
    wall_time: float = 0.0
    reached: float = 0.0

    @property
    def ratio(self) -> float:
        """Error over tolerance."""
        return self.error / self.rtol

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong with it."""
        return self.status != "raised" and not self.complaint


def run_stress(runs: int, seed: int, report: Callable[[int], None] | None = None) -> list[Outcome]:
    """Run so many random scenes one after the other.

    Parameters
    ----------
    runs, seed : int
    report : callable, optional
        Called after each with its number.

    Returns
    -------
    list of Outcome
    """
    outcomes = []
    for number in range(runs):
        outcomes.append(run_one(random_scene(seed, number), number))
        if report is not None:
            report(number)
    return outcomes


def run_one(scene: Scene, number: int = 0) -> Outcome:
    """Run one scene, check what it gave, and compare with a tenth of its tolerance."""
    started = time.perf_counter()
    try:
        tally, rows, events, reached = _solve(scene, scene.run.rtol)
        status = tally.ending.status
        if status == "finished" and reached < 1.0:
            status = "budget"
        error = math.nan
        complaint = _check(scene, rows, events)
        if len(rows) > 1 and not complaint:
            error = _error(scene, events, reached)
    except SceneError as refusal:
        return Outcome(number, "refused", str(refusal))
    except Exception as defect:  # whatever it is, it is to be listed and the run to go on
        where = traceback.extract_tb(defect.__traceback__)[-1]
        return Outcome(
            number, "raised", f"{type(defect).__name__}: {defect} ({where.name}, line {where.lineno})"
        )
    return Outcome(
        number,
        status,
        tally.ending.message,
        complaint,
        scene.run.rtol,
        error,
        tally.steps,
        time.perf_counter() - started,
        reached,
    )


def _solve(scene: Scene, rtol: float) -> tuple[Tally, Floats, Floats, float]:
    """Rows, events and the share of the run reached, within the budget."""
    problem, tally = make_problem(scene), Tally()
    rows, events, reached, spent = [], [], 0.0, 0
    for block in run_blocks(problem, rtol, scene.run.sample_count, "native", tally):
        rows.append(block.rows)
        events.append(block.events)
        reached, spent = block.time / (problem.end * problem.time_unit), spent + 1
        if max(tally.steps, STEP_BUDGET * (spent - 1)) >= STEP_BUDGET:
            break
    return tally, np.concatenate(rows), np.concatenate(events), min(reached, 1.0)


# -- what samples and events must satisfy ----------------------------------------------------------------------------


def _check(scene: Scene, rows: Floats, events: Floats) -> str:
    """Name the first thing that is wrong, if anything is."""
    if not np.isfinite(rows[:, :-1]).all() or not np.isfinite(events).all():
        return "not finite"
    if len(events) and (np.any(np.diff(events[:, 0]) < 0) or events[0, 0] < 0):
        return "events out of order"
    chosen = rows[np.unique(np.linspace(0, len(rows) - 1, _CHECKED_SAMPLES).astype(int))]
    for row in chosen:
        complaint = _check_roller(scene, row) if scene.roller else _check_gears(scene, row)
        if complaint:
            return complaint
    return ""


def _check_roller(scene: Scene, row: Floats) -> str:
    assert scene.roller
    height, _, force = row
    low, high, size = _limits(scene, np.array([height]), np.array([scene.roller.radius]), scene.roller.width)
    return _within("force", force, float(low.sum()), float(high.sum()), float(size.sum()), _force_unit(scene))


def _check_gears(scene: Scene, row: Floats) -> str:
    assert scene.gears
    sigma = scene.surface.roughness
    angle, u, force, torque, drive_gap, coast_gap = row[2:8]
    signs, gaps, slopes, radii = _pairs(scene, u, angle)
    for name, sign, found in (("drive_gap", 1.0, drive_gap), ("coast_gap", -1.0, coast_gap)):
        nearest = float(gaps[signs == sign].min())
        if abs(found - nearest) > _GAP_TOLERANCE * sigma + 1e-9 * abs(nearest):
            return f"{name} is {found:.6g} m where the geometry has {nearest:.6g} m"
    low, high, size = _limits(scene, gaps, radii, scene.gears.face_width)
    low, high = np.where(signs > 0, low, -high), np.where(signs > 0, high, -low)
    unit, total = _force_unit(scene), float(size.sum())
    gear = torque / scene.geometry.base_radius_gear
    return _within("mesh_force", force, float(low.sum()), float(high.sum()), total, unit) or _within(
        "gear_contact_torque / R2",
        gear,
        float((low * (1.0 + slopes)).sum()),
        float((high * (1.0 + slopes)).sum()),
        total,
        unit,
    )


def _pairs(scene: Scene, u: float, angle: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Flank (1 drive, -1 coast), gap, slope of the tip relief and reduced radius of every pair near the mesh."""
    assert scene.mesh
    geometry, relief = scene.geometry, scene.mesh.tip_relief_radius
    pitch, travel = geometry.base_pitch, geometry.base_radius_gear * angle
    middle = round(travel / pitch)
    number = np.arange(middle - 40, middle + 41)
    drive = travel - number * pitch
    coast = 2.0 * geometry.approach - (travel - (number + 0.5) * pitch)
    along = np.concatenate([drive, coast])
    signs = np.repeat([1.0, -1.0], number.size)
    opened, slopes = separation(geometry, along, relief)
    gaps = 0.5 * scene.mesh.backlash - signs * u + opened
    return signs, gaps, slopes, curvature_radii(geometry, along)[2]


def _limits(scene: Scene, gaps: Floats, radii: Floats, width: float) -> tuple[Floats, Floats, Floats]:
    """Least and largest force at these gaps, and the size of what pushes and pulls [N]."""
    low, high, size = np.zeros_like(gaps), np.zeros_like(gaps), np.zeros_like(gaps)
    near = gaps < 14.0 * scene.surface.roughness
    share = scene.coating.sam_fraction
    law = scene.contact.asperity
    for surface, part in ((scene.surface, 1.0 - share), (scene.coated_surface, share)):
        if part == 0.0 or not near.any():
            continue
        unit = part * np.sqrt(radii[near])
        loading = unit * line_force(gaps[near], 0.0, 1.0, width, surface, law)
        stretch = asperity_of(surface).stretch_limit
        parting = unit * line_force(gaps[near], stretch, 1.0, width, surface, law)
        pushing = unit * line_force(gaps[near], 0.0, 1.0, width, surface, "hertz")
        low[near] += np.minimum(parting, loading)
        high[near] += np.maximum(parting, loading)
        size[near] += np.abs(pushing) + np.abs(parting) + np.abs(loading)
    return low, high, size


def _force_unit(scene: Scene) -> float:
    """Return the engine's reference force [N]."""
    return float(make_problem(scene).data[at.FORCE])


def _within(name: str, found: float, low: float, high: float, size: float, unit: float) -> str:
    slack = _FORCE_TOLERANCE * size + _NEGLECTED * unit
    if low - slack <= found <= high + slack:
        return ""
    return f"{name} is {found:.6g} N where the contact has {low:.6g} .. {high:.6g} N"


# -- error against tolerance -----------------------------------------------------------------------------------------


def _error(scene: Scene, events: Floats, reached: float) -> float:
    """Difference from a run at a tenth of the tolerance up to the first few impacts, over what the motion covers."""
    kinds = (EventKind.TURNING_POINT, EventKind.STICK, EventKind.SLIP)
    impacts = events[np.isin(events[:, 1], kinds), 0]
    horizon = (
        impacts[_HORIZON_EVENTS - 1] if len(impacts) >= _HORIZON_EVENTS else reached * scene.run.duration
    )
    if not 0.0 < horizon <= scene.run.duration:
        return math.nan
    short = scene.replace({"run.duration": float(horizon)})
    ours, theirs = (_motion(short, _solve(short, rtol)[1]) for rtol in (scene.run.rtol, 0.1 * scene.run.rtol))
    count = min(ours.shape[1], theirs.shape[1])
    ours, theirs = ours[:, :count], theirs[:, :count]
    # a shift in time by a share of the horizon is an error by that share, however steep an impact is
    allowed = np.maximum(np.ptp(theirs[0], axis=0), 1.0) + np.abs(theirs[1]) * horizon / _time_unit(scene)
    return float((np.abs(ours[0] - theirs[0]) / allowed).max())


def _motion(scene: Scene, rows: Floats) -> Floats:
    """Height or transmission error, and speeds, with their rates, in the engine's units; shape (2, samples, 2 or 3)."""
    sigma = scene.surface.roughness
    speed = sigma / _time_unit(scene)
    data = make_problem(scene).data
    if scene.roller:
        height, rate, force = rows.T
        values = [height / sigma, rate / speed]
        rates = [values[1], data[at.GEAR_SHARE] * force / data[at.FORCE]]
    else:
        geometry = scene.geometry
        gear, pinion = rows[:, 0] * geometry.base_radius_gear, rows[:, 1] * geometry.base_radius_pinion
        force = rows[:, 4] / data[at.FORCE]
        values = [rows[:, 3] / sigma, gear / speed, pinion / speed]
        rates = [values[2] - values[1], data[at.GEAR_SHARE] * force, data[at.PINION_SHARE] * force]
    return np.stack([np.column_stack(values), np.column_stack(rates)])


def _time_unit(scene: Scene) -> float:
    return make_problem(scene).time_unit
