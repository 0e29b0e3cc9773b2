"""Start-ups and brakings: run time against the errors of what their user asks for.

The scenes last from 50 ms to 10 s. What is asked for is the angle that the gear has turned by, the time in which dry
resistance holds it at rest, and the adhesion loss. Contenders alternate in one process, and their processor time
counts: each runs on one core.
"""

from __future__ import annotations

import json
import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.backend import run_blocks
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.record_types import FREE
from gearidae.engine.model.state import PHASE
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.records import EventKind, Statistics
from gearidae.scene import Scene, load_case
from gearidae_bench.contender import STEP_LENGTHS, TOLERANCES, unused
from gearidae_bench.loop import run_dop853, run_rk4
from gearidae_bench.reference import alone, end_of
from gearidae_bench.roots import FAILED, LOSS, REST, STEPS

__all__ = [
    "ALL_RUNS",
    "BROKEN_OFF",
    "CONTENDERS",
    "QUANTITIES",
    "Reached",
    "Runner",
    "StartStop",
    "Timed",
    "measure_start_stop",
    "reference_of",
    "start_stop_scenes",
]

Floats = NDArray[np.float64]

QUANTITIES: Final = ("angle", "rest", "loss")
TIGHTEST: Final = 1e-12
"""Of both methods of the reference."""
SAMPLES: Final = 1001
NUDGES: Final = tuple(k * 1e-14 for k in range(4))
"""Changes of the mesh phase [pitches] that no instrument can tell."""
NUDGED_RTOL: Final = 1e-8

_CASES: Final = Path(__file__).parents[2] / "cases"
_OWN_PAIR: Final = {
    "gears": {
        "pinion_teeth": 18,
        "gear_teeth": 54,
        "module": "3 um",
        "pressure_angle": "20 deg",
        "face_width": "2.5 um",
        "density": 2330.0,
    },
    "mesh": {"backlash": "0.25 um", "tip_relief_radius": "10 um"},
    "surface": {
        "youngs_modulus": "161 GPa",
        "poisson_ratio": 0.23,
        "energy": "1.5 J/m^2",
        "asperity_density": "169 / um^2",
        "asperity_radius": "450 nm",
        "roughness": "6 nm",
    },
    "coating": {"energy": "0.1 J/m^2", "sam_fraction": 1.0},
    "drive": {"schedule": [(0.0, 0.0), (5.0, 1.2e-17), (7.0, 1.2e-17), (9.0, 0.0)]},
    "load": {"torque": 3e-18, "drag": 8e-18},
    "initial": {"gear_speed": 0.0, "gap": "0.1 um", "mesh_phase": 0.3},
    "run": {"duration": 10.0, "samples": SAMPLES},
}


def start_stop_scenes() -> dict[str, Scene]:
    """Scenes by the names of the table's rows."""
    pair = Scene.from_dict(_OWN_PAIR)
    cases = {
        name: load_case(_CASES / f"{name}.toml").replace({"run.samples": SAMPLES})
        for name in ("start_up", "braking", "alternating")
    }
    worn = pair.replace({"coating.sam_fraction": 0.7})
    return {"18 and 54 teeth, coated, 10 s": pair, **cases, "18 and 54 teeth, 70 %, 10 s": worn}


@dataclass(frozen=True, slots=True)
class Reached:
    """What a run has come to.

    Attributes
    ----------
    angle : float
        Turned by the gear [pitches].
    rest : float
        Time in which dry resistance has held the gear [s].
    loss : float
        Adhesion loss [J]; NaN if it was not followed.
    steps : int
    """

    angle: float
    rest: float
    loss: float
    steps: int


BROKEN_OFF: Final = Reached(math.nan, math.nan, math.nan, 0)

Runner = Callable[[Problem, float], Reached]


def _energy_unit(problem: Problem) -> float:
    return float(problem.model.scene.force_unit * problem.model.scene.length_unit)


def _engine(method: str, *kept: str) -> Runner:
    """Run with the native driver and the observers of the names `kept`."""

    def run(problem: Problem, tolerance: float) -> Reached:
        problem = alone(replace(problem, method=method), *kept)
        held, duration = problem.model.state.hold != FREE, end_of(problem) * problem.time_unit
        counted = Statistics()
        blocks = list(run_blocks(problem, tolerance, SAMPLES, "native", counted))
        if counted.ending is not Ending.FINISHED:
            return BROKEN_OFF
        events = np.concatenate([block.events for block in blocks])
        changes = events[np.isin(events[:, 1], (EventKind.STICK, EventKind.SLIP)), 0]
        limits = np.concatenate([[0.0] * bool(held), changes, [duration]])  # stick and slip take turns
        even = limits[: limits.size // 2 * 2]
        rest = float(np.sum(even[1::2] - even[::2]))
        column = problem.columns.index("gear_angle")
        rows, balance = np.concatenate([block.rows for block in blocks]), blocks[-1].balance
        pitch = float(problem.model.scene.base_pitch / problem.model.scene.gear_radius)
        loss = math.nan if balance is None else float(balance.adhesion_loss)
        angle = float(rows[-1, column] - rows[0, column]) / pitch
        return Reached(angle, rest, loss, counted.steps)

    return run


def _explicit(method: str, *kept: str) -> Runner:
    """Run with a compiled explicit method, which follows the adhesion loss if `kept` has the balance."""

    def run(problem: Problem, tolerance: float) -> Reached:
        m, y, end = alone(problem, *kept).model, problem.start, end_of(problem)
        times, counts, sums = np.linspace(0.0, end, SAMPLES), np.zeros(4, np.int64), np.zeros(2)
        states, first = np.empty((SAMPLES, y.size)), float(y[PHASE])
        if method == "rk4":
            run_rk4(m, y, end, times, states, tolerance, counts, sums)
        else:
            run_dop853(m, y, end, times, states, tolerance * problem.tolerance_scale, False, counts, sums)
        if counts[FAILED]:
            return BROKEN_OFF
        loss = sums[LOSS] * _energy_unit(problem) if kept else math.nan
        return Reached(
            float(y[PHASE]) - first, float(sums[REST]) * problem.time_unit, float(loss), int(counts[STEPS])
        )

    return run


ALL_RUNS: Final = ("balance", "extremes", "passages")
"""Observers of a run as users have it."""
_LADDER: Final = TOLERANCES[:6]
_STEPS: Final = (2.0 * STEP_LENGTHS[0], 1.5 * STEP_LENGTHS[0], *STEP_LENGTHS[:3])
"""At the first, runs at full speed break off, and slow ones do not."""
CONTENDERS: Final[dict[str, tuple[Runner, tuple[float, ...]]]] = {
    "auto": (_engine("auto", *ALL_RUNS), _LADDER),
    "auto alone": (_engine("auto"), _LADDER),
    "bdf alone": (_engine("bdf"), _LADDER),
    "DOP853": (_explicit("dop853"), _LADDER),
    "RK4": (_explicit("rk4"), _STEPS),
    "DOP853 with loss": (_explicit("dop853", "balance"), _LADDER[:3]),
    "RK4 with loss": (_explicit("rk4", "balance"), _STEPS[:4]),
}
"""Runners with their ladders, from loose to tight; those `alone` have no balance, extremes and passages."""


@dataclass(slots=True)
class Timed:
    """A contender at a tolerance (or a step over tau) on a scene.

    Attributes
    ----------
    scene, contender : str
    tolerance : float
    reached : Reached
    times : list of float
        Processor time of each repeat [s].
    """

    scene: str
    contender: str
    tolerance: float
    reached: Reached
    times: list[float]

    @property
    def time(self) -> float:
        """Median [s]."""
        return statistics.median(self.times)


@dataclass(slots=True)
class StartStop:
    """All that was measured.

    Attributes
    ----------
    date : str
    references : dict
        By scene, what ``auto`` and ``bdf`` come to at `TIGHTEST`.
    timed : list of Timed
    losses : dict
        By scene, adhesion losses [J] of runs whose mesh phases differ by `NUDGES`.
    """

    date: str
    references: dict[str, dict[str, Reached]] = field(default_factory=dict)
    timed: list[Timed] = field(default_factory=list)
    losses: dict[str, list[float]] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write everything as JSON."""
        path.write_text(json.dumps(asdict(self), indent=1) + "\n")

    @classmethod
    def load(cls, path: Path) -> StartStop:
        """Read what `save` wrote."""
        stored = json.loads(path.read_text())
        references = {
            scene: {method: Reached(**reached) for method, reached in both.items()}
            for scene, both in stored["references"].items()
        }
        timed = [Timed(**{**entry, "reached": Reached(**entry["reached"])}) for entry in stored["timed"]]
        return cls(stored["date"], references, timed, stored["losses"])


def reference_of(scene: Scene) -> dict[str, Reached]:
    """What both methods come to at `TIGHTEST`."""
    return {method: _engine(method, "balance")(make_problem(scene), TIGHTEST) for method in ("auto", "bdf")}


def measure_start_stop(
    scenes: dict[str, Scene],
    rounds: int = 3,
    share: float = 4.0,
    report: Callable[[str], object] = lambda _: None,
    contenders: Sequence[str] = tuple(CONTENDERS),
    ladders: slice = slice(None),
) -> StartStop:
    """Measure contenders on scenes.

    Parameters
    ----------
    scenes : dict of str to Scene
    rounds : int, optional
        In which all runs of a scene take turns.
    share : float, optional
        A run is repeated, round by round, until that much processor time is spent on it [s].
    report : callable, optional
        Called with words about what is being measured.
    contenders : sequence of str, optional
        Names of `CONTENDERS`.
    ladders : slice, optional
        Part of each ladder.
    """
    result = StartStop(datetime.now(UTC).isoformat(timespec="seconds"))
    for name, scene in scenes.items():
        report(f"{name}: references")
        result.references[name] = reference_of(scene)
        problem, timed = make_problem(scene), []
        for contender in contenders:
            runner, ladder = CONTENDERS[contender]
            runner(unused(problem), ladder[0])  # compiled, or read from disk
            for tolerance in ladder[ladders]:
                report(f"{name}: {contender}, {tolerance:.2g}")
                seconds, reached = _timed(runner, problem, tolerance)
                timed.append(Timed(name, contender, tolerance, reached, [seconds]))
        for number in range(1, rounds):
            report(f"{name}: round {number + 1} of {rounds}")
            for entry in timed:
                if math.fsum(entry.times) < share:
                    runner = CONTENDERS[entry.contender][0]
                    entry.times.append(_timed(runner, problem, entry.tolerance)[0])
        result.timed += timed
        report(f"{name}: phases")
        result.losses[name] = [_nudged_loss(scene, nudge) for nudge in NUDGES]
    return result


def _timed(runner: Runner, problem: Problem, tolerance: float) -> tuple[float, Reached]:
    copy = unused(problem)
    started = time.process_time()
    reached = runner(copy, tolerance)
    return time.process_time() - started, reached


def _nudged_loss(scene: Scene, nudge: float) -> float:
    """Adhesion loss of a run whose gear begins a little farther on [J]."""
    assert scene.initial is not None
    other = scene.replace({"initial.mesh_phase": scene.initial.mesh_phase + nudge})
    return CONTENDERS["auto"][0](make_problem(other), NUDGED_RTOL).loss
