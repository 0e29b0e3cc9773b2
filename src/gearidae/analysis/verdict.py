"""What a run did, judged from its dataset: turned smoothly, turned irregularly, stuck."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.pieces import Spread, count, first_above, pieces, reached, spread
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
        - ``sticks``: the gear's speed falls to zero or below (if it starts from rest: after the `START_UP`), or never
          rises above it.
        - ``irregular``: it never does, but after the `START_UP` the speeds spread over more than
          `IRREGULAR_ABOVE` of their mean.
        - ``turns smoothly``: neither.
        - ``runs`` or ``stops``: where a torque follows a schedule, changing speed and coming to rest are what was
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
    speed = run["gear_speed"]
    status = str(run_value(run, "status"))
    extent = spread(speed)
    return GearOutcome(
        label=label,
        status=status,
        verdict=_gear_verdict(speed, extent, status, scheduled),
        min_speed=extent.low,
        max_speed=extent.high,
        impacts=count(run["event_kind"], EventKind.ONSET),
        wall_time=float(run_value(run, "wall_time")),
    )


def _gear_verdict(speed: xr.DataArray, extent: Spread, status: str, scheduled: bool) -> str:
    if not extent.number:
        return "unfinished"
    end = reached(speed)
    if scheduled:
        if status != "finished":
            return "unfinished"
        return "runs" if spread(speed, end - max(1, end // 20), end).low > 0.0 else "stops"
    started = first_above(speed, 0.0)
    if started > 0:  # a gear that starts from rest has not stuck there, nor where it bounces first
        started = max(started, int(START_UP * end))
    if spread(speed, started, end).low <= 0.0:
        return "sticks"
    if status != "finished":
        return "unfinished"
    settled = spread(speed, max(started, int(START_UP * end)), end)
    return "irregular" if settled.high - settled.low > IRREGULAR_ABOVE * settled.mean else "turns smoothly"


def _roller(label: dict[str, Any], run: xr.Dataset) -> RollerOutcome:
    force, speed = spread(run["force"]), run["speed"]
    status = str(run_value(run, "status"))
    impacts = count(run["event_kind"], EventKind.ONSET)
    verdict, restitution = "unfinished", np.nan
    if status == "finished" and force.number:
        verdict = "sticks" if impacts else "flies"
        first, last = float(speed[0]), float(speed[-1])
        if impacts and not _in_touch(run) and last > 0.0:
            verdict, restitution = "rebounds", last / abs(first)
    return RollerOutcome(
        label=label,
        status=status,
        verdict=verdict,
        peak_force=max(force.high, 0.0) if force.number else 0.0,
        pull_off_force=max(-force.low, 0.0) if force.number else 0.0,
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
