"""One window of a life: some mesh cycles at a frozen coverage, and what the flanks are exposed to in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearidae import engine
from gearidae.engine.energy.exposures import PRESSURE, QUANTITIES
from gearidae.errors import SolverError
from gearidae.runs.estimates import steady_speed
from gearidae.runs.running import solve, unsolved

if TYPE_CHECKING:
    from gearidae.records import Extremes, Solution
    from gearidae.scene import Scene

__all__ = ["Cycles", "run_window", "window_scene"]

_PATIENCE = 3.0
"""Time that a window gets, over that of its cycles at the steady speed."""


@dataclass(frozen=True, slots=True)
class Cycles:
    """Mesh cycles of a window: those that it takes to settle, and those that count."""

    settle: int
    count: int

    @property
    def total(self) -> int:
        """All of them."""
        return self.settle + self.count


def window_scene(scene: Scene, cycles: Cycles, places: int) -> Scene:
    """Return the scene of a window: it ends after its cycles, and keeps the exposures."""
    assert scene.gears is not None
    assert scene.initial is not None
    speed = steady_speed(scene)
    if not 0.0 < speed < math.inf:
        speed = scene.initial.gear_speed
    duration = _PATIENCE * cycles.total * 2.0 * math.pi / (scene.gears.gear_teeth * speed)
    return scene.replace(
        {
            "run.exposures": places,
            "run.samples": "off",
            "run.checkpoints": [],
            "run.duration": duration,
            "run.stop": f"turns {cycles.total / scene.gears.gear_teeth!r}",
            "name": f"window of {cycles.count} mesh cycles after {cycles.settle}",
        }
    )


def run_window(scene: Scene, cycles: Cycles, backend: str) -> tuple[Solution, bool]:
    """Run a window.

    Parameters
    ----------
    scene : Scene
        From `window_scene`.
    cycles : Cycles
    backend : str
        As for `simulate`.

    Returns
    -------
    solution : Solution
        Of the whole window, without events; its exposures are those of the cycles that count, if they were passed.
    sticks : bool
        Whether the gear has come to stand, or has not passed the cycles in its time.

    Raises
    ------
    SolverError
        If a run could not be finished.
    """
    assert scene.gears is not None
    teeth = scene.gears.gear_teeth
    if cycles.settle == 0:
        found = _solved(scene, backend)
        return _bare(found), _sticks(found, scene)
    first = scene.replace({"run.stop": f"turns {cycles.settle / teeth!r}"})
    settled = _solved(first, backend)
    if _sticks(settled, first) or settled.checkpoint is None:
        return _bare(settled), True
    counted = scene.replace({"run.stop": f"turns {cycles.count / teeth!r}"})
    found = _solved(counted, backend, engine.end_of(first, settled.checkpoint, 0.0))
    assert found.extremes is not None
    assert settled.extremes is not None
    extremes = _less(found.extremes, settled.extremes, scene)
    return _bare(replace(found, extremes=extremes)), _sticks(found, counted)


def _sticks(solution: Solution, scene: Scene) -> bool:
    """Whether the gear stands at the end of a run that was to end after some turns, or has not turned so far."""
    found, reached = solution.extremes, solution.reached or 0.0
    late = reached - solution.start >= scene.run.duration * (1.0 - 1e-9)
    return found is None or not math.isnan(found.stick_time) or late


def _solved(scene: Scene, backend: str, origin: engine.Origin | None = None) -> Solution:
    solution = solve(scene, backend, origin=origin)
    if solution.extremes is None or solution.status != "finished":
        raise SolverError(
            f"a window of the life could not be finished: {solution.message or solution.status}",
            time=solution.reached or 0.0,
            state={},
            last_event="not kept",
            advice="try another rtol (run.rtol)",
        )
    return solution


def _less(whole: Extremes, settled: Extremes, scene: Scene) -> Extremes:
    """Take what the cycles of settling have added out of the sums; largest pressures are those of all cycles."""
    places = scene.run.exposures
    ours, theirs = (np.array(each.exposures).reshape(-1, QUANTITIES, places) for each in (whole, settled))
    theirs[:, PRESSURE] = 0.0
    return replace(whole, exposures=tuple((ours - theirs).ravel().tolist()))


def _bare(solution: Solution) -> Solution:
    """Leave out what a life has no use for."""
    return replace(solution, events=unsolved("", "").events, checkpoint=None)
