"""The outcomes of the runs of a dataset: what each did, with the numbers that the verdict rests on.

The words are defined in ``docs/verdicts.md``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import xarray as xr

from gearidae.analysis.verdict.earlier import OLD, earlier_verdict, is_earlier
from gearidae.analysis.verdict.judge import gear_verdict, in_touch, is_scheduled, roller_verdict
from gearidae.analysis.verdict.table import Outcomes, Shown
from gearidae.archive.pieces import count, pieces
from gearidae.archive.select import is_roller, refuse_other_labels, run_value, runs, scene_of, swept_dims
from gearidae.archive.tables import run_labels
from gearidae.archive.totals import extremes_of, imbalance, imbalance_of, imbalance_words
from gearidae.archive.train import judged_view
from gearidae.errors import SceneError
from gearidae.records import RUN_PARTS, EventKind, Extremes
from gearidae.records.standing import Holding

START_UP = RUN_PARTS[0]
"""Share of the run in which the teeth may still bounce from how they were set down."""

_NOTHING = Holding(0)


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
        - ``sticks``: the gear stands where free gears would have turned on (`gearidae.records.standing`).
        - ``stops``: it stands, and is not driven, or by too little to say more.
        - ``turns back``: it has been turned back by more than half a pitch, as free gears have by half as much.
        - ``runs back``: it has been turned back where free gears have not.
        - ``turns smoothly``: after the `START_UP` its speeds spread over no more than `IRREGULAR_ABOVE` of their mean,
          or they only rose or fell before the second half of the run, in which they do.
        - ``irregular``: after the `START_UP` its speed fell below what it had been, and rose above what it had fallen
          to, by more than `IRREGULAR_ABOVE` of its mean.
        - ``running up`` or ``running down``: it did only one of both, and goes on to.
        - ``runs``: where a torque or the held speed follows a schedule, a changing speed is the input; the gear has
          turned forward during the last twentieth of the run.
        - ``unfinished``: the solver ended early and the gear had not come to stand until then.
    min_speed, max_speed : float
        Extremes of the gear's speed [rad/s].
    impacts : int
        Contacts made (onset events).
    wall_time : float
        Wall time in the solver [s].
    stick_time : float
        When the gear came to stand, or went back [s]; NaN if it did neither.
    mesh_exits : int
        Mesh exits on the drive flank, until then if it has.
    window : float
        Simulated time of the run [s].
    imbalance : float
        Residual of the energy balance over its bound [1]: above 1 the run is not to be relied on; NaN if unknown.
    free_advance : float
        Pitches that free gears would have moved from where the gear stands; NaN if unknown.
    holding : Holding
        What holds a gear that stands.
    turned_back : float
        Pitches by which the gear has gone back.
    scheduled : bool
        Whether a torque or the held speed follows a schedule.
    old : bool
        Whether the verdict is that of an archive of version 0.2 by the rule of that version.
    chained : bool
        Whether the run goes on from another: times, exits and extremes are those of the chain.
    reached : float
        Time since the start of the chain to which the run has been followed [s]; NaN if unknown.
    advance : float
        Pitches that the gear has been away from where it stands; NaN if unknown.
    settled : int
        1 if free gears have settled there, within a pitch, 2 if the gear has with them.
    shaft : str
        The judged shaft of a train; empty of a pair.
    holders : str
        What holds a train, by the names of its shafts and meshes.
    """

    label: dict[str, Any]
    status: str
    verdict: str
    min_speed: float
    max_speed: float
    impacts: float
    wall_time: float
    stick_time: float
    mesh_exits: int
    window: float
    imbalance: float = math.nan
    free_advance: float = math.nan
    holding: Holding = _NOTHING
    turned_back: float = math.nan
    scheduled: bool = False
    old: bool = False
    chained: bool = False
    reached: float = math.nan
    advance: float = math.nan
    settled: int = 0
    shaft: str = ""
    holders: str = ""

    @property
    def held_by(self) -> str:
        """Names of what holds a gear that stands; `holding` has them for counting, `Holding.by_adhesion` among them."""
        return self.holders or self.holding.words

    def resolved_min_speed(self, rtol: float) -> float:
        """Smallest speed [rad/s]; 0 where that is less than a relative tolerance resolves beside the largest."""
        return 0.0 if abs(self.min_speed) <= rtol * self.max_speed else self.min_speed

    @property
    def words(self) -> str:
        """The verdict in words, with its window, and a warning where the energy balance does not close."""
        return self._verdict_in_words + (OLD if self.old else "") + imbalance_words(self.imbalance)

    @property
    def _window(self) -> str:
        return f"{_seconds(self.window)}{' of the chain' * self.chained}"

    @property
    def _verdict_in_words(self) -> str:
        exits = "1 mesh exit" if self.mesh_exits == 1 else f"{self.mesh_exits} mesh exits"
        if self.verdict == "unfinished":
            reached = "" if math.isnan(self.reached) else f" after {_seconds(self.reached)}"
            return f"not followed to its end ({self.status}{reached})"
        if self.verdict in ("sticks", "stops"):
            return self._standing_in_words(exits)
        if self.verdict == "turns back":
            return f"turned back by {self.turned_back:.3g} pitches, as driven"
        words = _IN_WORDS[self.verdict]
        if self.verdict != "runs back" or math.isnan(self.stick_time):
            return f"{words} through {exits} in {self._window}"
        if self.stick_time > 0.0:
            return f"{words} at {_seconds(self.stick_time)} ({exits})"
        return f"runs back from the start ({exits})"

    def _standing_in_words(self, exits: str) -> str:
        """Say since when the gear stands and what free gears would have done, or what holds it."""
        free = f"free gears would have turned on by {self.free_advance:.3g} pitches"
        held = f", held by {self.held_by}" if self.held_by else ""
        since = f"{_seconds(self.stick_time)} ({exits})" if self.stick_time > 0.0 else ""
        if self.verdict == "sticks":
            words = f"sticks at {since}" if since else f"does not start in {self._window}"
            return f"{words}: {free}" if self.scheduled and since and self.free_advance > 0.0 else words
        if self.settled and since and self.free_advance > 0.0:
            words = f"came to rest at {since}"
            if self.advance < 0.5 * self.free_advance:
                return f"{words}, {self.free_advance:.3g} pitches before free gears{held}"
            return f"{words}, as free gears do{held}"
        if self.free_advance > 0.0:
            words = f"came to rest at {since}" if since else f"does not start in {self._window}"
            return f"{words}: {free}{held}"
        return (f"came to rest at {since}" if since else f"not driven in {self._window}") + held


_IN_WORDS = {
    "turns smoothly": "turned smoothly",
    "irregular": "turned irregularly",
    "running up": "was still running up",
    "running down": "was still running down",
    "runs": "turned to the end",
    "runs back": "runs back",
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
    imbalance : float
        Residual of the energy balance over its bound [1]: above 1 the run is not to be relied on; NaN if unknown.
    """

    label: dict[str, Any]
    status: str
    verdict: str
    peak_force: float
    pull_off_force: float
    restitution: float
    impacts: int
    wall_time: float
    imbalance: float = math.nan

    @property
    def words(self) -> str:
        """The verdict in words, with a warning where the energy balance does not close."""
        words = f"not followed to its end ({self.status})" if self.verdict == "unfinished" else self.verdict
        return words + imbalance_words(self.imbalance)


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
        If the dataset carries no scene, or that of a run with other labels.
    """
    if "status" not in ds.variables and "status" not in ds.attrs:
        raise SceneError(
            "dataset", str(ds.attrs.get("title", "(no title)"))[:60], "holds no runs: it is of a study"
        )
    refuse_other_labels(ds)
    if "verdict" in ds.variables:  # judged when the run ended, of which not everything is there
        return _kept(ds)
    if is_roller(ds):
        return Outcomes(_roller(label, run) for label, run in runs(ds))
    return Outcomes(_gear(label, run) for label, run in runs(ds))


def _gear(label: dict[str, Any], run: xr.Dataset) -> GearOutcome:
    run = judged_view(run)
    status, scene = str(run_value(run, "status")), scene_of(run)
    extremes, scheduled = extremes_of(run), is_scheduled(scene)
    verdict, old = None, False
    if extremes is not None and is_earlier(extremes):
        verdict, old = earlier_verdict(extremes, status, scene, scheduled=scheduled)
        if verdict is None:
            extremes = Extremes(extremes, turned_back=0.0)
    verdict = verdict or gear_verdict(extremes, status, scheduled=scheduled)
    kept = extremes or Extremes()
    return GearOutcome(
        label=label,
        status=status,
        verdict=verdict,
        min_speed=kept.min_gear_speed,
        max_speed=kept.max_gear_speed,
        impacts=_impacts(run),
        wall_time=float(run_value(run, "wall_time")),
        stick_time=kept.back_time if math.isnan(kept.stick_time) else kept.stick_time,
        mesh_exits=kept.stick_exits,
        window=float(run.coords.get("duration", run.attrs["t_end"])),  # zipped keys are no part of the label
        imbalance=imbalance_of(run),
        free_advance=kept.free_advance,
        holding=Holding(kept.holding),
        turned_back=kept.turned_back,
        scheduled=scheduled,
        old=old,
        chained="start_time" in run.attrs,
        reached=kept.followed_time,
        advance=kept.advance,
        settled=int(kept.settled),
        shaft=run.attrs.get("judged_shaft", ""),
        holders=str(run["held_by"].values if "held_by" in run else run.attrs.get("held_by", "")),
    )


def _roller(label: dict[str, Any], run: xr.Dataset) -> RollerOutcome:
    extremes = extremes_of(run)
    status = str(run_value(run, "status"))
    if "event_kind" not in run:
        raise SceneError("dataset", "without events", "must have them: a roller is judged by its events")
    impacts = count(run["event_kind"], EventKind.ONSET)
    kinds = (values for _, values in pieces(run["event_kind"]))
    verdict, restitution = roller_verdict(extremes, status, impacts, in_touch(kinds)), math.nan
    if verdict == "rebounds" and extremes is not None:
        approach = float(label.get("speed", label.get("roller_speed", scene_of(run)["roller"]["speed"])))
        restitution = extremes.final_speed / abs(approach) if approach != 0.0 else math.nan
    return RollerOutcome(
        label=label,
        status=status,
        verdict=verdict,
        peak_force=max(extremes.largest_mesh_force, 0.0) if extremes else 0.0,
        pull_off_force=max(-extremes.smallest_mesh_force, 0.0) if extremes else 0.0,
        restitution=restitution,
        impacts=impacts,
        wall_time=float(run_value(run, "wall_time")),
        imbalance=imbalance_of(run),
    )


def _impacts(run: xr.Dataset) -> float:
    """Impacts of a run; NaN of one whose events have been dropped."""
    return count(run["event_kind"], EventKind.ONSET) if "event_kind" in run else math.nan


def _kept(ds: xr.Dataset) -> list[GearOutcome | RollerOutcome]:
    """Outcomes of runs that have left their verdict; NaN, 0 or nothing where a number has not been kept."""
    dims = swept_dims(ds)
    labels = product(*(ds[dim].values.tolist() for dim in dims))
    columns = {name: ds[name].values.ravel().tolist() for name in _KEPT if name in ds}
    scheduled = is_scheduled(scene_of(ds))
    windows = run_labels(ds, dims).get("duration", [ds.attrs["t_end"]] * math.prod(ds["verdict"].shape))
    roller, judged = is_roller(ds), list[GearOutcome | RollerOutcome]()
    for number, label in enumerate(labels):
        row = _KEPT | {name: values[number] for name, values in columns.items()}
        both = {name: row[name] for name in ("status", "verdict", "impacts", "wall_time")}
        both |= {"label": dict(zip(dims, label, strict=True))}
        both |= {"imbalance": imbalance(row["residual"], row["residual_bound"])}
        if roller:
            forces = row["largest_mesh_force"], -row["smallest_mesh_force"]
            peak, pull = (max(force, 0.0) for force in forces)  # NaN first, which max leaves where it is
            judged.append(RollerOutcome(**both, peak_force=peak, pull_off_force=pull, restitution=math.nan))
        else:
            numbers = {"min_speed": row["min_gear_speed"], "max_speed": row["max_gear_speed"]}
            stood = row["back_time"] if math.isnan(row["stick_time"]) else row["stick_time"]
            numbers |= {"stick_time": stood, "mesh_exits": row["stick_exits"]}
            numbers |= {name: row[name] for name in ("free_advance", "advance", "turned_back", "settled")}
            numbers |= {"holding": Holding(row["holding"]), "scheduled": scheduled}
            numbers["reached"] = row["followed_time"]
            numbers["old"] = scheduled and "followed_time" not in columns
            judged.append(GearOutcome(**both, **numbers, window=float(windows[number])))
    return judged


_KEPT: dict[str, Any] = {
    "status": "",
    "verdict": "",
    "impacts": 0,
    "stick_exits": 0,
    "holding": 0,
    "settled": 0,
    **dict.fromkeys(("wall_time", "min_gear_speed", "max_gear_speed", "stick_time"), math.nan),
    **dict.fromkeys(("free_advance", "advance", "turned_back", "back_time", "followed_time"), math.nan),
    **dict.fromkeys(("largest_mesh_force", "smallest_mesh_force", "residual", "residual_bound"), math.nan),
}
"""Variables of a sweep made with ``keep``, with what stands for one that has not been kept."""
