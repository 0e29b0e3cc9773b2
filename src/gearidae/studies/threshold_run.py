"""One run of `gearidae.studies.sticking_threshold`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearidae.analysis.verdict.judge import has_stuck, is_scheduled
from gearidae.archive.output_selection import TOTALS
from gearidae.errors import SceneError, SolverError
from gearidae.runs.running import solve_any_to_end, unfinished
from gearidae.scene.keys import scene_value

if TYPE_CHECKING:
    from gearidae.records import Extremes
    from gearidae.records.train_results import AnySolution
    from gearidae.scene import Scene

_LONGEST = 8.0
"""A slow gear gets up to this many times the time; one that still moves then has neither stuck nor passed."""


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
    slow : bool
        Whether the gear still moved when the time was over, and had not passed all exits: of these it says nothing.
    failure : SolverError or None
        Why the run could not be finished: it says nothing of the gear then.
    """

    value: float
    passed: int
    stick_time: float
    window: float
    slow: bool = False
    failure: SolverError | None = None

    @classmethod
    def of(cls, value: float, solution: AnySolution, exits: int) -> ThresholdRun:
        """Read the solution of a run until so many mesh exits."""
        extremes = solution.extremes
        if extremes is None or solution.status != "finished":
            failure = unfinished(solution, f"the run at {value:g}")
            return cls(value, 0, math.nan, solution.reached or 0.0, failure=failure)
        if not has_stuck(extremes):
            slow = _is_slow(extremes, exits)
            return cls(value, extremes.mesh_exits, math.nan, solution.reached or 0.0, slow)
        time = extremes.back_time if math.isnan(extremes.stick_time) else extremes.stick_time
        return cls(value, extremes.stick_exits, time, solution.reached or 0.0)

    def slow_in_words(self, exits: int) -> str:
        """Say what a slow gear has done of so many mesh exits."""
        passes = f"in {self.window:.3g} s it passes {self.passed} of {exits} mesh exits and does not stick"
        return f"at {self.value:g} the gear is slow: {passes}"


def run_until(scene: Scene, exits: int, backend: str) -> tuple[AnySolution, str]:
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
        solution = solve_any_to_end(scene.replace({"run.duration": duration}), backend)
        extremes = solution.extremes
        slow = extremes is not None and _is_slow(extremes, exits)
        if scheduled or not slow or solution.status != "finished" or duration >= longest:
            return TOTALS.thinned(solution), ""
        duration *= 2.0


def _is_slow(extremes: Extremes, exits: int) -> bool:
    """Whether a gear neither stands nor has gone back, and has not passed so many exits."""
    moves = math.isnan(extremes.stick_time) and math.isnan(extremes.back_time)
    return moves and extremes.mesh_exits < exits


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
