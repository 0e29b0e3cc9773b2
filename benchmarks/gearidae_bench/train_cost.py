"""What trains cost: a chain of two meshes, an idle second mesh and sixteen shafts, over a pair of gears.

All are run in turn, in one process, many times; the result is the median ratio of the processor time, of a run and of
an evaluation of the equations of motion. The same teeth, torques and tolerance, but other integrators: a pair takes
implicit formulas with few evaluations, each with its slopes, and a train an explicit one with many::

    python -m gearidae_bench.train_cost 20
"""

from __future__ import annotations

import math
import sys
import time
from typing import Any, Final, NamedTuple

import numpy as np

from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.engine.train.build import make_train
from gearidae.engine.train.solve import follow_train
from gearidae.records import Statistics
from gearidae.scene import Scene, is_long_train, require_gears

__all__ = ["TRAINS", "Cost", "cost_table", "measure_trains"]

RTOL: Final = 1e-6
_TEETH: Final = {19: 9.6e-21, 38: 1.536e-19, 76: 4.2e-18}
"""Moments of inertia of the gears of a microengine by their teeth [kg m^2]."""


class Cost(NamedTuple):
    """What the run of a train costs.

    Attributes
    ----------
    title : str
    steps, evaluations : int
        Of a run.
    milliseconds, nanoseconds : float
        Processor time of a run [ms] and of an evaluation [ns], medians.
    run, evaluation : float
        Both over those of the pair, medians over rounds.
    low, high : float
        Quartiles of the ratio of runs.
    """

    title: str
    steps: int
    evaluations: int
    milliseconds: float
    nanoseconds: float
    run: float
    evaluation: float
    low: float
    high: float


def _train(teeth: tuple[int, ...], load: dict[str, Any], speed: float, **meshes: dict[str, Any]) -> Scene:
    """Gears one after the other; tables of meshes by ``m1``, ``m2``."""
    shafts = {f"s{k}": {"teeth": z, "inertia": _TEETH[z]} for k, z in enumerate(teeth)}
    chain = {
        f"m{k}": {"driver": f"s{k - 1}", "driven": f"s{k}", "angle": 0.7 * (k % 2)} | meshes.get(f"m{k}", {})
        for k in range(1, len(teeth))
    }
    return Scene.from_dict(
        {
            "name": f"{len(teeth)} shafts",
            "shafts": shafts,
            "meshes": chain,
            "mesh": {
                "module": 2.0 * 34.715e-6 / (19 * math.cos(math.radians(20.0))),
                "pressure_angle": "20 deg",
                "face_width": "2.25 um",
                "backlash": "0.5 um",
                "tip_relief_radius": "10 um",
                "damping": 3e-6,
                "radius_force": False,
            },
            "surface": {
                "youngs_modulus": "161 GPa",
                "poisson_ratio": 0.23,
                "energy": "1.2 J/m^2",
                "asperity_density": "169 / um^2",
                "asperity_radius": "130 nm",
                "roughness": "6 nm",
            },
            "coating": {"sam_fraction": 1.0, "energy": "0.02 J/m^2"},
            "contact": {"bodies": "rigid"},
            "drive": {"torque": 1.2e-11},
            "load": load,
            "initial": {"gear_speed": speed, "gap": "36 nm"},
            "run": {"duration": 3e-4, "samples": "off", "rtol": RTOL},
        }
    )


_APART: Final = {"backlash": "4 um", "offset": 2e-6 - 36e-9, "damping": 0.0}
_OUTPUT: Final = {"torque": 3e-11, "drag": 8e-18}
TRAINS: Final = {
    "pair, 19 and 76 teeth": _train((19, 76), _OUTPUT, 940.0),
    "chain of two meshes, 19, 38 and 76 teeth": _train((19, 38, 76), _OUTPUT, 940.0),
    "pair, 19 and 38 teeth": _train((19, 38), {"torque": 1.5e-11, "drag": 1e-18}, 1880.0),
    "the same with an idle second mesh, 2 um apart": _train(
        (19, 38, 76), {"torque": 1.5e-11, "drag": 1e-18, "shaft": "s1"}, 1880.0, m2=_APART
    ),
    "16 shafts, 15 meshes of 19 and 38 teeth": _train(
        (19, 38) * 8, {"torque": 1.5e-11, "drag": 1e-18}, 1880.0
    ),
}
"""Over 0.3 ms each. The idle mesh never touches: its gear turns on at its own speed."""


def measure_trains(rounds: int, trains: dict[str, Scene] = TRAINS) -> list[Cost]:
    """Run all scenes in turn, every round from another one on.

    Parameters
    ----------
    rounds : int
        How often.
    trains : dict of str to Scene
        The first one is what the others are compared with.

    Returns
    -------
    list of Cost
    """
    titles = list(trains)
    counts = [_run(scene)[1:] for scene in trains.values()]  # all is compiled and loaded
    spent = np.empty((rounds, len(titles)))
    for k in range(rounds):
        for step in range(len(titles)):
            place = (step + k) % len(titles)
            spent[k, place] = _run(trains[titles[place]])[0]
    costs = []
    for place, (title, (steps, evaluations)) in enumerate(zip(titles, counts, strict=True)):
        ratio = spent[:, place] / spent[:, 0]
        low, middle, high = np.percentile(ratio, [25, 50, 75])
        median = float(np.median(spent[:, place]))
        each = middle * counts[0][1] / evaluations
        costs.append(
            Cost(title, steps, evaluations, 1e3 * median, 1e9 * median / evaluations, middle, each, low, high)
        )
    return costs


def _run(scene: Scene) -> tuple[float, int, int]:
    """Processor time [s], steps and evaluations of a run, without what builds its tables."""
    if is_long_train(scene):
        train = make_train(scene)
        started = time.thread_time()
        statistics = follow_train(train, "native").statistics
        return time.thread_time() - started, statistics.steps, statistics.residual_evaluations
    problem, statistics = make_problem(require_gears(scene)), Statistics()
    started = time.thread_time()
    for _ in run_blocks(problem, RTOL, 0, "native", statistics):
        pass
    return time.thread_time() - started, statistics.steps, statistics.residual_evaluations


def cost_table(costs: list[Cost]) -> str:
    """Table in Markdown."""
    rows = [
        "| 0.3 ms of | steps | evaluations | ms | ns per evaluation | run / pair | quartiles | evaluation / pair |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    rows += [
        f"| {cost.title} | {cost.steps} | {cost.evaluations} | {cost.milliseconds:.3g} | "
        f"{cost.nanoseconds:.0f} | {cost.run:.2f} | {cost.low:.2f} to {cost.high:.2f} | {cost.evaluation:.2f} |"
        for cost in costs
    ]
    return "\n".join(rows) + "\n"


def main() -> None:
    """Print the table."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    sys.stdout.write(cost_table(measure_trains(rounds)))


if __name__ == "__main__":
    main()
