"""What a run did, judged from its dataset: turned smoothly, turned irregularly, stuck."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.select import is_roller, run_value, runs, scene_of
from gearidae.records import EventKind

__all__ = ["IRREGULAR_ABOVE", "START_UP", "GearOutcome", "RollerOutcome", "outcomes"]

IRREGULAR_ABOVE = 0.25
"""A gear turns irregularly if its speeds spread over more than this fraction of their mean."""
START_UP = 0.05
"""Share of the run in which the teeth may still bounce from how they were set down."""


@dataclass(frozen=True, slots=True)
class GearOutcome:
    """What one run of a gear pair did.

    Attributes
    ----------
    label : dict
        Swept dimension to value; empty for a single run.
    status : str
        ``finished``, or why the solver ended early.
    verdict : str
        - ``sticks``: the gear's speed falls to zero or below, or never rises above it.
        - ``irregular``: it never does, but after the `START_UP` the speeds spread over more than
          `IRREGULAR_ABOVE` of their mean.
        - ``turns smoothly``: neither.
        - ``runs`` or ``stops``: where a torque follows a schedule, changing speed and coming to rest are what
        was
          asked for; judged is then only whether the gear turns during the last twentieth of the run.
        - ``unfinished``: the solver ended early and the gear had not stuck until then.
    min_speed, max_speed : float
        Extremes of the sampled gear speed [rad/s]; NaN without samples.
    impacts : int
        Contacts made (onset events).
    wall_time : float
        Wall time in the solver [s].
    """

    label: dict[str, Any]
    status: str
    verdict: str
    min_speed: float
    max_speed: float
    impacts: int
    wall_time: float


@dataclass(frozen=True, slots=True)
class RollerOutcome:
    """What one run of a roller did.

    Attributes
    ----------
    label : dict
        Swept dimension to value; empty for a single run.
    status : str
        ``finished``, or why the solver ended early.
    verdict : str
        ``rebounds`` if the roller has let go of the plane at the end and flies away; ``sticks`` if it
        touched and is still in touch; ``flies`` if it has not touched; ``unfinished`` if the solver ended
        early.
    peak_force : float
        Largest sampled repulsion [N].
    pull_off_force : float
        Largest sampled attraction [N], 0 if there was none.
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


def outcomes(ds: xr.Dataset) -> list[GearOutcome | RollerOutcome]:
    """Judge every run of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep` or `open_archive`, or a selection from a sweep.

    Returns
    -------
    list of GearOutcome or RollerOutcome
        One per run, in the order of the dataset (the last dimension changes fastest).

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    if is_roller(ds):
        return [_roller(label, run) for label, run in runs(ds)]
    scheduled = _is_scheduled(scene_of(ds))
    return [_gear(label, run, scheduled) for label, run in runs(ds)]


def _gear(label: dict[str, Any], run: xr.Dataset, scheduled: bool) -> GearOutcome:
    speed = run["gear_speed"].values
    speed = speed[np.isfinite(speed)]
    status = str(run_value(run, "status"))
    return GearOutcome(
        label=label,
        status=status,
        verdict=_gear_verdict(speed, status, scheduled),
        min_speed=float(speed.min()) if speed.size else np.nan,
        max_speed=float(speed.max()) if speed.size else np.nan,
        impacts=_impacts(run),
        wall_time=float(run_value(run, "wall_time")),
    )


def _gear_verdict(speed: np.ndarray[Any, np.dtype[np.float64]], status: str, scheduled: bool) -> str:
    if not speed.size:
        return "unfinished"
    if scheduled:
        if status != "finished":
            return "unfinished"
        return "runs" if speed[-max(1, speed.size // 20) :].min() > 0.0 else "stops"
    started = int(np.argmax(speed > 0.0))  # a gear that starts from rest has not stuck there
    if speed[started:].min() <= 0.0:
        return "sticks"
    if status != "finished":
        return "unfinished"
    settled = speed[max(started, int(START_UP * speed.size)) :]
    return "irregular" if np.ptp(settled) > IRREGULAR_ABOVE * settled.mean() else "turns smoothly"


def _roller(label: dict[str, Any], run: xr.Dataset) -> RollerOutcome:
    force, speed = (run[name].values for name in ("force", "speed"))
    force, speed = force[np.isfinite(force)], speed[np.isfinite(speed)]
    status = str(run_value(run, "status"))
    impacts = _impacts(run)
    verdict, restitution = "unfinished", np.nan
    if status == "finished" and speed.size:
        verdict = "sticks" if impacts else "flies"
        if impacts and not _in_touch(run) and speed[-1] > 0.0:
            verdict, restitution = "rebounds", float(speed[-1] / abs(speed[0]))
    return RollerOutcome(
        label=label,
        status=status,
        verdict=verdict,
        peak_force=float(force.max(initial=0.0)),
        pull_off_force=abs(float(force.min(initial=0.0))),
        restitution=restitution,
        impacts=impacts,
        wall_time=float(run_value(run, "wall_time")),
    )


def _in_touch(run: xr.Dataset) -> bool:
    """Whether the last contact made has not been broken."""
    kinds = run["event_kind"].values
    return bool(kinds[np.isin(kinds, (EventKind.ONSET, EventKind.SEPARATION))][-1] == EventKind.ONSET)


def _impacts(run: xr.Dataset) -> int:
    return int(np.count_nonzero(run["event_kind"].values == EventKind.ONSET))


def _is_scheduled(scene: dict[str, Any]) -> bool:
    """Whether a torque of the scene follows a schedule."""
    return any((scene.get(shaft) or {}).get("schedule") for shaft in ("drive", "load"))
