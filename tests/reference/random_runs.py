"""Runs of random scenes: a named ending for each, and every sample compared with the physics.

A scene may end finished, with the step budget used up, or with a named status. What it may not do is hang, raise
anything but `SceneError`, hand up a number that is not finite, an event out of order, or a sample that no state of the
contact could produce: see `run_checks`. The motion up to its first few impacts is then solved again at a tenth of
the tolerance, which shows the error against the requested tolerance.
"""

from __future__ import annotations

import math
import time
import traceback
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.errors import SceneError
from gearidae.records import GEAR_BOUND, TORQUE_BOUND, EnergyBalance, EventKind, Statistics
from gearidae.scene import Scene
from reference.random_scenes import wide_scene
from reference.run_checks import complaint_about, complaint_about_exposures

Floats = NDArray[np.float64]

STEP_BUDGET = 200_000
"""Steps after which a scene is left alone, at the end of a block of output."""
ELASTIC_SHARE = 100
"""With elastic bodies, steps take longer: the budget is divided by this."""

BALANCE_TOLERANCES = 1e4
"""Largest imbalance of the energy balance of a finished run, in tolerances."""

_HORIZON_EVENTS = 3  # turning points, sticks or slips up to which two tolerances are compared


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one scene ended.

    Attributes
    ----------
    number : int
        Of the scene, for `wide_scene`.
    status : str
        ``finished``, ``budget`` (stopped after `STEP_BUDGET` steps or more), ``refused`` (a SceneError), one of the
        named endings, or ``raised``, which is a defect.
    message : str
        The reason in words.
    complaint : str
        What is wrong with the samples or events; empty if nothing is.
    rtol, error : float
        Tolerance, and error up to the first few impacts over what the motion covers there (at least a roughness, or a
        roughness per time unit), a shift in time over the time; NaN where there was nothing to compare.
    imbalance : float
        Imbalance of the energy balance, over the sum of the energy exchanged and the largest kinetic energy.
    steps, wall_time, reached : int, float, float
        Steps, wall time [s], and share of the simulated time that was reached.
    """

    number: int
    status: str
    message: str = ""
    complaint: str = ""
    rtol: float = math.nan
    error: float = math.nan
    imbalance: float = math.nan
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


def draw_and_run(seed: int, number: int, budget: int = STEP_BUDGET, backend: str = "native") -> Outcome:
    """Draw a scene of `wide_scene` and run it."""
    try:
        scene = wide_scene(seed, number)
    except SceneError as refusal:
        return Outcome(number, "refused", str(refusal))
    return run_one(scene, number, budget, backend)


def run_one(scene: Scene, number: int = 0, budget: int = STEP_BUDGET, backend: str = "native") -> Outcome:
    """Run one scene, check what it gave, and compare with a tenth of its tolerance."""
    started = time.perf_counter()
    try:
        run = _solve(scene, scene.run.rtol, budget, backend)
        status = run.statistics.ending.status
        if status == "finished" and run.reached < 1.0:
            status = "budget"
        error = math.nan
        complaint = complaint_about(
            scene, run.rows, run.events, float(run.problem.model.scene.force_unit), rigid=run.rigid
        )
        complaint = complaint or run.exposures
        if status == "finished" and run.imbalance > BALANCE_TOLERANCES * scene.run.rtol:
            complaint = complaint or f"the energy balance has an imbalance of {run.imbalance:.1e}"
        if len(run.rows) > 1 and not complaint:
            error = _error(scene, run, budget, backend)
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
        run.statistics.ending.message,
        complaint,
        scene.run.rtol,
        error,
        run.imbalance,
        run.statistics.steps,
        time.perf_counter() - started,
        run.reached,
    )


@dataclass(frozen=True, slots=True)
class _Run:
    """What came of a scene within the budget."""

    problem: Problem
    statistics: Statistics
    rows: Floats
    events: Floats
    reached: float  # share of the simulated time
    imbalance: float  # of the energy balance
    exposures: str  # what is wrong with them

    @property
    def rigid(self) -> bool:
        """Whether the asperity model has done all of it."""
        return _is_rigid(self.problem)


def _solve(scene: Scene, rtol: float, budget: int, backend: str) -> _Run:
    problem, statistics = make_problem(scene), Statistics()
    rows, events, kept, reached = [], [], [], 0.0
    for block in run_blocks(problem, rtol, scene.run.sample_count, backend, statistics):
        rows.append(block.rows)
        events.append(block.events)
        reached = block.time / (float(problem.model.scene.end) * problem.time_unit)
        if block.balance is not None and block.extremes is not None:
            kept.append((block.balance, block.extremes))
        if statistics.steps * (1 if _is_rigid(problem) else ELASTIC_SHARE) >= budget:
            break
    table, balance = np.concatenate(rows), kept[-1][0] if kept else None
    # of all of it, as what has been exchanged in the first steps is no measure of what may be neglected
    exchanged = balance.throughput if balance is not None else 0.0
    complaints = (complaint_about_exposures(scene, *totals, exchanged) for totals in kept)
    return _Run(
        problem,
        statistics,
        table,
        np.concatenate(events),
        min(reached, 1.0),
        _imbalance(scene, balance, table),
        next(filter(None, complaints), ""),
    )


def _imbalance(scene: Scene, balance: EnergyBalance | None, rows: Floats) -> float:
    """Residual over the energy exchanged; speeds have errors of a tolerance even if no energy is exchanged.

    Of these errors a stiff drive makes work, which counts as much as in the balance's own bound.
    """
    if balance is None:
        return math.nan
    if scene.roller:
        motion = 0.5 * scene.roller.mass * rows[:, 1] ** 2
    else:
        assert scene.gears
        motion = 0.5 * (
            scene.gears.gear_inertia * rows[:, 0] ** 2 + scene.gears.pinion_inertia * rows[:, 1] ** 2
        )
    scale = balance.throughput + float(motion.max(initial=0.0))
    scale += TORQUE_BOUND / GEAR_BOUND * balance.torque_work
    return abs(balance.residual) / scale if scale > 0.0 else 0.0


def _is_rigid(problem: Problem) -> bool:
    """Whether a problem has done without the deflection of bodies so far."""
    return bool(problem.skipped["elastic_deflection"])


# -- error against tolerance -----------------------------------------------------------------------------------------


def _error(scene: Scene, run: _Run, budget: int, backend: str) -> float:
    """Difference from a run at a tenth of the tolerance up to the first few impacts, over what the motion covers."""
    kinds = (EventKind.TURNING_POINT, EventKind.STICK, EventKind.SLIP)
    impacts = run.events[np.isin(run.events[:, 1], kinds), 0]
    horizon = (
        impacts[_HORIZON_EVENTS - 1] if len(impacts) >= _HORIZON_EVENTS else run.reached * scene.run.duration
    )
    if not 0.0 < horizon <= scene.run.duration:
        return math.nan
    short = scene.replace({"run.duration": float(horizon)})
    ours, theirs = (
        _motion(scene, _solve(short, rtol, budget, backend))
        for rtol in (scene.run.rtol, 0.1 * scene.run.rtol)
    )
    count = min(ours.shape[1], theirs.shape[1])
    ours, theirs = ours[:, :count], theirs[:, :count]
    # a shift in time by a share of the horizon is an error by that share, however steep an impact is
    allowed = np.maximum(np.ptp(theirs[0], axis=0), 1.0)
    allowed = allowed + np.abs(theirs[1]) * horizon / run.problem.time_unit
    return float((np.abs(ours[0] - theirs[0]) / allowed).max())


def _motion(scene: Scene, run: _Run) -> Floats:
    """Height or transmission error, and speeds, with their rates, in the engine's units; shape (2, samples, 2 or 3)."""
    sigma, s = scene.surface.roughness, run.problem.model.scene
    speed = sigma / run.problem.time_unit
    if scene.roller:
        height, rate, force = run.rows[:, :3].T
        values = [height / sigma, rate / speed]
        rates = [values[1], s.pinion_inverse_mass * force / s.force_unit]
    else:
        geometry, rows = scene.geometry, run.rows
        gear, pinion = rows[:, 0] * geometry.base_radius_gear, rows[:, 1] * geometry.base_radius_pinion
        force = rows[:, 4] / s.force_unit
        values = [rows[:, 3] / sigma, gear / speed, pinion / speed]
        rates = [values[2] - values[1], s.gear_inverse_mass * force, s.pinion_inverse_mass * force]
    return np.stack([np.column_stack(values), np.column_stack(rates)])
