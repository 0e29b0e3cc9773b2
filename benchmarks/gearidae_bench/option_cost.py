"""What options cost: coverage by tooth and place over a uniform fraction, exposures over none, hubs that age or not.

Both runs of a comparison are made in turn, in one process, many times; the result is the median ratio of the
processor time of a step. A table whose fractions are all equal gives the motion of the uniform fraction, but for
rounding: the runs make as many steps, within some in ten thousand::

    python -m gearidae_bench.option_cost 100
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping
from typing import Any, Final, NamedTuple

import numpy as np

from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics
from gearidae.scene import Scene, preset

__all__ = ["COMPARISONS", "Comparison", "Cost", "cost_table", "measure_option"]

PLACES: Final = 8
RTOL: Final = 1e-6


class Comparison(NamedTuple):
    """A scene without and with an option.

    Attributes
    ----------
    title : str
        For the table.
    plain, other : Scene
        Without the option and with it.
    """

    title: str
    plain: Scene
    other: Scene


class Cost(NamedTuple):
    """What an option costs.

    Attributes
    ----------
    title : str
    steps, other_steps : int
        Of a run without and with the option.
    nanoseconds : float
        Processor time of a step without it, median [ns].
    ratio : float
        Processor time of a step with it over one without it, median over pairs of runs.
    low, high : float
        Quartiles of this ratio.
    """

    title: str
    steps: int
    other_steps: int
    nanoseconds: float
    ratio: float
    low: float
    high: float


_PRESETS: Final = {"high": "teodorescu2009", "low": "teodorescu2009_low_speed"}


def _scene(speed: str, duration: float, changes: Mapping[str, Any]) -> Scene:
    fixed = {"contact.bodies": "rigid", "run.samples": "off", "run.duration": duration}
    return preset(_PRESETS[speed]).replace({**fixed, **changes})


def _table(speed: str, duration: float, fraction: float, pairing: str) -> Comparison:
    """Compare a table of equal fractions with the fraction."""
    plain = _scene(speed, duration, {"coating.sam_fraction": fraction, "coating.pairing": pairing})
    tables = {"coating.pinion_table": np.full((19, PLACES), fraction)}
    if pairing == "independent":
        tables["coating.gear_table"] = np.full((1, PLACES), fraction)
    return Comparison(f"table, {speed} speed, {fraction:.0%}, {pairing}", plain, plain.replace(tables))


def _exposures(speed: str, duration: float, fraction: float) -> Comparison:
    """Compare a run that keeps exposures with one that does not."""
    plain = _scene(speed, duration, {"coating.sam_fraction": fraction})
    other = plain.replace({"run.exposures": PLACES})
    return Comparison(f"exposures, {speed} speed, {fraction:.0%}", plain, other)


def _ageing(speed: str, duration: float) -> Comparison:
    """Compare hubs whose friction ages with hubs of a constant coefficient."""
    radii = {"gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}
    plain = _scene(speed, duration, {"gears.hub_friction": 0.2, **radii})
    ages = {"hub_friction_rise": 0.1, "hub_ageing_time": 1e-3, "hub_memory_length": 50e-9}
    other = plain.replace({f"gears.{key}": value for key, value in ages.items()})
    return Comparison(f"hubs that age, {speed} speed", plain, other)


COMPARISONS: Final = (
    _table("high", 1e-3, 0.6, "patches"),
    _table("high", 1e-3, 0.6, "independent"),
    _table("low", 0.3, 0.6, "patches"),
    _table("low", 1.0, 0.6, "independent"),
    _exposures("high", 1e-3, 1.0),
    _exposures("high", 1e-3, 0.6),
    _exposures("low", 1.5, 1.0),
    _exposures("low", 0.3, 0.6),
    _exposures("low", 0.3, 0.3),
    _ageing("high", 1e-3),
    _ageing("low", 0.3),
)
"""Of ten thousand to a hundred and forty thousand steps each; the last is the whole run of the preset."""


def measure_option(comparison: Comparison, pairs: int) -> Cost:
    """Run both scenes of a comparison in turn.

    Parameters
    ----------
    comparison : Comparison
    pairs : int
        How often.

    Returns
    -------
    Cost
    """
    scenes = comparison.plain, comparison.other
    steps = [_run(scene)[1] for scene in scenes]  # all is compiled and loaded
    spent = np.array([list(_turn(scenes, backwards=k % 2 == 1)) for k in range(pairs)]) / steps
    low, ratio, high = np.percentile(spent[:, 1] / spent[:, 0], [25, 50, 75])
    nanoseconds = 1e9 * float(np.median(spent[:, 0]))
    return Cost(comparison.title, steps[0], steps[1], nanoseconds, ratio, low, high)


def _turn(scenes: tuple[Scene, Scene], backwards: bool) -> Iterator[float]:
    """Processor times of both runs, whichever is made first."""
    order = (1, 0) if backwards else (0, 1)
    times = {k: _run(scenes[k])[0] for k in order}
    yield from (times[0], times[1])


def _run(scene: Scene) -> tuple[float, int]:
    """Processor time [s] and steps of a run, without what builds its tables."""
    problem, statistics = make_problem(scene), Statistics()
    started = time.thread_time()
    for _ in run_blocks(problem, RTOL, 0, "native", statistics):
        pass
    return time.thread_time() - started, statistics.steps


def cost_table(costs: list[Cost]) -> str:
    """Table in Markdown."""
    rows = ["| option | steps | ns per step | ratio | quartiles |", "|---|---:|---:|---:|---:|"]
    rows += [
        f"| {cost.title} | {cost.steps}, {cost.other_steps} | {cost.nanoseconds:.0f} | "
        f"{cost.ratio:.3f} | {cost.low:.3f} to {cost.high:.3f} |"
        for cost in costs
    ]
    return "\n".join(rows) + "\n"


def main() -> None:
    """Print the table."""
    pairs = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    words = sys.argv[2:]
    chosen = [comparison for comparison in COMPARISONS if all(word in comparison.title for word in words)]
    sys.stdout.write(cost_table([measure_option(comparison, pairs) for comparison in chosen]))


if __name__ == "__main__":
    main()
