"""What each default of a run costs beside the integrator alone: balance, extremes, passages, and all of them.

The runs of a scene, one without any observer and one with each choice of them, take turns in one process; a ratio is
the median over rounds of the processor time of a run over that of the run without in the same round. Observers change
no state, so that the error of the motion is one number a scene; beside it stands what the observers add, the residual
of the balance over its bound::

    python -m gearidae_bench.default_cost 7
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.records import Statistics
from gearidae.scene import Scene, preset
from gearidae_bench.reference import alone
from gearidae_bench.start_stop import start_stop_scenes

__all__ = ["CHOICES", "DefaultCost", "default_scenes", "default_table", "measure_defaults"]

CHOICES: Final[dict[str, tuple[str, ...]]] = {
    "balance": ("balance",),
    "extremes": ("extremes", "gear"),
    "passages": ("passages",),
    "all": ("balance", "extremes", "passages", "gear"),
}
"""Observers by the column of the table; where a gear stands is followed with the extremes."""
RTOL: Final = 1e-6
SAMPLES: Final = 2
"""The start and the end."""
TIGHTER: Final = 1e-2
"""Of the tolerance, for the run against which the angle is compared."""


class DefaultCost(NamedTuple):
    """What the defaults cost on one scene.

    Attributes
    ----------
    scene : str
    steps : int
    nanoseconds : float
        Processor time of a step of the integrator alone, median [ns].
    ratios : dict of str to float
        Of processor times, by the names of `CHOICES`.
    angle : float
        Difference of the gear's last angle to that at a hundredth of the tolerance [pitches].
    residual : float
        Residual of the balance over its bound.
    """

    scene: str
    steps: int
    nanoseconds: float
    ratios: dict[str, float]
    angle: float
    residual: float


def default_scenes() -> dict[str, Scene]:
    """Scenes by the names of the table's rows: starts, stops, and both speeds of the benchmark's gears."""
    starts = start_stop_scenes()
    scenes = {
        "start_up, 25 ms": starts["start_up"].replace({"run.duration": 25e-3}),
        "braking, 10 ms": starts["braking"].replace({"run.duration": 10e-3}),
        "18 and 54 teeth, coated, 10 s": starts["18 and 54 teeth, coated, 10 s"],
        "low speed, 50 ms": preset("teodorescu2009_low_speed").replace({"run.duration": 50e-3}),
        "high speed, 1 ms": preset("teodorescu2009").replace({"run.duration": 1e-3}),
    }
    return {name: scene.replace({"run.samples": SAMPLES}) for name, scene in scenes.items()}


class _Run(NamedTuple):
    """Processor time [s], steps, last angle [pitches], and residual of the balance over its bound."""

    time: float
    steps: int
    angle: float
    residual: float


def _run(problem: Problem, rtol: float) -> _Run:
    counted = Statistics()
    started = time.thread_time()
    blocks = list(run_blocks(problem, rtol, SAMPLES, "native", counted))
    spent = time.thread_time() - started
    balance, scene = blocks[-1].balance, problem.model.scene
    residual = math.nan if balance is None else abs(balance.residual) / balance.bound(rtol, roller=False)
    angles = np.concatenate([block.rows for block in blocks])[:, problem.columns.index("gear_angle")]
    turned = float((angles[-1] - angles[0]) * scene.gear_radius / scene.base_pitch)
    return _Run(spent, counted.steps, turned, residual)


def measure_defaults(scenes: dict[str, Scene], rounds: int) -> list[DefaultCost]:
    """Run each scene with every choice of observers, in turn.

    Parameters
    ----------
    scenes : dict of str to Scene
    rounds : int
        Runs of each choice; the order is turned round in every second round.
    """
    return [_measure(name, scene, rounds) for name, scene in scenes.items()]


def _measure(name: str, scene: Scene, rounds: int) -> DefaultCost:
    choices: dict[str, Sequence[str]] = {"none": (), **CHOICES}
    first = {choice: _run(alone(make_problem(scene), *kept), RTOL) for choice, kept in choices.items()}
    times: dict[str, list[float]] = {choice: [] for choice in choices}
    for number in range(rounds):
        for choice in list(choices)[:: 1 if number % 2 == 0 else -1]:
            times[choice].append(_run(alone(make_problem(scene), *choices[choice]), RTOL).time)
    without = np.array(times["none"])
    tight = _run(alone(make_problem(scene)), TIGHTER * RTOL)
    steps = first["none"].steps
    return DefaultCost(
        name,
        steps,
        1e9 * float(np.median(without)) / steps,
        {choice: float(np.median(np.array(times[choice]) / without)) for choice in CHOICES},
        abs(first["none"].angle - tight.angle),
        first["all"].residual,
    )


def default_table(costs: Sequence[DefaultCost]) -> str:
    """Table in Markdown."""
    rows = [
        (
            f"| scene | steps | ns per step alone | {' | '.join(CHOICES)} "
            "| error of the angle [pitches] | residual / bound |"
        ),
        "|---|" + "---:|" * (4 + len(CHOICES)),
    ]
    for cost in costs:
        ratios = " | ".join(f"{cost.ratios[choice]:.2f}" for choice in CHOICES)
        rows.append(
            f"| {cost.scene} | {cost.steps} | {cost.nanoseconds:.0f} | {ratios} | "
            f"{cost.angle:.1e} | {cost.residual:.2g} |"
        )
    return "\n".join(rows) + "\n"


def main() -> None:
    """Print the table."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    words = sys.argv[2:]
    scenes = {
        name: scene
        for name, scene in default_scenes().items()
        if not words or any(word in name for word in words)
    }
    sys.stdout.write(default_table(measure_defaults(scenes, rounds)))


if __name__ == "__main__":
    main()
