"""One window of a life: mesh cycles at a frozen coverage until the motion is steady, and what flanks are exposed to.

Some cycles are passed first; then blocks of cycles are compared until their contacts no longer drift. At a low coverage
the speed of the gear takes tens of cycles to settle, and a window that is cut off earlier shows too small rates.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae import engine
from gearidae.arrays import Floats
from gearidae.records import ExposureRows, Extremes
from gearidae.runs.estimates import waiting_speed
from gearidae.runs.running import solve_to_end, unfinished, unsolved
from gearidae.scene import MATERIAL_NAMES
from gearidae.scene.friction import has_flank_friction

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import GearScene

_PATIENCE: Final = 4.0
"""Time that each part of a window gets, over that of its cycles at the steady speed."""
_MOST_BLOCKS: Final = 8
"""Blocks after which a window is taken as it is."""
_ROWS: Final = ExposureRows.of(len(MATERIAL_NAMES))


@dataclass(frozen=True, slots=True)
class Cycles:
    """Mesh cycles of a window.

    Attributes
    ----------
    settle : int
        Those that are passed first.
    count : int
        Those of a block.
    tolerance : float
        By which share a block may still drift; infinite for a window of one block.
    """

    settle: int
    count: int
    tolerance: float = math.inf

    @property
    def total(self) -> int:
        """Of the shortest window."""
        return self.settle + self.count * (1 if self.tolerance == math.inf else 2)


def window_scene(scene: GearScene, cycles: Cycles, places: int) -> GearScene:
    """Return the scene of a window, with the time of all of it: it keeps the exposures."""
    duration = _PATIENCE * cycles.total * 2.0 * math.pi / (scene.gears.gear_teeth * waiting_speed(scene))
    return scene.replace(
        {
            "run.exposures": places,
            "run.samples": "off",
            "run.checkpoints": [],
            "run.duration": duration,
            "run.stop": f"turns {cycles.total / scene.gears.gear_teeth!r}",
            "name": f"blocks of {cycles.count} mesh cycles after {cycles.settle}, steady to {cycles.tolerance:g}",
        }
    )


@dataclass(frozen=True, slots=True)
class Window:
    """What has come of a window.

    Attributes
    ----------
    solution : Solution
        Of all of it, with its sums.
    exposures : ndarray or None
        Of one block, as `gained` has them: the last, or the mean of the last two where blocks no longer drift but
        fluctuate. None if the gear sticks.
    start : Start or None
        Of a run that goes on from its end, if the gear turns.
    """

    solution: Solution
    exposures: Floats | None = None
    start: engine.Start | None = None


def run_window(scene: GearScene, cycles: Cycles, backend: str) -> tuple[Solution, str]:
    """Run a window.

    Parameters
    ----------
    scene : Scene
        From `window_scene`.
    backend : str
        As for `simulate`.

    Returns
    -------
    solution : Solution
        Without events, and with the exposures of a block.
    word : str
        ``sticks`` if the gear has come to stand, or has not passed the cycles in its time; else ``turns``.

    Raises
    ------
    SolverError
        If a run could not be finished.
    """
    window = steady_window(scene, cycles, backend)
    solution = replace(window.solution, events=unsolved("", "").events, checkpoint=None)
    if window.exposures is None:
        return solution, "sticks"
    return with_exposures(solution, window.exposures), "turns"


def with_exposures(solution: Solution, exposures: Floats) -> Solution:
    """Put other exposures in the place of a run's own.

    Parameters
    ----------
    solution : Solution
        With extremes.
    exposures : ndarray
        As `gained` has them.
    """
    assert solution.extremes is not None
    extremes = Extremes(solution.extremes, exposures=array("d", exposures.tobytes()))
    return replace(solution, extremes=extremes)


def steady_window(scene: GearScene, cycles: Cycles, backend: str) -> Window:
    """Run blocks of cycles until they are steady, from the start of a scene.

    Parameters
    ----------
    scene, cycles, backend
        As for `run_window`.

    Raises
    ------
    SolverError
        If a run could not be finished.
    """
    before: Solution | None = None
    start = engine.AT_ONCE
    if cycles.settle:
        first = part_of(scene, cycles.settle, cycles.total)
        before = solved(first, backend)
        if stands(before, first) or before.checkpoint is None:
            return Window(before)
        start = engine.end_of(first, before.checkpoint, 0.0)
    block = part_of(scene, cycles.count, cycles.total)
    tables: list[Floats] = []
    while True:
        solution = solved(block, backend, start)
        if stands(solution, block) or solution.checkpoint is None:
            return Window(solution)
        tables.append(gained(solution, before, scene))
        start = engine.end_of(block, solution.checkpoint, start.time)
        exposures = steady_exposures(tables, cycles.tolerance)
        if exposures is not None:
            return Window(solution, exposures, start)
        before = solution


def part_of(scene: GearScene, cycles: int, total: int, patience: float = 1.0) -> GearScene:
    """Return the scene of some of a window's mesh cycles, with their share of its time.

    Parameters
    ----------
    scene : Scene
        From `window_scene`.
    cycles, total : int
        Mesh cycles of the part and of the window.
    patience : float, optional
        Times that share.
    """
    return scene.replace(
        {
            "run.stop": f"turns {cycles / scene.gears.gear_teeth!r}",
            "run.duration": patience * scene.run.duration * cycles / total,
        }
    )


def steady_exposures(blocks: Sequence[Floats], tolerance: float) -> Floats | None:
    """Exposures of a block where they no longer drift; None as long as they do.

    What is still to come of a drift is estimated by its last two changes, as of a geometric series.

    Parameters
    ----------
    blocks : sequence of ndarray
        Of all blocks so far, as `gained` has them.
    tolerance : float
        Of what is still to come, over the contacts made.
    """
    if tolerance == math.inf:
        return blocks[-1]
    contacts = [
        float(block[: len(block) // 2, : _ROWS.adhesion].sum()) for block in blocks[-3:]
    ]  # of the drive flank
    changes = np.diff(contacts)
    if not changes.size:
        return None
    drift = abs(changes[-1])
    if changes.size > 1 and changes[0] != 0.0:
        if changes[0] * changes[1] < 0.0:
            return np.asarray(np.mean(blocks[-2:], axis=0))
        drift *= min(abs(changes[1] / changes[0]), 1.0)
    return blocks[-1] if drift <= tolerance * contacts[-1] or len(blocks) == _MOST_BLOCKS else None


def stands(solution: Solution, scene: GearScene) -> bool:
    """Whether the gear stands at the end of a run that was to end after some turns, or has not turned so far."""
    extremes, reached = solution.extremes, solution.reached or 0.0
    late = reached - solution.start >= scene.run.duration * (1.0 - 1e-9)
    return (
        extremes is None or late or not (math.isnan(extremes.stick_time) and math.isnan(extremes.back_time))
    )


def solved(scene: GearScene, backend: str, start: engine.Start = engine.AT_ONCE) -> Solution:
    """Run some cycles.

    Raises
    ------
    SolverError
        If they could not be finished.
    """
    solution = solve_to_end(scene, backend, start)
    if solution.extremes is None or solution.status != "finished":
        raise unfinished(solution, "a window of the life")
    return solution


def gained(solution: Solution, before: Solution | None, scene: GearScene) -> Floats:
    """What a run has added to the exposures of the one before; largest pressures are those of both.

    Returns
    -------
    ndarray, shape (flanks times teeth, quantities, places)
        As in `gearidae.records.Extremes`.
    """
    ours = _table(solution, scene)
    if before is not None:
        theirs = _table(before, scene)
        theirs[:, _ROWS.pressure] = 0.0
        ours -= theirs
    return ours


def _table(solution: Solution, scene: GearScene) -> Floats:
    assert solution.extremes is not None
    rows = _ROWS.per_tooth(rubs=has_flank_friction(scene))
    return np.array(solution.extremes.exposures).reshape(-1, rows, scene.run.exposures)
