r"""Does IDA step, test errors and interpolate as the native driver believes? Asked once, of a motion in closed form.

The driver takes the place of some of IDA's parts: its iteration, the weights that it judges steps by, the solver of its
equations. Where these parts are found is probed (`gearidae.engine.sundials.names`); what IDA does with them is seen
here. The motion is that of a gear pair in flight, shaken by a torque M cos(omega t) on the pinion: no contact, no
resistance, so that with :math:`a = M R_1 / (I_1 \omega^2)`

.. math::

    u(t) = u_0 + a\,(1 - \cos\omega t), \qquad R_1 \dot\varphi_1 - R_2 \dot\varphi_2 = a\,\omega\,\sin\omega t,

and the gear turns steadily, through the marks of its mesh at known times. It runs through the driver itself.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from contextlib import suppress
from functools import cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import cache_folder, is_cached
from gearidae.engine import native
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.records import EVENT, EventKind, Statistics
from gearidae.scene import GearScene

TRIED: Final = ("linux",)
"""Systems on which the driver has been run; on others the first trial is made in a process of its own."""
TRIAL: Final = f"import sys; from {__name__} import examine; sys.stdout.write('seen:' + examine(sys.argv[1]))"
"""Program of that process."""
APART_SECONDS: Final = 900.0
"""Longest time for that [s], which includes compiling."""
FREQUENCY: Final = 1e5  # [Hz]
PERIODS: Final = 6
SAMPLES: Final = 601
COARSE, FINE = 1e-5, 1e-8  # relative tolerances
MARKS: Final = 0.01  # of a tolerance: how far a mark's time may be out, the gear's speed being steady


class Expected(NamedTuple):
    """What runs by these formulas show.

    Attributes
    ----------
    error : float
        Largest error of a sample, in tolerances, at most.
    steps : tuple of two ints
        With the finer tolerance, at least and at most.
    gain : float
        By how much the error falls at least with a thousandth of the tolerance.
    order : int
        Former rates that Adams' formula uses at the end, at least.
    """

    error: float
    steps: tuple[int, int]
    gain: float
    order: int


# Seen with SUNDIALS 7.9: errors of 4 and 5 tolerances, 275 steps and order 8; with IDA's own formulas, which keep to a
# part of the tolerance, of 6 and 5, and 1690 steps. A part that IDA ignores changes one of them by a factor of ten.
EXPECTED: Final = {
    "adams": Expected(50.0, (150, 500), 50.0, 5),
    "bdf": Expected(500.0, (900, 3000), 20.0, 0),
}


class TrialResult(NamedTuple):
    """One run of the motion.

    Attributes
    ----------
    status : str
        How it ended.
    error : float
        Largest error of a sample, in tolerances.
    marks : float
        Largest error of a mark's time, over the run's duration and the relative tolerance; infinite if one is missing.
    steps, order : int
        Steps, and former rates in use at the end.
    """

    status: str
    error: float
    marks: float
    steps: int
    order: int


@cache
def failure(way: str) -> str:
    """Say what does not behave as it should; an empty string if all does. What is seen is kept with the compiled code.

    Parameters
    ----------
    way : {"adams", "bdf"}
        The formulas to test: Adams' in the place of IDA's own, or IDA's own throughout.
    """
    note = cache_folder() / "self_test.json"
    kept: dict[str, str] = {}
    with suppress(OSError, ValueError, AttributeError):  # of a note that has been damaged
        kept = {name: said for name, said in json.loads(note.read_text()).items() if isinstance(said, str)}
    if way not in kept:
        kept[way] = examine(way) if sys.platform in TRIED else examine_apart(way)
        if is_cached():
            with suppress(OSError):
                note.write_text(json.dumps(kept))
    return kept[way]


def examine_apart(way: str) -> str:
    """Do `examine` in a process of its own, which alone ends if a system lays out its memory in another way.

    Parameters
    ----------
    way : {"adams", "bdf"}

    Returns
    -------
    str
        What `examine` says there, or how the process has ended.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-c", TRIAL, way],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=APART_SECONDS,
            check=False,
        )
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        return f"no process could try it ({type(error).__name__})"
    _, answered, seen = done.stdout.partition("seen:")
    if done.returncode != 0 or not answered:
        return f"the process that tried it ended with code {done.returncode}"
    return seen


def examine(way: str) -> str:
    """Run the motion at two tolerances, and say what does not behave as it should; an empty string if all does."""
    expected = EXPECTED[way]
    coarse, fine = (_run(way, rtol) for rtol in (COARSE, FINE))
    for seen in (coarse, fine):
        if seen.status != "finished":
            return f"a run ends with {seen.status}"
        if not seen.error <= expected.error:
            return f"samples are {seen.error:.3g} tolerances out, and not {expected.error:g} at most"
        if not seen.marks <= MARKS:
            return f"marks of the mesh are found {seen.marks:.3g} tolerances out"
    least, most = expected.steps
    if not least <= fine.steps <= most:
        return f"{fine.steps} steps are taken, and not {least} to {most}"
    if fine.order < expected.order:
        return f"the order stays at {fine.order}, below {expected.order}"
    gain = coarse.error * COARSE / (fine.error * FINE)
    if not gain >= expected.gain:
        return (
            f"with a thousandth of the tolerance the error falls by {gain:.3g}, and not by {expected.gain:g}"
        )
    return ""


def _scene() -> GearScene:
    """Make a gear pair in flight, its teeth far apart."""
    return GearScene.from_dict(
        {
            "name": "self-test",
            "gears": {
                "pinion_inertia": 1.5e-20,
                "gear_inertia": 6e-20,
                "pinion_base_radius": 35e-6,
                "pinion_teeth": 20,
                "gear_teeth": 80,
                "pressure_angle": math.radians(20.0),
                "face_width": 2e-6,
            },
            "mesh": {"backlash": 0.4e-6, "tip_relief_radius": 10e-6, "radius_force": False},
            "surface": {
                "youngs_modulus": 161e9,
                "poisson_ratio": 0.23,
                "energy": 0.1,
                "asperity_density": 1.7e14,
                "asperity_radius": 450e-9,
                "roughness": 6e-9,
            },
            "contact": {"bodies": "rigid"},
            "drive": {"harmonic": {"amplitude": 3e-12, "frequency": FREQUENCY}},
            "initial": {"gear_speed": 4000.0, "gap": 0.2e-6, "mesh_phase": 0.3},
            "run": {"duration": PERIODS / FREQUENCY, "samples": SAMPLES, "rtol": COARSE},
        }
    )


def _run(way: str, rtol: float) -> TrialResult:
    """Run the motion, and compare it with the closed form."""
    scene, statistics = _scene(), Statistics()
    problem = make_problem(scene)
    options: dict[str, Any] = {"as_ida": True} if way == "bdf" else {}
    blocks = list(native.run(problem, rtol, SAMPLES, statistics, **options))
    rows = np.concatenate([block.rows for block in blocks])
    events = np.concatenate([block.events for block in blocks])
    order = int(problem.model.work.adams.order_used)
    if statistics.ending.status != "finished" or len(rows) != SAMPLES:
        return TrialResult(statistics.ending.status, math.inf, math.inf, statistics.steps, order)
    error = _error(scene, problem, rows) / rtol
    return TrialResult("finished", error, _mark_error(scene, events) / rtol, statistics.steps, order)


def _error(scene: GearScene, problem: Problem, rows: NDArray[np.float64]) -> float:
    """Largest error of all samples, over what counts as one."""
    m, omega = problem.model.scene, 2.0 * math.pi * FREQUENCY
    ratio = float(m.gear_radius / m.pinion_radius)
    amplitude = scene.drive.harmonic[0].amplitude
    swing = amplitude * scene.gears.pinion_base_radius / (scene.gears.pinion_inertia * omega**2)
    angle = omega * np.linspace(0.0, scene.run.duration, SAMPLES)
    length, speed = float(m.length_unit), float(m.length_unit / m.time_unit)
    column = dict(zip(problem.columns, rows.T, strict=True))
    radius, steady = scene.gears.pinion_base_radius, scene.initial.gear_speed
    slip = radius * (column["pinion_speed"] - ratio * steady) - swing * omega * np.sin(angle)
    gap = column["drive_gap"] - scene.initial.gap + swing * (1.0 - np.cos(angle))
    gear = (column["gear_speed"] - steady) * radius * ratio
    return float(max(abs(gap).max() / length, abs(slip).max() / speed, abs(gear).max() / speed))


def _mark_error(scene: GearScene, events: NDArray[np.float64]) -> float:
    """Largest error of the times at which pairs enter the mesh, over the run's duration; infinite if one is missing."""
    period = 2.0 * math.pi / scene.gears.gear_teeth / scene.initial.gear_speed
    entries = events[(events[:, EVENT.kind] == EventKind.MESH_ENTRY) & (events[:, EVENT.flank] == 0)]
    wanted = (np.arange(1, math.ceil(scene.run.duration / period + 1.0)) - scene.initial.mesh_phase) * period
    wanted = wanted[wanted < scene.run.duration]
    if len(entries) != len(wanted) or list(entries[:, EVENT.pair]) != list(range(1, len(wanted) + 1)):
        return math.inf
    return float(abs(entries[:, EVENT.time] - wanted).max() / scene.run.duration)
