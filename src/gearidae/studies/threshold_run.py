"""One run of `gearidae.studies.sticking_threshold`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gearidae.analysis.verdict.judge import has_stuck, is_scheduled
from gearidae.errors import SceneError, SolverError
from gearidae.runs.running import solve_to_end, unfinished, unsolved
from gearidae.scene.keys import scene_value

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import Scene

_LONGEST = 8.0
"""A slow gear gets up to this many times the time; what it has not passed then counts as not passed."""


@dataclass(frozen=True, slots=True)
class ThresholdRun:
    """Result of one run.

    Attributes
    ----------
    value : float
        Of the key, in SI units.
    passed : int
        Mesh exits until the gear stuck, or the run was over.
    stick_time : float
        When it stuck [s]; NaN if it has not.
    window : float
        Simulated time [s].
    failure : SolverError or None
        Why the run could not be finished: it says nothing of the gear then.
    """

    value: float
    passed: int
    stick_time: float
    window: float
    failure: SolverError | None = None

    @classmethod
    def of(cls, value: float, solution: Solution) -> ThresholdRun:
        """Read a solution."""
        extremes = solution.extremes
        if extremes is None or solution.status != "finished":
            failure = unfinished(solution, f"the run at {value:g}")
            return cls(value, 0, math.nan, solution.reached or 0.0, failure)
        if not has_stuck(extremes):
            return cls(value, extremes.mesh_exits, math.nan, solution.reached or 0.0)
        time = extremes.back_time if math.isnan(extremes.stick_time) else extremes.stick_time
        return cls(value, extremes.stick_exits, time, solution.reached or 0.0)


def run_until(scene: Scene, exits: int, backend: str) -> tuple[Solution, str]:
    """Run a scene until the gear has stuck or passed so many exits, without its events.

    Parameters
    ----------
    scene : Scene
        With the time that a gear without adhesion would take, and some more. A gear that neither sticks in it nor
        passes the exits gets more time, but for torques that follow a schedule: these have a time of their own.
    backend : str
        As for `simulate`.
    """
    duration, longest = scene.run.duration, _LONGEST * scene.run.duration
    scheduled = is_scheduled(scene.to_dict())
    while True:
        solution = solve_to_end(scene.replace({"run.duration": duration}), backend)
        extremes = solution.extremes
        moves = extremes is not None and math.isnan(extremes.stick_time) and math.isnan(extremes.back_time)
        slow = not scheduled and moves and extremes is not None and extremes.mesh_exits < exits
        if not slow or solution.status != "finished" or duration >= longest:
            return replace(solution, events=unsolved("", "").events), ""
        duration *= 2.0


def value_of(scene: Scene, key: str) -> float:
    """Value of a dotted key [SI].

    Raises
    ------
    SceneError
        If it is no number.
    """
    value = scene_value(scene, key)
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise SceneError("over", key, "must be the key of a number")
    return float(value)
