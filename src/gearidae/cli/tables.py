"""Tables printed by the commands."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import xarray as xr
from rich import box
from rich.table import Table
from rich.text import Text

from gearidae.analysis.verdict import GearOutcome, RollerOutcome, outcomes
from gearidae.archive.energy import balance_in_attributes, imbalance
from gearidae.archive.run_summary import counted_over
from gearidae.archive.select import scene_of, swept_dims
from gearidae.cli.output import complain, say, show
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.validity_row import ATTRIBUTE, holds_rows, mean_note, rows_from_json

_GEAR_HEADINGS = ("outcome", "min rad/s", "max rad/s", "impacts", "wall s")
_ROLLER_HEADINGS = ("outcome", "peak", "pull-off", "restitution", "impacts", "wall s")
_NAMED = 3
"""Failed members that are named."""


_BALANCE_ROWS = (
    ("drive_work", "input"),
    ("radius_work", "input, from the change of the radii of curvature along the path of contact"),
    ("model_change", "input, from the change to the elastic contact model"),
    ("drag_loss", "lost"),
    ("dry_loss", "lost"),
    ("damping_loss", "lost"),
    ("adhesion_loss", "lost"),
    ("drive_friction_loss", "lost"),
    ("coast_friction_loss", "lost"),
    ("pinion_hub_loss", "lost"),
    ("gear_hub_loss", "lost"),
    ("stored_change", "stored in contacts"),
    ("kinetic_change", "stored in motion"),
)


def show_outcomes(ds: xr.Dataset) -> None:
    """Print the outcome of each run of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    """
    judged = outcomes(ds)
    rtol = scene_of(ds)["run"]["rtol"]
    dims = swept_dims(ds)
    headings = _ROLLER_HEADINGS if isinstance(judged[0], RollerOutcome) else _GEAR_HEADINGS
    table = Table(box=box.SIMPLE, pad_edge=False)
    for heading in (*dims, *headings):
        if heading == "outcome":
            table.add_column(heading)  # a long one is wrapped; numbers are whole
        else:
            table.add_column(heading, justify="right", no_wrap=True)
    for outcome in judged:
        cells = _roller_cells(outcome) if isinstance(outcome, RollerOutcome) else _gear_cells(outcome, rtol)
        table.add_row(*(_plain(value) for value in outcome.label.values()), *cells)
    show(table)
    kept = ds.attrs.get(ATTRIBUTE)
    if isinstance(kept, str) and holds_rows(kept) and (note := mean_note(rows_from_json(kept))):
        say(f"{'Verdicts are a' if len(judged) > 1 else 'The verdict is a'} {note}")


def show_account(ds: xr.Dataset) -> None:
    """Print the run summary and the energy balance of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run; of a roller, only the energy balance is printed. Nothing is printed for a sweep.
    """
    if "account" in ds.attrs:
        show_rows(_with_reach(ds, _account_rows(json.loads(ds.attrs["account"]))))
    if numbers := balance_in_attributes(ds):
        show_rows(_with_reach(ds, _balance_rows(numbers)))


Row = tuple[str, str, str]


def _with_reach(ds: xr.Dataset, rows: Iterable[tuple[str, Row]]) -> Iterable[Row]:
    """Add to each named row of a run that goes on from another what it is counted over."""
    for name, (words, value, remark) in rows:
        over = counted_over(name, ds.attrs) if name else ""
        yield words, value, "; ".join(filter(None, (remark, over)))


def _balance_rows(kept: dict[str, float]) -> Iterable[tuple[str, Row]]:
    yield "", ("Energy balance", "", "")
    for name, remark in _BALANCE_ROWS:
        if kept[name] != 0.0:
            yield name, (name.replace("_", " "), with_prefix(kept[name], "J", 5), remark)
    bound = with_prefix(kept["residual_bound"], "J", 2)
    out_by = imbalance(kept["residual"], kept["residual_bound"])
    remark = (
        f"{out_by:.2g} times its bound of {bound}: do not rely on this run"
        if out_by > 1.0
        else f"bound {bound}"
    )
    yield "residual", ("residual", with_prefix(kept["residual"], "J", 2), remark)


def _account_rows(told: dict[str, Any]) -> Iterable[tuple[str, Row]]:
    def row(name: str, words: str, unit: str, remark: str) -> tuple[str, Row]:
        return name, (words, number(name, unit), remark)

    def number(name: str, unit: str) -> str:
        return "-" if told[name] is None else with_prefix(told[name], unit, 4)

    yield "", ("Run summary", "", "")
    yield row("time_to_speed", "time to speed", "s", "first sample with 95 % of the largest")
    held = f"held by {told['held_by']} at the end" if told["held_by"] else ""
    times = "once" if told["sticks"] == 1 else f"{told['sticks']} times"
    holder = "dry resistance or friction" if told.get("friction_loss") else "dry resistance"
    stuck = f"held by {holder}, stuck {times}; {held}".rstrip("; ")
    yield row("time_at_rest", "time at rest", "s", stuck)
    yield row("time_adhering", "time trapped by adhesion", "s", "rocking within half a pitch")
    if told["largest_force"] is not None:
        yield row("largest_force", "largest force", "N", f"at {number('largest_force_time', 's')}")
    if told.get("friction_loss"):
        yield (
            "efficiency",
            ("efficiency", f"{100.0 * told['efficiency']:.4g} %", "drag and dry resistance over all losses"),
        )


def show_rows(rows: Iterable[tuple[str, str, str]]) -> None:
    """Print names, values and remarks in three columns.

    Parameters
    ----------
    rows : iterable of (str, str, str)
        A row without a value is a heading.
    """
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    for name, value, remark in rows:
        table.add_row(Text(f"  {name}") if value else Text(name, style="bold"), Text(value), Text(remark))
    show(table)


def name_failures(ds: xr.Dataset) -> int:
    """Say which members of an ensemble could not be finished, and why.

    Parameters
    ----------
    ds : xarray.Dataset
        With ``status`` and ``message`` along ``member``.

    Returns
    -------
    int
        How many.
    """
    failed = [number for number, word in enumerate(ds["status"].values.tolist()) if word != "finished"]
    for number in failed[:_NAMED]:
        one = ds.isel(member=number)
        complain(f"member {number}: {one['message'].item() or one['status'].item()}")
    if len(failed) > _NAMED:
        complain(f"{len(failed) - _NAMED} more members could not be finished")
    return len(failed)


def label_text(label: Mapping[str, Any]) -> str:
    """Write a run's label as text, ``sam_fraction = 0.5``."""
    return ", ".join(f"{dim} = {_plain(value)}" for dim, value in label.items())


def _gear_cells(outcome: GearOutcome, rtol: float) -> Sequence[str]:
    return (
        _verdict(outcome),
        _number(outcome.resolved_min_speed(rtol)),
        _number(outcome.max_speed),
        str(outcome.impacts),
        f"{outcome.wall_time:.2f}",
    )


def _roller_cells(outcome: RollerOutcome) -> Sequence[str]:
    return (
        _verdict(outcome),
        with_prefix(outcome.peak_force, "N", 4),
        with_prefix(outcome.pull_off_force, "N", 4),
        _number(outcome.restitution),
        str(outcome.impacts),
        f"{outcome.wall_time:.2f}",
    )


def _verdict(outcome: GearOutcome | RollerOutcome) -> str:
    if outcome.status == "finished" or outcome.verdict == "unfinished":
        return outcome.words
    return f"{outcome.words} ({outcome.status})"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.4g}"


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
