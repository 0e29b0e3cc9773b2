"""The outcome of a run in one word, from what the engine kept of it; the words are defined in ``docs/verdicts.md``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.analysis.verdict.codes import STUCK
from gearidae.records import EventKind, Extremes, Solution
from gearidae.records.standing import is_driven
from gearidae.records.train_results import AnySolution, TrainSolution
from gearidae.scene import Scene, TrainScene
from gearidae.scene.judged import judged_mesh

IRREGULAR_ABOVE = 0.25
"""A gear turns irregularly if its speed both falls and rises again by more than this fraction of its mean."""


def verdict_of(scene: Scene, solution: AnySolution) -> tuple[str, int, int]:
    """Judge a run as the engine leaves it.

    Parameters
    ----------
    solution : Solution or TrainSolution
        Of a run that has its extremes; one without them is unfinished.

    Returns
    -------
    verdict : str
    impacts, flank_changes : int
        Contacts made (onset events), and how often contact went over to the other flank; of a train in the mesh that
        drives the judged shaft.
    """
    extremes, status = solution.extremes, solution.status
    if isinstance(solution, TrainSolution) and isinstance(scene, TrainScene):
        kinds = solution.events["kind"][solution.events["mesh"] == judged_mesh(scene)]
    else:
        assert isinstance(solution, Solution)
        kinds = solution.events.kind
    impacts, changes = (
        int(np.count_nonzero(kinds == kind)) for kind in (EventKind.ONSET, EventKind.FLANK_CHANGE)
    )
    if scene.roller is not None:
        return roller_verdict(extremes, status, impacts, in_touch([kinds])), impacts, changes
    return gear_verdict(extremes, status, scheduled=is_scheduled(scene.to_dict())), impacts, changes


def gear_verdict(extremes: Extremes | None, status: str, *, scheduled: bool) -> str:
    """Judge the run of a gear pair.

    Where it stands is judged alike for every torque, by the motion beside that of free gears.

    Parameters
    ----------
    extremes : Extremes or None
        None if the run has left none.
    status : str
        How the run ended.
    scheduled : bool
        Whether speeds change because they are asked to, see `is_scheduled`; how a gear turns is then not judged.
    """
    if extremes is None or (scheduled and status != "finished"):
        return "unfinished"
    if not math.isnan(extremes.stick_time):
        return standing_verdict(
            extremes.free_advance, extremes.driven_time, extremes.followed_time, extremes.settled
        )
    if (
        extremes.turned_back > 0.0
    ):  # the last movement of more than half a pitch was back; a smaller one may follow
        return "turns back" if extremes.free_turned_back >= 0.5 * extremes.turned_back else "runs back"
    if status != "finished":
        return "unfinished"
    if scheduled:
        return _scheduled_turning(extremes)
    return _turning(extremes)


def has_stuck(extremes: Extremes) -> bool:
    """Whether a run counts as sticking, whatever its torques are."""
    return gear_verdict(extremes, "finished", scheduled=True) in STUCK


def standing_verdict(free_advance: float, driven_time: float, until: float, settled: int) -> str:
    """Say what a gear does that stands: it sticks if it is driven; see `gearidae.records.standing`."""
    return "sticks" if is_driven(free_advance, driven_time, until, settled) else "stops"


def roller_verdict(extremes: Extremes | None, status: str, impacts: int, touching: bool) -> str:
    """Judge the run of a roller.

    Parameters
    ----------
    extremes : Extremes or None
        None if the run has left none.
    status : str
        How the run ended.
    impacts : int
        Contacts made.
    touching : bool
        Whether it touches the plane at the end.
    """
    if status != "finished" or extremes is None:
        return "unfinished"
    if impacts and not touching and extremes.final_speed > 0.0:
        return "rebounds"
    return "sticks" if impacts else "flies"


def in_touch(kinds: Iterable[NDArray[Any]]) -> bool:
    """Whether the last contact made has not been broken.

    Parameters
    ----------
    kinds : iterable of ndarray
        Kinds of the run's events, piece by piece.
    """
    last = None
    for piece in kinds:
        changes = piece[np.isin(piece, (EventKind.ONSET, EventKind.SEPARATION))]
        last = changes[-1] if changes.size else last
    return bool(last == EventKind.ONSET)


def is_scheduled(scene: Mapping[str, Any]) -> bool:
    """Whether a torque of a scene follows a schedule, or the speed that its drive holds.

    Parameters
    ----------
    scene : mapping
        As `Scene.to_dict` gives it.
    """
    drive, load = scene.get("drive") or {}, scene.get("load") or {}
    held = drive.get("speed")
    return bool(drive.get("schedule") or load.get("schedule") or isinstance(held, (dict, list)))


def _scheduled_turning(extremes: Extremes) -> str:
    """How a gear turned that has not come to stand, where a torque or the held speed follows a schedule.

    A gear whose speed only rose and was zero in the last twentieth of the run has started there.
    """
    if extremes.last_min_gear_speed > 0.0:
        return "runs"
    only_rose = extremes.speed_fall <= IRREGULAR_ABOVE * extremes.settled_gear_speed
    return "running up" if only_rose else "irregular"


def _turning(extremes: Extremes) -> str:
    """How a gear turned that has not come to stand."""
    allowed = IRREGULAR_ABOVE * extremes.settled_gear_speed
    if extremes.settled_spread <= allowed:
        return "turns smoothly"
    if min(extremes.speed_fall, extremes.speed_rise) > allowed:
        return "irregular"
    if extremes.late_spread <= IRREGULAR_ABOVE * extremes.late_gear_speed:
        return "turns smoothly"
    return "running up" if extremes.speed_rise > extremes.speed_fall else "running down"
