"""Requested and achieved accuracy: every shipped case at many tolerances, against references of another method.

The cases that need seconds of simulated time are shortened: the low speed to 20 ms, the high speed to 0.5 ms, and
run-up, braking and alternation to a hundredth of their time, torque schedules included. References are those of the
benchmark, Gauss-Legendre collocation with a step's end at every event, which also follows stick, slip and schedule
knots. With elastic bodies the equations are algebraic in part, which that method does not solve: there the
reference is a run of the engine's own at the tightest tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine import solve
from gearidae.records import EventKind
from gearidae.runs.executors import own_executor
from gearidae.scene import Scene, preset
from gearidae_bench.error import run_error
from gearidae_bench.reference import TOLERANCE, solve_with
from gearidae_bench.scenes import SAMPLES, BenchScene

__all__ = ["COATINGS", "RTOLS", "SHORTENED", "Achieved", "accuracy_scenes", "measure_accuracy"]

Floats = NDArray[np.float64]

RTOLS: Final = tuple(10.0**-k for k in range(3, 10))
COATINGS: Final = {"whole": 1.0, "worn": 0.6, "bare": 0.0}
SHORTENED: Final = 0.01
"""What is left of the time of run-up, braking and alternation."""
OWN_TOLERANCES: Final = 1e-12, 1e-11
"""Tolerances of the reference with elastic bodies, and of its check."""

_HIGH_TORQUE = 2.43e-11  # [N m], that of the high-speed case
_STEP = 1.63e-11  # [N m], between the two levels of the alternation
_REST = {"drive.harmonic": [], "initial.gear_speed": 0.0, "initial.gap": 1e-7}


@dataclass(frozen=True, slots=True)
class Achieved:
    """What came of one scene.

    Attributes
    ----------
    title : str
    reference : str
        How its reference was made.
    own_error : float
        Of the reference: its difference from a second one.
    turning_points : int
        Turning points of the gaps.
    errors : tuple of float
        At each of `RTOLS`, as `gearidae_bench.error.run_error` measures them; infinite where the run ended early.
    """

    title: str
    reference: str
    own_error: float
    turning_points: int
    errors: tuple[float, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """Error over tolerance, at each of `RTOLS`."""
        return tuple(error / rtol for error, rtol in zip(self.errors, RTOLS, strict=True))


def accuracy_scenes() -> tuple[BenchScene, ...]:
    """All shipped cases in three states of the coating, shortened; rollers with rigid and elastic bodies."""
    high = preset("teodorescu2009")
    milli = 1e-3 * SHORTENED
    alternation = [(0, _STEP), (20, _STEP), (21, 0), (40, 0), (41, _STEP), (60, _STEP), (61, 0), (80, 0)]
    gears = {
        "low speed": preset("teodorescu2009_low_speed").replace({"run.duration": 0.02}),
        "high speed": high.replace({"run.duration": 0.5e-3}),
        "run-up": high.replace(
            _REST
            | {"drive.torque": 0.0, "drive.schedule": _knots(milli, [(0, 0.0), (10, _HIGH_TORQUE)])}
            | {"run.duration": 50 * milli}
        ),
        "braking": high.replace(
            {"drive.torque": 0.0, "drive.harmonic": [], "run.duration": 50 * milli}
            | {"drive.schedule": _knots(milli, [(0, _HIGH_TORQUE), (10, _HIGH_TORQUE), (30, 0.0)])}
        ),
        "alternation": high.replace(
            _REST
            | {"drive.torque": 0.8e-11, "drive.schedule": _knots(milli, [*alternation, (81, _STEP)])}
            | {"run.duration": 100 * milli}
        ),
    }
    rollers = {
        f"{name} roller, {bodies} bodies": preset(f"roller_{name}").replace({"contact.bodies": bodies})
        for name in ("slow", "fast")
        for bodies in ("rigid", "elastic")
    }
    scenes = gears | rollers
    return tuple(
        BenchScene(f"{name}, {coating}", f"{name}, {coating}", _sampled(scene, fraction))
        for name, scene in scenes.items()
        for coating, fraction in COATINGS.items()
    )


def _knots(milli: float, points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(time * milli, torque) for time, torque in points]


def _sampled(scene: Scene, fraction: float) -> Scene:
    return scene.replace({"coating.sam_fraction": fraction, "run.samples": SAMPLES})


def measure_accuracy(
    scenes: tuple[BenchScene, ...], jobs: int = 1, report: Callable[[int], None] | None = None
) -> list[Achieved]:
    """Run scenes at all tolerances and hold each against its reference.

    Parameters
    ----------
    scenes : tuple of BenchScene
    jobs : int, optional
        Scenes at a time.
    report : callable, optional
        Called now and then with how many are done.

    Returns
    -------
    list of Achieved

    Raises
    ------
    SolverError
        If there is no reference for one of them.
    """
    achieved: list[Achieved] = []
    with own_executor(jobs, len(scenes), releases_gil=True) as executor:
        results = map(_measure, scenes) if executor is None else executor.map(_measure, scenes)
        for result in results:
            achieved.append(result)
            if report is not None:
                report(len(achieved))
    return achieved


def _measure(bench: BenchScene) -> Achieved:
    scene = bench.scene
    length = scene.surface.roughness
    run = partial(_run, scene)
    _, _, tightest, deflected = run(RTOLS[-1])
    if deflected:
        how = f"itself, tolerance {OWN_TOLERANCES[0]:.0e}"
        reference, check = (run(rtol)[:2] for rtol in OWN_TOLERANCES)
    else:
        how = "Gauss-Legendre"
        exact = BenchScene(bench.name, bench.title, scene.replace({"run.rtol": TOLERANCE}))
        reference, check = (
            solve_with(exact, "gauss", tolerance)[1:] for tolerance in (TOLERANCE, 0.1 * TOLERANCE)
        )
    errors = tuple(run_error(*reference, *run(rtol)[:2], length) for rtol in RTOLS)
    return Achieved(bench.title, how, run_error(*reference, *check, length), tightest, errors)


def _run(scene: Scene, rtol: float) -> tuple[Floats, Floats, int, bool]:
    """Speed, position, number of turning points, and whether bodies gave way."""
    run = solve(scene, rtol=rtol)
    names = ("speed", "height") if scene.roller else ("gear_speed", "transmission_error")
    speed, position = (run.samples[name] for name in names)
    turned = int(np.count_nonzero(run.events.kind == EventKind.TURNING_POINT))
    return speed, position, turned, not run.statistics.skipped["elastic_deflection"]
