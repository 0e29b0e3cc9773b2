"""One scene of the attack, in a process of its own: its reports, and the check of its motion and energy balance."""

from __future__ import annotations

import contextlib
import faulthandler
import logging
import math
import sys
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import gearidae as gd
from gearidae import engine
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.errors import SceneError
from gearidae.records import EnergyBalance, EventKind
from gearidae.scene import Scene
from gearidae.scene.sampled import columns_of
from gearidae_bench.extreme_scenes import Extreme, extreme_friction, extreme_population, extreme_scene

__all__ = [
    "FAULTS",
    "Followed",
    "Outcome",
    "attack_friction",
    "attack_one",
    "attack_population",
    "judge",
    "limit_memory",
    "run_scene",
    "warm_up",
]

Floats = NDArray[np.float64]

FAULTS = ("killed", "silent", "raised")

MEMORY = 8 * 2**30
"""Bytes that a process may take: more is a MemoryError, and not the end of everything else on the machine."""

_BLOCKS = 6  # of output, full of samples or events, that a scene may fill
_HORIZON_EVENTS = 3  # turning points, sticks or slips up to which two tolerances are compared
_FINER = 100.0  # times less is the tolerance that a motion is compared with
_STEPS_FINER = 20  # times the budget, for that
_SECONDS = 20.0  # that a comparison may take
_SAMPLES = 801
_LEAST_RTOL = 1e-12


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one scene ended.

    Attributes
    ----------
    number : int
        Of the scene, for `extreme_scene`.
    status : str
        ``finished``, ``budget``, ``refused``, one of the engine's named endings, or a fault: ``killed``, ``silent``,
        ``raised``.
    message : str
        The reason in words; of a fault, where.
    backend : str
    rtol, error : float
        Tolerance; difference from the motion at a hundredth of it up to the third impact, over what the motion covers
        there, a shift in time over the time; NaN where there was nothing to compare.
    balance : float
        Residual of the energy balance at that instant over its bound: above 1 the run is warned of.
    steps : int
    wall_time, longest : float
        Wall time, and the longest time without a report [s].
    reached : float
        Share of the simulated time.
    """

    number: int
    status: str
    message: str = ""
    backend: str = ""
    rtol: float = math.nan
    error: float = math.nan
    balance: float = math.nan
    steps: int = 0
    wall_time: float = 0.0
    longest: float = 0.0
    reached: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether it ended as a scene may."""
        return self.status not in FAULTS

    @property
    def agrees(self) -> bool:
        """Whether the motion is that of a hundredth of the tolerance, to ten tolerances."""
        return bool(self.error <= 10.0 * self.rtol)

    @property
    def warned(self) -> bool:
        """Whether the energy balance is beyond its bound."""
        return bool(self.balance > 1.0)


@dataclass(slots=True)
class Followed:
    """What came of a run, however far it was followed."""

    rows: Floats
    events: Floats
    status: str = "budget"
    message: str = ""
    steps: int = 0
    reached: float = 0.0
    balance: EnergyBalance | None = None


class _Enough(Exception):  # noqa: N818 - not an error: the way out of a run that is left alone
    """The budget is used up."""


def warm_up() -> None:
    """Compile and load both drivers, with rigid and elastic bodies."""
    for backend in ("native", "sksundae"):
        for name in ("teodorescu2009", "roller_slow"):
            for bodies in ("rigid", "elastic"):
                # samples between steps: interpolation is compiled too
                short = {"contact.bodies": bodies, "run.duration": 1e-6, "run.samples": 2001}
                with contextlib.suppress(SceneError):  # no native driver here
                    gd.simulate(gd.preset(name).replace(short), backend=backend)


def limit_memory() -> None:
    """Let this process take no more than `MEMORY`, where the system can hold it to that."""
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def attack_one(seed: int, number: int, budget: int, reports: Connection, trace: str) -> None:
    """Run one scene of `extreme_scene` and report, in a process of its own."""
    _attack(extreme_scene, (seed, number), budget, reports, trace)


def attack_population(seed: int, number: int, budget: int, reports: Connection, trace: str) -> None:
    """Run one scene of `extreme_population` and report."""
    _attack(extreme_population, (seed, number), budget, reports, trace)


def attack_friction(seed: int, number: int, budget: int, reports: Connection, trace: str) -> None:
    """Run one scene of `extreme_friction` and report."""
    _attack(extreme_friction, (seed, number), budget, reports, trace)


def _attack(
    draw: Callable[..., Extreme], which: tuple[int, int], budget: int, reports: Connection, trace: str
) -> None:
    """Draw a scene, run it and report."""
    logging.disable(logging.WARNING)
    with Path(trace).open("w") as file:
        faulthandler.enable(file)
        if sys.platform != "win32":
            import signal

            faulthandler.register(signal.SIGUSR1, file)
        limit_memory()
        extreme = draw(*which, lambda: reports.send("drawing"))
        reports.send("begun")
        outcome = judge(extreme.scene, extreme.backend, budget, lambda: reports.send("alive"))
        reports.send(replace(outcome, number=which[1]))


def judge(scene: Scene, backend: str, budget: int, alive: Callable[[], None]) -> Outcome:
    """Run a scene within a budget of steps, and compare what ended soundly with a hundredth of its tolerance.

    Parameters
    ----------
    scene : Scene
    backend : {"native", "sksundae"}
    budget : int
        Steps.
    alive : callable
        Called with every report of progress.

    Returns
    -------
    Outcome
        Its number is 0.
    """
    started = time.perf_counter()
    none = Outcome(0, "", backend=backend, rtol=scene.run.rtol)
    try:
        run = run_scene(scene, backend, budget, alive)
        alive()
        error, balance = _compared(scene, run, backend, budget, alive)
    except SceneError as refusal:
        return replace(none, status="refused", message=str(refusal))
    except Exception as defect:  # whatever it is, it is to be listed and the attack to go on
        places = [
            f"{one.filename.rpartition('/')[2]}:{one.lineno} {one.name}"
            for one in traceback.extract_tb(defect.__traceback__)
        ]
        message = f"{type(defect).__name__}: {defect} ({' > '.join(places[-4:])})"
        return replace(none, status="raised", message=message)
    return replace(
        none,
        status=run.status,
        message=run.message,
        error=error,
        balance=balance,
        steps=run.steps,
        wall_time=time.perf_counter() - started,
        reached=run.reached / scene.run.duration,
    )


def run_scene(
    scene: Scene, backend: str, budget: int, alive: Callable[[], None], seconds: float = math.inf
) -> Followed:
    """Follow a scene until its end, a number of steps, some full blocks of output, or a time.

    Parameters
    ----------
    scene, backend, budget, alive
        As for `judge`.
    seconds : float, optional
        Wall time after which it is left alone.

    Returns
    -------
    Followed
    """
    columns = columns_of(scene)
    rows, events = [np.empty((0, len(columns)))], [np.empty((0, EVENT_NUMBERS))]
    found = Followed(rows[0], events[0])
    started = time.perf_counter()

    def take(block: Any, statistics: Any, wall_time: float) -> None:
        rows.append(block.rows)
        events.append(block.events)
        found.steps, found.reached = int(statistics.steps), float(block.time)
        found.balance = block.balance or found.balance
        alive()
        if found.steps >= budget or len(rows) > _BLOCKS or time.perf_counter() - started > seconds:
            raise _Enough

    with contextlib.suppress(_Enough):
        ended = engine.follow(scene, take, backend=backend, on_progress=lambda time, events: alive())
        found.status, found.message = ended.status, ended.message
    found.rows, found.events = np.concatenate(rows), np.concatenate(events)
    return found


# -- motion and energy balance against a hundredth of the tolerance --------------------------------------------------


def _compared(
    scene: Scene, run: Followed, backend: str, budget: int, alive: Callable[[], None]
) -> tuple[float, float]:
    """Error up to the third impact, and the energy balance's residual there over its bound; NaN if unknown."""
    kinds = (EventKind.TURNING_POINT, EventKind.STICK, EventKind.SLIP)
    impacts = run.events[np.isin(run.events[:, 1], kinds), 0]
    horizon = float(impacts[_HORIZON_EVENTS - 1]) if len(impacts) >= _HORIZON_EVENTS else run.reached
    if not 0.0 < horizon <= scene.run.duration or run.status not in ("finished", "budget"):
        return math.nan, math.nan
    short = scene.replace({"run.duration": horizon, "run.samples": _SAMPLES})
    coarse = run_scene(short, backend, _STEPS_FINER * budget, alive, _SECONDS)
    rtol = max(scene.run.rtol / _FINER, _LEAST_RTOL)
    fine = run_scene(short.replace({"run.rtol": rtol}), backend, _STEPS_FINER * budget, alive, _SECONDS)
    if not coarse.status == fine.status == "finished" or coarse.balance is None:
        return math.nan, math.nan
    bound = coarse.balance.bound(scene.run.rtol, roller=scene.roller is not None)
    residual = abs(coarse.balance.residual)
    balance = residual / bound if bound > 0.0 else (math.inf if residual > 0.0 else 0.0)
    return _difference(scene, coarse.rows, fine.rows, horizon), balance


def _difference(scene: Scene, ours: Floats, theirs: Floats, horizon: float) -> float:
    """Largest difference of two motions over what they cover; a shift in time counts by its share of the time."""
    motions = [_motion(scene, rows) for rows in (ours, theirs)]
    spacing = horizon / (len(theirs) - 1)
    rate = np.abs(np.gradient(motions[1], spacing, axis=0))
    covered = np.ptp(motions[1], axis=0)
    covered[0] = max(covered[0], scene.surface.roughness)
    covered[1:] = np.maximum(covered[1:], np.abs(motions[1][:, 1:]).max(initial=0.0))
    allowed = covered + rate * horizon
    difference = np.abs(motions[0] - motions[1])
    return float(np.max(np.divide(difference, allowed, out=np.zeros_like(allowed), where=allowed > 0.0)))


def _motion(scene: Scene, rows: Floats) -> Floats:
    """Height or transmission error [m], and speeds along the line of action [m/s], a column each."""
    if scene.roller is not None:
        return rows[:, :2]
    geometry = scene.geometry
    gear, pinion = rows[:, 0] * geometry.base_radius_gear, rows[:, 1] * geometry.base_radius_pinion
    return np.column_stack([rows[:, 3], gear, pinion])
