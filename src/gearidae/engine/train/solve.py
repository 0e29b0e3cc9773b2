"""Run a train, and collect all of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiles
from gearidae.engine.compiling import HOW_LONG, TRAIN, compiling
from gearidae.engine.integrate.driver import ending_of_flag
from gearidae.engine.train.build import TrainProblem, make_train
from gearidae.engine.train.layout import OF_MESH, OF_SHAFT, TrainModel, TrainOutput
from gearidae.engine.train.loop import LOOKS, advance_train
from gearidae.engine.train.motion import torque_slopes
from gearidae.engine.train.observe import (
    COMMON_COLUMNS,
    MESH_COLUMNS,
    SHAFT_COLUMNS,
    kinetic_energy_of,
    write_stored,
)
from gearidae.engine.train.portable import PortableDriver
from gearidae.engine.train.record import MESH_AT, REST_NUMBERS, SHAFT_AT, TRAIN_EVENT_NUMBERS
from gearidae.errors import SceneError
from gearidae.records import EVENT, Statistics, sample_times
from gearidae.records.energy import EnergyBalance
from gearidae.records.train_results import (
    COMMON_SAMPLES,
    ENERGIES,
    MESH_SAMPLES,
    SHAFT_SAMPLES,
    WORKS_OF_MESHES,
    WORKS_OF_SHAFTS,
    Track,
    TrainSolution,
)
from gearidae.scene.scene import TrainScene

ROWS: Final = 4096
"""Samples in a full block."""
EVENTS: Final = 16_384
"""Events in a full block, and rests."""
STEPS, PORTABLE_STEPS = 20_000, 1_000
"""Steps after which either driver hands over what it has."""


class _Kept:
    """What the blocks of a run have left."""

    def __init__(self, columns: int) -> None:
        self.out = TrainOutput(
            np.empty((ROWS, columns)),
            np.empty((ROWS, columns)),
            np.empty((EVENTS, 2)),
            np.empty((EVENTS, TRAIN_EVENT_NUMBERS)),
            np.empty((EVENTS, REST_NUMBERS)),
        )
        self._tables = [[table[:0].copy()] for table in self.out]
        self.events = 0

    def take(self, problem: TrainProblem) -> None:
        """Take a block over."""
        train = problem.model.train[0]
        names = ("rows", "looks", "zeros", "events", "rests")
        counts = [int(train[name]) for name in names]
        for kept, table, count in zip(self._tables, self.out, counts, strict=True):
            kept.append(table[:count].copy())
        self.events += int(train.events)
        for name in names:
            train[name] = 0

    def tables(self) -> list[NDArray[np.float64]]:
        """Samples, looks, zeros, events and rests."""
        return [np.concatenate(kept) for kept in self._tables]


def solve_train(
    scene: TrainScene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    on_progress: Callable[[float, int], None] | None = None,
) -> TrainSolution:
    """Run a scene with several meshes and collect all of it.

    Parameters
    ----------
    rtol, t_end, samples : optional
        In place of ``run.rtol`` [1], ``run.duration`` [s] and ``run.samples``.
    backend : {"auto", "native", "sksundae"}, optional
        ``auto`` and ``native`` take the compiled loop with a formula of order 8, ``sksundae`` IDA of scikit-sundae.
    on_progress : callable, optional
        Called now and then with the simulated time reached [s] and the number of events so far.

    Returns
    -------
    TrainSolution
        Whatever was reached, with a status that says how the run ended; also after Ctrl-C.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    if not compiles():
        raise SceneError("NUMBA_DISABLE_JIT", 1, "must not be set: the solver runs compiled only")
    if backend not in ("auto", "native", "sksundae"):
        raise SceneError("backend", backend, "must be auto, native or sksundae")
    arguments = {"run.rtol": rtol, "run.duration": t_end, "run.samples": samples}
    changes = {key: value for key, value in arguments.items() if value is not None}
    with compiling(TRAIN, HOW_LONG[TRAIN]):
        problem = make_train(scene.replace(changes) if changes else scene)
    return follow_train(problem, "sksundae" if backend == "sksundae" else "native", on_progress)


def follow_train(
    problem: TrainProblem, backend: str, on_progress: Callable[[float, int], None] | None = None
) -> TrainSolution:
    """Run a train that has been laid out; see `solve_train`."""
    tm, train = problem.model, problem.model.train[0]
    kept = _Kept(SHAFT_COLUMNS * len(tm.shafts) + MESH_COLUMNS * len(tm.meshes) + COMMON_COLUMNS)
    status, message = "", ""
    portable = None
    if backend == "sksundae":
        portable = PortableDriver(tm, _energy_of_run(problem), problem.scene.run.rtol)
    with compiling(TRAIN, HOW_LONG[TRAIN]):
        advance_train(tm, kept.out, 0)
    begun = time.perf_counter()
    try:
        while train.done == 0 and train.error == 0:
            if portable is None:
                advance_train(tm, kept.out, STEPS)
            else:
                portable.advance(kept.out, PORTABLE_STEPS, lambda: kept.take(problem))
            kept.take(problem)
            if on_progress is not None:
                on_progress(float(train.time), kept.events)
    except KeyboardInterrupt:
        status, message = "interrupted", "interrupted by the user"
    statistics = _statistics(problem, backend, time.perf_counter() - begun)
    if not status:
        status, message = statistics.ending.status, statistics.message
    return _solution(problem, kept, statistics, status, message)


def _energy_of_run(problem: TrainProblem) -> float:
    """Energy that works are small against [J]: of the motion, and of the meshes' forces over a pitch."""
    forces = [
        float(record["force_unit"]) * mesh.geometry.base_pitch
        for record, mesh in zip(problem.model.meshes, problem.scene.train.meshes, strict=True)
    ]
    return max([problem.kinetic, *forces])


def _statistics(problem: TrainProblem, backend: str, wall_time: float) -> Statistics:
    """Counters of a run."""
    train = problem.model.train[0]
    return Statistics(
        steps=int(train.steps),
        residual_evaluations=int(train.evaluations),
        guard_evaluations=int(train.guards),
        error_test_failures=int(train.refused),
        restarts=int(train.restarts),
        flight_steps=int(train.flight_steps),
        wall_time=wall_time,
        backend=backend,
        method="bdf" if backend == "sksundae" else "dop853",
        skipped={"flight_steps": int(train.flight_steps)},
        ending=ending_of_flag(int(train.error), alone=True),
    )


def _solution(
    problem: TrainProblem, kept: _Kept, statistics: Statistics, status: str, message: str
) -> TrainSolution:
    """Put a solution together."""
    scene, tm = problem.scene, problem.model
    laid = scene.train
    samples, looks, zeros, events, rests = kept.tables()
    start, end = float(tm.train[0].start), float(tm.train[0].end)
    places = {name: getattr(EVENT, name) for name in ("time", "kind", "pair", "flank", "gap_rate", "force")}
    places |= {"mesh": MESH_AT, "shaft": SHAFT_AT}
    whole = ("kind", "pair", "flank", "mesh", "shaft")
    shaft_totals, mesh_totals, energy = _totals(problem)
    return TrainSolution(
        shafts=tuple(shaft.name for shaft in laid.shafts),
        meshes=tuple(mesh.name for mesh in laid.meshes),
        time=sample_times(0.0, scene.run.duration, scene.run.sample_count)[: len(samples)],
        samples=_columns(problem, samples),
        track=Track(sample_times(start, end, LOOKS)[: len(looks)], _columns(problem, looks), *zeros.T.copy()),
        events={
            name: events[:, place].astype(np.int64) if name in whole else events[:, place].copy()
            for name, place in places.items()
        },
        shaft_totals=shaft_totals,
        mesh_totals=mesh_totals,
        energy=energy,
        rests=_rests(tm, rests),
        status=status,
        message=message,
        reached=float(tm.train[0].time),
        start=start,
        statistics=statistics,
    )


def _columns(problem: TrainProblem, table: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Columns of samples by their names."""
    n, meshes, count = len(problem.model.shafts), len(problem.model.meshes), len(table)
    of_shafts = table[:, : SHAFT_COLUMNS * n].reshape(count, n, SHAFT_COLUMNS)
    of_meshes = table[:, SHAFT_COLUMNS * n : SHAFT_COLUMNS * n + MESH_COLUMNS * meshes]
    of_meshes = of_meshes.reshape(count, meshes, MESH_COLUMNS)
    common = table[:, -COMMON_COLUMNS:]
    return {
        **{name: np.ascontiguousarray(of_shafts[:, :, i].T) for i, name in enumerate(SHAFT_SAMPLES)},
        **{name: np.ascontiguousarray(of_meshes[:, :, i].T) for i, name in enumerate(MESH_SAMPLES)},
        **{name: np.ascontiguousarray(common[:, i]) for i, name in enumerate(COMMON_SAMPLES)},
    }


def _rests(tm: TrainModel, ended: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Intervals at rest, with those that have not ended."""
    open_ones = [
        (i, float(shaft["rest_begin"]), float(tm.train[0].time))
        for i, shaft in enumerate(tm.shafts)
        if shaft["rubs"] and shaft["slip"] == 0.0
    ]
    table = np.concatenate([ended, np.array(open_ones, dtype=float).reshape(-1, REST_NUMBERS)])
    return {"shaft": table[:, 0].astype(np.int64), "begin": table[:, 1].copy(), "end": table[:, 2].copy()}


def _totals(
    problem: TrainProblem,
) -> tuple[dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]], dict[str, float]]:
    """Totals of shafts, of meshes, and energies of the train, at the time reached."""
    tm, scene = problem.model, problem.scene
    n, meshes, y = len(tm.shafts), len(tm.meshes), tm.y
    works = y[2 * n :]
    of_shafts = works[: OF_SHAFT * n].reshape(n, OF_SHAFT)
    of_meshes = works[OF_SHAFT * n : OF_SHAFT * n + OF_MESH * meshes].reshape(meshes, OF_MESH)
    drive, dry, drags, pin = (float(x) for x in works[OF_SHAFT * n + OF_MESH * meshes :])
    held = np.array([bool(shaft["rubs"]) and shaft["slip"] == 0.0 for shaft in tm.shafts])
    rest = tm.shafts["rest_time"] + np.where(held, tm.train[0].time - tm.shafts["rest_begin"], 0.0)
    shaft_totals = {
        "min_speed": tm.shafts["min_speed"].copy(),
        "max_speed": tm.shafts["max_speed"].copy(),
        "hub_loss": of_shafts[:, 0].copy(),
        "hub_sliding": of_shafts[:, 1].copy(),
        "resistance_loss": of_shafts[:, 2].copy(),
        "drag_loss": of_shafts[:, 3].copy(),
        "rest_time": rest,
    }
    now = np.zeros(3 * meshes)
    write_stored(tm, y, now)
    stored, adhesion, radius = now.reshape(meshes, 3).T
    before = problem.energies.reshape(meshes, 3)[:, 0]
    mesh_totals = {
        "largest_mesh_force": tm.meshes["largest"].copy(),
        "largest_mesh_force_time": tm.meshes["largest_time"].copy(),
        "smallest_mesh_force": tm.meshes["smallest"].copy(),
        "smallest_mesh_force_time": tm.meshes["smallest_time"].copy(),
        "smallest_separation": tm.meshes["separation"].copy(),
        "mesh_exits": np.array([int(p.model.state.extremes.mesh_exits) for p in problem.problems]),
        "adhesion_loss": adhesion.copy(),
        "damping_loss": of_meshes[:, 0].copy(),
        "film_loss": of_meshes[:, 1].copy(),
        "work_in": of_meshes[:, 3].copy(),
        "work_out": of_meshes[:, 4].copy(),
    }
    kinetic = float(kinetic_energy_of(tm, y)) - problem.kinetic
    lost = of_shafts[:, [0, 2, 3]].sum() + of_meshes[:, :2].sum() + adhesion.sum() + dry + drags + pin
    energy = {
        "drive_work": drive,
        "radius_work": float(radius.sum()),
        "load_work": dry + drags,
        "kinetic_change": kinetic,
        "stored_change": float((stored - before).sum()),
        "pin_loss": pin,
        "throughput": float(tm.train[0].throughput),
    }
    if not scene.run.balance:
        for totals, names in ((shaft_totals, WORKS_OF_SHAFTS), (mesh_totals, WORKS_OF_MESHES)):
            totals.update({name: np.full(len(totals[name]), np.nan) for name in names})
        energy = dict.fromkeys(ENERGIES, math.nan)
    else:
        taken = float(lost) + energy["stored_change"] + kinetic
        energy["residual"] = drive + energy["radius_work"] - taken
        energy["residual_bound"] = _bound(problem, energy, float(adhesion.sum()), float(np.abs(before).sum()))
    return shaft_totals, mesh_totals, energy


def _bound(problem: TrainProblem, energy: dict[str, float], adhesion: float, stored: float) -> float:
    """Bound of the residual of a correct run [J]: that of a pair's balance, with the momenta of all shafts.

    Works and losses are integrated by the formula of the motion itself, and need no bound of their own.
    """
    tm, rtol = problem.model, problem.scene.run.rtol
    train, n, inertia, ratio = tm.train[0], len(tm.shafts), tm.shafts["inertia"], tm.shafts["ratio"]
    twice, unit = 2.0 * float(train.peak_kinetic), 1.0 / (tm.weights[n:] * rtol)
    of_speed = np.sqrt(twice * inertia) * unit
    # the largest speeds of the train as one body
    top = np.abs(ratio) * math.sqrt(twice / float((inertia * ratio**2).sum()))
    ends = [int(train.drive), int(train.load)]
    slopes = np.array(torque_slopes(tm, float(train.time), tm.y))
    balance = EnergyBalance(
        throughput=energy["throughput"],
        largest=float(train.peak_kinetic) + stored,
        adhesion_loss=adhesion,
        stored_change=energy["stored_change"],
        shaft_change=0.0,
        speed_work=float(of_speed.sum()),
        torque_work=float((slopes * unit[ends] * top[ends]).sum()) * float(train.time - train.start),
        quadrature_error=0.0,
        pitch_work=0.0,
    )
    return balance.bound(rtol, roller=False)
