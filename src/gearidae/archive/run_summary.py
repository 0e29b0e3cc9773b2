"""Run summary: time to speed, times at rest and trapped by adhesion, largest force, and energies of one run.

Read from a dataset of any length in pieces; it stands beside the other readers of datasets, because the report needs it
as well as the runs do. Extremes, times at rest and held by adhesion, what holds the gear, and energies are those that
the engine kept at its own steps; a run that is not at its end has extremes
of its newest checkpoint and no energies. `RunSummary.time_to_speed` always is that of a sample.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Mapping
from typing import Any, Final

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.pieces import PIECE
from gearidae.archive.select import is_roller, is_train, scene_of
from gearidae.archive.totals import balance_of, extremes_of
from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.arrays import Floats
from gearidae.laws.frictions import friction_laws_of
from gearidae.laws.law import LOAD
from gearidae.records import EnergyBalance, EventKind, Extremes
from gearidae.records.energy import LOSSES
from gearidae.records.quantity import Totals
from gearidae.records.standing import Holding
from gearidae.scene import GearScene
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.joints import has_joint_friction

AT_SPEED = 0.95
"""Share of its largest sampled speed from which a gear counts as up to speed."""
OF_ONE_RUN: Final = frozenset({"time_to_speed", "sticks", "slips", "impacts"})
"""Rows of the run summary that begin with a run that goes on from another; everything else goes on over the chain."""


class RunSummary(Totals):
    """What one run of a gear pair did: the energies of `ENERGY_BALANCE` [J], and more; NaN for what has not been kept.

    Of a run that goes on from another, `OF_ONE_RUN` names what is of this run alone.

    Attributes
    ----------
    top_speed : float
        Largest speed of the gear [rad/s].
    time_to_speed : float
        Time of the first sample with `AT_SPEED` of the largest sampled speed [s]. NaN without samples, and of a gear
        that never turns. An impact shorter than the interval between samples has no part in it.
    sticks, slips : int
        How often dry resistance, with friction in the gear's hub, took hold of the gear, and gave way.
    time_at_rest : float
        Held at rest by dry friction: dry resistance, friction of the gear's hub, or friction of flanks and hubs. The
        engine has counted it since the start of the chain; of archives of version 0.2 it is that of stick and slip
        events of the run [s].
    time_adhering : float
        Held by adhesion [s]: turned back by teeth that cling to each other, again and again within half a pitch.
        Counted from one turning back to the next there, and to the end if the gear is there still.
    held_by : str
        What holds the gear at the end, in the words of `gearidae.records.standing.Holding`; empty if nothing does.
    impacts : int
        Contacts made.
    largest_force, largest_force_time : float
        Largest force along the line of action [N], either way, and when [s].
    friction_loss : float
        Taken by friction of flanks and hubs [J].
    efficiency : float
        What drag and dry resistance at the gear have taken over all that has been lost; 1 without losses in mesh and
        hubs. NaN where nothing has been lost, or the drive has done no work.
    contact_loss : float
        What is left of the work [J]: lost to adhesion or stored in contacts, less the work of the changing radius.
    residual : float
        Size of the balance's residual [J]: no uncertainty of the losses, which scatter with the tolerance by more.
    """

    __slots__ = ()

    def as_plain(self) -> dict[str, Any]:
        """Return the run summary as data fit for JSON, which has no NaN."""
        return {name: None if isinstance(v, float) and math.isnan(v) else v for name, v in self.items()}


def summary_of(ds: xr.Dataset) -> RunSummary | None:
    """Summarise a run.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, also one read piece by piece.

    Returns
    -------
    RunSummary or None
        None for a roller, for a train of several meshes, and for a sweep.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    if (
        is_train(ds)
        or is_roller(ds)
        or "event" not in ds.dims
        or "gear_speed" not in ds
        or ds["gear_speed"].ndim != 1
    ):
        return None
    incidents = _Events(GearScene.from_dict(scene_of(ds)), float(ds.attrs.get("start_time", 0.0)))
    for piece in _pieces(ds, "event", ("event_time", "event_kind", "event_pair", "event_flank")):
        incidents.add(*piece.values())
    top = last = math.nan
    for piece in _pieces(ds, "time", ("time", "gear_speed")):
        top, last = float(np.fmax(top, piece["gear_speed"].max())), float(piece["time"][-1])
    extremes = extremes_of(ds) or Extremes()
    force, force_time = _largest_force(extremes)
    end = float(ds.attrs["t_end"]) if ds.attrs["status"] == "finished" else 0.0
    end, still = max(end, incidents.time, float(np.nan_to_num(last))), extremes.final_speed == 0.0
    at_rest, resting = incidents.rest(end, still=still)
    held_by = incidents.holds() if resting else "adhesion" if extremes.turn_backs > 1 else ""
    if not math.isnan(extremes.rest_time):  # else an archive of version 0.2, or without a checkpoint yet
        at_rest, held_by = extremes.rest_time, Holding(extremes.holding).words
    return RunSummary(
        top_speed=extremes.max_gear_speed,
        time_to_speed=_time_to_speed(ds, top),
        sticks=incidents.counts[EventKind.STICK],
        slips=incidents.counts[EventKind.SLIP],
        time_at_rest=at_rest,
        time_adhering=extremes.time_adhering,
        held_by=held_by,
        impacts=incidents.counts[EventKind.ONSET],
        largest_force=force,
        largest_force_time=force_time,
        **_energies(balance_of(ds)),
    )


def counted_over(name: str, attributes: Mapping[Hashable, Any]) -> str:
    """Say what a row of the run summary or energy balance is counted over; nothing of a run with its own beginning.

    Parameters
    ----------
    name : str
        Of an attribute of `RunSummary`, or a term of the balance.
    attributes : mapping
        Of the run's dataset.
    """
    if "start_time" not in attributes:
        return ""
    return "this run" if name in OF_ONE_RUN else "the chain"


def _largest_force(extremes: Extremes) -> tuple[float, float]:
    """Return the larger of both extremes of the force, without its sign, and when it acted."""
    if extremes.largest_mesh_force >= -extremes.smallest_mesh_force:
        return extremes.largest_mesh_force, extremes.largest_mesh_force_time
    return -extremes.smallest_mesh_force, extremes.smallest_mesh_force_time


def _energies(balance: Mapping[str, float] | None) -> dict[str, float]:
    """Energies of the run summary, from the energy balance; NaN without one."""
    energies = {**(balance or dict.fromkeys(ENERGY_BALANCE, math.nan))}
    contact = energies["adhesion_loss"] + energies["stored_change"]
    return energies | {
        "residual": abs(energies["residual"]),
        "contact_loss": contact - (energies["radius_work"] + energies["model_change"]),
        "friction_loss": sum(energies[name] for name, loss in LOSSES.items() if loss.group == "friction"),
        "efficiency": EnergyBalance(energies).efficiency,
    }


def _pieces(ds: xr.Dataset, dim: str, names: tuple[str, ...]) -> Iterator[dict[str, NDArray[Any]]]:
    """Go through a dimension."""
    for start in range(0, ds.sizes[dim], PIECE):
        yield {name: ds[name][start : start + PIECE].values for name in names}


def _time_to_speed(ds: xr.Dataset, top: float) -> float:
    if top > 0.0:
        for piece in _pieces(ds, "time", ("time", "gear_speed")):
            fast = np.flatnonzero(piece["gear_speed"] >= AT_SPEED * top)
            if fast.size:
                return float(piece["time"][fast[0]])
    return math.nan


class _Events:
    """Counts of events, and the intervals between stick and slip."""

    def __init__(self, scene: GearScene, start: float) -> None:
        self.counts = dict.fromkeys(EventKind, 0)
        self._laws, self._start = [law.name for law in friction_laws_of(scene, LOAD)], start
        self._hubs, self._rubs = has_joint_friction(scene), has_flank_friction(scene)
        self._gear, self._flanks = False, set[tuple[int, int]]()  # what is held
        self._since: float | None = None  # when the gear came to rest
        self._total = 0.0
        self.time = 0.0  # of the last event

    def add(self, time: Floats, kind: NDArray[np.int8], pair: NDArray[Any], flank: NDArray[Any]) -> None:
        self.time = float(time[-1])
        for event in EventKind:
            self.counts[event] += int(np.count_nonzero(kind == event))
        wanted = [EventKind.STICK, EventKind.SLIP, EventKind.FLANK_STICK, EventKind.FLANK_SLIP]
        if self.counts[EventKind.FLANK_STICK]:
            wanted.append(EventKind.SEPARATION)
        for k in np.flatnonzero(np.isin(kind, wanted)):
            self._take(float(time[k]), kind[k], (int(pair[k]), int(flank[k])))

    def _take(self, time: float, kind: int, where: tuple[int, int]) -> None:
        if kind == EventKind.SLIP and self._since is None:
            # the first slip of a gear that was at rest from the start has no stick before it
            self._total += time - self._start
        if kind in (EventKind.STICK, EventKind.SLIP):
            self._gear = kind == EventKind.STICK
        elif kind == EventKind.FLANK_STICK:
            self._flanks.add(where)
        else:
            self._flanks.discard(where)
        if self._gear or len(self._flanks) > 1:
            self._since = time if self._since is None else self._since
        elif self._since is not None:
            self._total += time - self._since
            self._since = None

    def rest(self, end: float, *, still: bool) -> tuple[float, bool]:
        """Time at rest, and whether it lasts; `still` says that the gear is exactly at rest at the end."""
        if self._since is not None:
            return self._total + end - self._since, True
        rubs = self._hubs or self._rubs
        moved = (EventKind.SLIP, EventKind.FLANK_STICK, EventKind.FLANK_SLIP, EventKind.SLIDING_REVERSAL)
        if (self._laws or rubs) and still and not any(self.counts[event] for event in moved):
            return end - self._start, True
        return self._total, still and rubs

    def holds(self) -> str:
        """What holds a gear that rests at the end; of one that has never moved, what can."""
        from_start = self._since is None
        shaft = self._gear or from_start
        held = list(self._laws) if shaft else []
        held += ["hub friction"] if shaft and self._hubs else []
        held += ["flank friction"] if self._flanks or (from_start and self._rubs and not held) else []
        return " and ".join(held)
