"""What a run did, judged from the extremes that the engine kept: turned smoothly, turned irregularly, stuck.

Samples have no part in it, unless a run is not at its end and only samples are in its archive. The words are defined in
``docs/verdicts.md``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gearidae.analysis.kept_verdicts import kept_fields
from gearidae.analysis.sampled_extremes import extremes_of_samples
from gearidae.analysis.verdict_table import Outcomes, Shown
from gearidae.archive.dataset import to_dataset
from gearidae.archive.extremes import extremes_of
from gearidae.archive.pieces import count, pieces
from gearidae.archive.select import is_roller, run_value, runs, scene_of
from gearidae.records import EventKind, Extremes, Solution
from gearidae.scene import Scene

__all__ = ["IRREGULAR_ABOVE", "START_UP", "GearOutcome", "RollerOutcome", "judge", "outcomes"]

IRREGULAR_ABOVE = 0.25
"""A gear turns irregularly if its speed both falls and rises again by more than this fraction of its mean."""
START_UP = 0.05
"""Share of the run in which the teeth may still bounce from how they were set down."""
BACK_FROM = 0.5
"""Pitches that a gear must be turned back by to be said to run back."""


@dataclass(frozen=True, slots=True)
class GearOutcome(Shown):
    """What one run of a gear pair did.

    Attributes
    ----------
    label : dict
        Swept dimension to value; empty for a single run.
    status : str
        ``finished``, or why the solver ended early.
    verdict : str
        - ``sticks``: the gear's speed has fallen to zero and it has not turned on by half a pitch since; or it never
          rose above zero.
        - ``runs back``: it has been turned back by more than half a pitch since.
        - ``turns smoothly``: after the `START_UP` its speeds spread over no more than `IRREGULAR_ABOVE` of their mean,
          or they only rose or fell before the second half of the run, in which they do.
        - ``irregular``: after the `START_UP` its speed fell below what it had been, and rose above what it had fallen
          to, by more than `IRREGULAR_ABOVE` of its mean.
        - ``running up`` or ``running down``: it did only one of both, and goes on to.
        - ``runs`` or ``stops``: where a torque follows a schedule, changing speed and coming to rest are what was
          asked for; judged is then only whether the gear turns during the last twentieth of the run.
        - ``unfinished``: the solver ended early and the gear had not come to stand until then.
    min_speed, max_speed : float
        Extremes of the gear's speed [rad/s].
    impacts : int
        Contacts made (onset events).
    wall_time : float
        Wall time in the solver [s].
    stick_time : float
        When the gear came to stand [s]; NaN if it has not.
    mesh_exits : int
        Mesh exits on the drive flank, until then if it has.
    window : float
        Simulated time of the run [s].
    """

    label: dict[str, Any]
    status: str
    verdict: str
    min_speed: float
    max_speed: float
    impacts: int
    wall_time: float
    stick_time: float
    mesh_exits: int
    window: float

    @property
    def words(self) -> str:
        """The verdict in words, with the window that it holds for."""
        exits = "1 mesh exit" if self.mesh_exits == 1 else f"{self.mesh_exits} mesh exits"
        if self.verdict == "unfinished":
            return f"not followed to its end ({self.status})"
        if self.verdict == "stops" and not math.isnan(self.stick_time):
            return f"came to rest at {_seconds(self.stick_time)} ({exits})"
        if self.verdict not in ("sticks", "runs back"):
            return f"{_IN_WORDS[self.verdict]} through {exits} in {_seconds(self.window)}"
        if self.stick_time == 0.0 and self.verdict == "sticks":
            return f"does not start in {_seconds(self.window)}"
        return f"{self.verdict} at {_seconds(self.stick_time)} ({exits})"


_IN_WORDS = {
    "turns smoothly": "turned smoothly",
    "irregular": "turned irregularly",
    "running up": "was still running up",
    "running down": "was still running down",
    "runs": "turned to the end",
    "stops": "came to rest",
}


def _seconds(time: float) -> str:
    """Write a time with an engineering prefix."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us")):
        if time >= 0.1 * scale:
            return f"{time / scale:.3g} {unit}"
    return f"{time / 1e-9:.3g} ns"


@dataclass(frozen=True, slots=True)
class RollerOutcome(Shown):
    """What one run of a roller did.

    Attributes
    ----------
    label : dict
        Swept dimension to value; empty for a single run.
    status : str
        ``finished``, or why the solver ended early.
    verdict : str
        ``rebounds`` if the roller has detached from the plane at the end and flies away; ``sticks`` if it
        touched and is still in touch; ``flies`` if it has not touched; ``unfinished`` if the solver ended
        early.
    peak_force : float
        Largest repulsion [N].
    pull_off_force : float
        Largest attraction [N], 0 if there was none.
    restitution : float
        Speed of the rebound over speed of the approach [1]; NaN unless it rebounds.
    impacts : int
        Contacts made (onset events).
    wall_time : float
        Wall time in the solver [s].
    """

    label: dict[str, Any]
    status: str
    verdict: str
    peak_force: float
    pull_off_force: float
    restitution: float
    impacts: int
    wall_time: float

    @property
    def words(self) -> str:
        """The verdict in words."""
        return f"not followed to its end ({self.status})" if self.verdict == "unfinished" else self.verdict


def outcomes(ds: xr.Dataset) -> list[GearOutcome | RollerOutcome]:
    """Judge every run of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep` or `open_archive`, or a selection from a sweep.

    Returns
    -------
    list of GearOutcome or RollerOutcome
        One per run, in the order of the dataset (the last dimension changes fastest); a table in a notebook.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    if "verdict" in ds.variables:  # judged when the run ended, of which not everything is there
        kind = RollerOutcome if is_roller(ds) else GearOutcome
        return [kind(**fields) for fields in kept_fields(ds)]
    if is_roller(ds):
        return Outcomes(_roller(label, run) for label, run in runs(ds))
    scheduled = _is_scheduled(scene_of(ds))
    return Outcomes(_gear(label, run, scheduled) for label, run in runs(ds))


def judge(scene: Scene, solution: Solution) -> tuple[str, int, int]:
    """Judge a run before a dataset is made of it, which takes longer than many a run.

    Parameters
    ----------
    scene : Scene
        As it was run.
    solution : Solution

    Returns
    -------
    verdict : str
        What `outcomes` says of the run's dataset.
    impacts, flank_changes : int
        Contacts made, and how often contact went over to the other flank.
    """
    kinds = solution.events.kind
    impacts, changes = (
        int(np.count_nonzero(kinds == kind)) for kind in (EventKind.ONSET, EventKind.FLANK_CHANGE)
    )
    found, drive, load = solution.extremes, scene.drive, scene.load
    if drive is None or load is None or found is None or math.isnan(found.final_speed):
        (outcome,) = outcomes(to_dataset(scene, solution))
        return outcome.verdict, impacts, changes
    return _gear_verdict(found, solution.status, bool(drive.schedule or load.schedule)), impacts, changes


def _gear(label: dict[str, Any], run: xr.Dataset, scheduled: bool) -> GearOutcome:
    status = str(run_value(run, "status"))
    found = extremes_of(run) or extremes_of_samples(run)
    return GearOutcome(
        label=label,
        status=status,
        verdict=_gear_verdict(found, status, scheduled),
        min_speed=found.min_gear_speed if found else math.nan,
        max_speed=found.max_gear_speed if found else math.nan,
        impacts=count(run["event_kind"], EventKind.ONSET),
        wall_time=float(run_value(run, "wall_time")),
        stick_time=found.stick_time if found else math.nan,
        mesh_exits=found.stick_exits if found else 0,
        window=float(label.get("duration", run.attrs["t_end"])),
    )


def _gear_verdict(found: Extremes | None, status: str, scheduled: bool) -> str:
    if found is None:
        return "unfinished"
    if scheduled:
        if status != "finished":
            return "unfinished"
        return "runs" if found.last_min_gear_speed > 0.0 else "stops"
    if not math.isnan(found.stick_time):
        return "runs back" if found.turned_back > BACK_FROM else "sticks"
    return _turning(found) if status == "finished" else "unfinished"


def _turning(found: Extremes) -> str:
    """How a gear turned that has not come to stand."""
    allowed = IRREGULAR_ABOVE * found.settled_gear_speed
    if found.settled_spread <= allowed:
        return "turns smoothly"
    if min(found.speed_fall, found.speed_rise) > allowed:
        return "irregular"
    if found.late_spread <= IRREGULAR_ABOVE * found.late_gear_speed:
        return "turns smoothly"
    return "running up" if found.speed_rise > found.speed_fall else "running down"


def _roller(label: dict[str, Any], run: xr.Dataset) -> RollerOutcome:
    found = extremes_of(run) or extremes_of_samples(run)
    status = str(run_value(run, "status"))
    impacts = count(run["event_kind"], EventKind.ONSET)
    verdict, restitution = "unfinished", np.nan
    if status == "finished" and found is not None:
        verdict, last = ("sticks" if impacts else "flies"), found.final_speed
        if impacts and not _in_touch(run) and last > 0.0:
            approach = float(label.get("speed", label.get("roller_speed", scene_of(run)["roller"]["speed"])))
            verdict, restitution = "rebounds", last / abs(approach) if approach != 0.0 else np.nan
    return RollerOutcome(
        label=label,
        status=status,
        verdict=verdict,
        peak_force=max(found.largest_mesh_force, 0.0) if found else 0.0,
        pull_off_force=max(-found.smallest_mesh_force, 0.0) if found else 0.0,
        restitution=restitution,
        impacts=impacts,
        wall_time=float(run_value(run, "wall_time")),
    )


def _in_touch(run: xr.Dataset) -> bool:
    """Whether the last contact made has not been broken."""
    last = None
    for _, kinds in pieces(run["event_kind"]):
        changes = kinds[np.isin(kinds, (EventKind.ONSET, EventKind.SEPARATION))]
        last = changes[-1] if changes.size else last
    return bool(last == EventKind.ONSET)


def _is_scheduled(scene: dict[str, Any]) -> bool:
    """Whether a torque of the scene follows a schedule."""
    return any((scene.get(shaft) or {}).get("schedule") for shaft in ("drive", "load"))
