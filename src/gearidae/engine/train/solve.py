"""Run a train, and collect all of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiles
from gearidae.engine.compiling import HOW_LONG, TRAIN, compiling
from gearidae.engine.integrate.driver import ending_of_flag
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.engine.train.build import TrainProblem, make_train
from gearidae.engine.train.continuing import pack_train, restore_train, train_from
from gearidae.engine.train.layout import OF_MESH, OF_SHAFT, OF_TRAIN, TrainModel, TrainOutput, which_rest
from gearidae.engine.train.loop import LOOKS, advance_train
from gearidae.engine.train.motion import torque_slopes
from gearidae.engine.train.observe import kinetic_energy_of, write_stored
from gearidae.engine.train.portable import PortableDriver
from gearidae.engine.train.record import REST_NUMBERS, TRAIN_EVENT_NUMBERS
from gearidae.engine.train.start import begin_anew, take_up
from gearidae.errors import SceneError
from gearidae.laws.shaft.own import law_address, switch_address
from gearidae.records import Statistics, sample_times
from gearidae.records.energy import EnergyBalance
from gearidae.records.train_results import (
    ENERGIES,
    TABLES,
    WORKS_OF_MESHES,
    WORKS_OF_SHAFTS,
    TrainBlock,
    TrainSolution,
    TrainTotals,
    sample_columns,
    solution_of,
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

    def __init__(self, shafts: int, meshes: int) -> None:
        self.out = TrainOutput(
            np.empty((ROWS, sample_columns(shafts, meshes))),
            np.empty((ROWS, sample_columns(shafts, meshes))),
            np.empty((EVENTS, 2)),
            np.empty((EVENTS, TRAIN_EVENT_NUMBERS)),
            np.empty((EVENTS, REST_NUMBERS)),
        )
        self._tables = [[table[:0].copy()] for table in self.out]
        self._told = [0] * len(TABLES)
        self.events = 0

    def take(self, problem: TrainProblem) -> None:
        """Take what a block holds over."""
        train = problem.model.train[0]
        names = ("rows", "looks", "zeros", "events", "rests")
        counts = [int(train[name]) for name in names]
        self.add([table[:count].copy() for table, count in zip(self.out, counts, strict=True)])
        for name in names:
            train[name] = 0

    def add(self, tables: Sequence[NDArray[np.float64]]) -> None:
        """Add samples, looks, zeros, events and rests."""
        for kept, table in zip(self._tables, tables, strict=True):
            kept.append(table)
        self.events += len(tables[TABLES.index("events")])

    def untold(self) -> list[NDArray[np.float64]]:
        """Return what has been added since this was asked last."""
        tables = [np.concatenate(kept[told:]) for kept, told in zip(self._tables, self._told, strict=True)]
        self._told = [len(kept) for kept in self._tables]
        return tables

    def tables(self) -> list[NDArray[np.float64]]:
        """Samples, looks, zeros, events and rests."""
        return [np.concatenate(kept) for kept in self._tables]


OnTrainBlock: TypeAlias = Callable[[TrainBlock], object]
"""Called with every block; a return value of True ends the run."""


def solve_train(
    scene: TrainScene,
    *,
    rtol: float | None = None,
    t_end: float | None = None,
    samples: int | str | None = None,
    backend: str = "auto",
    on_progress: Callable[[float, int], None] | None = None,
    start: Start = AT_ONCE,
    blocks: Sequence[TrainBlock] = (),
    on_block: OnTrainBlock | None = None,
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
    start : Start, optional
        Of a run that goes on from another.
    blocks : sequence of TrainBlock, optional
        Those of this very run before it has been interrupted: it goes on behind them.
    on_block : callable, optional
        Called with every block; ends the run by returning True.

    Returns
    -------
    TrainSolution
        Whatever was reached, with a status that says how the run ended; also after Ctrl-C.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do, or the start is not of these gears.
    """
    if not compiles():
        raise SceneError("NUMBA_DISABLE_JIT", 1, "must not be set: the solver runs compiled only")
    arguments = {"run.rtol": rtol, "run.duration": t_end, "run.samples": samples}
    changes = {key: value for key, value in arguments.items() if value is not None}
    if changes:
        scene = scene.replace(changes)
    driver = driver_of_train(backend)
    for table in (scene.drive, scene.load):
        if table.law is not None:  # compiled in every process, and no part of what is compiled for trains
            law_address(table.law.name)
            switch_address(table.law.name)
    kept = _Kept(len(scene.train.shafts), len(scene.train.meshes))
    with compiling(TRAIN, HOW_LONG[TRAIN]):
        if blocks:
            problem = make_train(scene, start)
            restore_train(problem, blocks[-1].checkpoint)
            for block in blocks:
                kept.add([block.tables[name] for name in TABLES])
            kept.untold()
        else:
            problem = make_train(scene) if start.scene is None else train_from(scene, start, kept.out)
    return _follow(problem, driver, kept, on_progress, on_block, blocks[-1].wall_time if blocks else 0.0)


def driver_of_train(backend: str) -> str:
    """Return the driver that runs a train, ``native`` or ``sksundae``.

    Raises
    ------
    SceneError
        If there is none of this name.
    """
    if backend not in ("auto", "native", "sksundae"):
        raise SceneError("backend", backend, "must be auto, native or sksundae")
    return "sksundae" if backend == "sksundae" else "native"


def follow_train(problem: TrainProblem, backend: str) -> TrainSolution:
    """Run a train that has been laid out; see `solve_train`."""
    kept = _Kept(len(problem.model.shafts), len(problem.model.meshes))
    return _follow(problem, backend, kept, None, None, 0.0)


def _follow(
    problem: TrainProblem,
    backend: str,
    kept: _Kept,
    on_progress: Callable[[float, int], None] | None,
    on_block: OnTrainBlock | None,
    wall_time: float,
) -> TrainSolution:
    """Run a train from where it stands.

    What follows from the state is set anew where a block begins, so that a run which is resumed there takes the same
    steps.
    """
    tm, train = problem.model, problem.model.train[0]
    status, message, words = "", "", pack_train(problem) if train.done else None
    _set_pause(problem)
    with compiling(TRAIN, HOW_LONG[TRAIN]):
        advance_train(tm, kept.out, 0)
    begun = time.perf_counter() - wall_time
    try:
        while train.done == 0 and train.error == 0:
            if backend == "native":
                advance_train(tm, kept.out, STEPS)
            else:
                portable = PortableDriver(tm, _energy_of_run(problem), problem.scene.run.rtol)
                portable.advance(kept.out, PORTABLE_STEPS, lambda: kept.take(problem))
            kept.take(problem)
            if train.error == 0:
                if train.time >= train.pause:
                    begin_anew(tm)
                words = pack_train(problem)
                take_up(tm)
                _set_pause(problem)
                if on_block is not None:
                    seconds = time.perf_counter() - begun
                    tables = dict(zip(TABLES, kept.untold(), strict=True))
                    block = TrainBlock(float(train.time), seconds, tables, words, _totals(problem))
                    if on_block(block) is True:
                        status, message = "stopped", "ended by on_block"
                        break
            if on_progress is not None:
                on_progress(float(train.time), kept.events)
    except KeyboardInterrupt:
        kept.take(problem)
        status, message = "interrupted", "interrupted by the user"
    statistics = _statistics(problem, backend, time.perf_counter() - begun)
    if not status:
        status, message = statistics.ending.status, statistics.message
    solution = _solution(problem, kept, statistics, status, message)
    return solution if train.error or status == "interrupted" else replace(solution, checkpoint=words)


def _set_pause(problem: TrainProblem) -> None:
    """Set the time of the coming checkpoint that the run is to keep."""
    run, train = problem.scene.run, problem.model.train[0]
    train.pause = min((t for t in run.checkpoints if train.time < t < train.end), default=math.inf)


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
    laid, train, run = problem.scene.train, problem.model.train[0], problem.scene.run
    return solution_of(
        [shaft.name for shaft in laid.shafts],
        [mesh.name for mesh in laid.meshes],
        sample_times(float(train.start), run.duration, run.sample_count),
        sample_times(float(train.start), run.duration, LOOKS),
        kept.tables(),
        _totals(problem),
        status=status,
        message=message,
        reached=float(train.time),
        start=float(train.start),
        statistics=statistics,
        flanks_held=_flanks_held(problem.model),
    )


def _flanks_held(tm: TrainModel) -> tuple[int, ...]:
    """Numbers of the meshes of which friction holds a pair at the time reached."""
    return tuple(sorted({int(element["mesh"]) for element in tm.elements[: tm.train[0].elements]} - {-1}))


def _resting(tm: TrainModel) -> NDArray[np.float64]:
    """Intervals at rest that have not ended."""
    rows = [
        (i, float(tm.shafts[i]["rest_begin"]), float(tm.train[0].time))
        for i in np.flatnonzero(which_rest(tm))
    ]
    return np.array(rows, dtype=float).reshape(-1, REST_NUMBERS)


def _totals(problem: TrainProblem) -> TrainTotals:
    """Totals of shafts, of meshes, and energies of the train, at the time reached."""
    tm, scene = problem.model, problem.scene
    n, meshes, y = len(tm.shafts), len(tm.meshes), tm.y
    works = y[2 * n :]
    of_shafts = works[: OF_SHAFT * n].reshape(n, OF_SHAFT)
    of_meshes = works[OF_SHAFT * n : OF_SHAFT * n + OF_MESH * meshes].reshape(meshes, OF_MESH)
    of_train = works[OF_SHAFT * n + OF_MESH * meshes :]
    drive, resisted, drags, pin = (float(x) for x in of_train[:OF_TRAIN])
    rubbed = of_train[OF_TRAIN:].copy() if tm.train[0].flanks else np.zeros(meshes)
    rest = tm.shafts["rest_time"] + np.where(which_rest(tm), tm.train[0].time - tm.shafts["rest_begin"], 0.0)
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
        **{
            name: np.array([int(p.model.state[name]) for p in problem.problems])
            for name in ("asperity_onsets", "asperity_detachments")
        },
        "adhesion_loss": adhesion.copy(),
        "damping_loss": of_meshes[:, 0].copy(),
        "film_loss": of_meshes[:, 1].copy(),
        "friction_loss": rubbed,
        "work_in": of_meshes[:, 3].copy(),
        "work_out": of_meshes[:, 4].copy(),
    }
    kinetic = float(kinetic_energy_of(tm, y)) - problem.kinetic
    lost = (
        of_shafts[:, [0, 2, 3]].sum()
        + of_meshes[:, :2].sum()
        + rubbed.sum()
        + adhesion.sum()
        + resisted
        + drags
        + pin
    )
    energy = {
        "drive_work": drive,
        "radius_work": float(radius.sum()),
        "load_work": resisted + drags,
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
    return TrainTotals(shaft_totals, mesh_totals, energy, _resting(tm))


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
