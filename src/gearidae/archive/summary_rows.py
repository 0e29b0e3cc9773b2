"""Run summary and energy balance of a single run as rows of names, values and remarks.

The terminal and the report show these rows, in these words; the names are those of the archive.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from typing import Any, TypeAlias

import xarray as xr

from gearidae.archive.run_summary import counted_over, summary_of
from gearidae.archive.select import is_train
from gearidae.archive.totals import balance_of, imbalance
from gearidae.archive.train import passed_on, work_shares
from gearidae.records.energy import LOSSES, TERMS
from gearidae.scene.prefixes import with_prefix

Row: TypeAlias = tuple[str, str, str]
"""Name, value and remark; a row without a value is a heading."""


def summary_rows(ds: xr.Dataset) -> list[Row]:
    """List the run summary and the energy balance of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run; a roller has an energy balance only, a sweep neither.

    Returns
    -------
    list of (str, str, str)
    """
    rows: list[Row] = []
    if summary := summary_of(ds):
        rows += _with_reach(ds, _summary_rows(summary.as_plain()))
    rows += _standing_rows(ds)
    if is_train(ds) and "drive_work" in ds and not ds["drive_work"].dims:
        rows += _work_rows(ds)
    if numbers := balance_of(ds):
        rows += _with_reach(ds, _balance_rows(numbers))
    return rows


def _with_reach(ds: xr.Dataset, rows: Iterator[tuple[str, Row]]) -> Iterator[Row]:
    """Add to each named row of a run that goes on from another what it is counted over."""
    for name, (words, value, remark) in rows:
        over = counted_over(name, ds.attrs) if name else ""
        yield words, value, "; ".join(filter(None, (remark, over)))


def _summary_rows(kept: dict[str, Any]) -> Iterator[tuple[str, Row]]:
    def row(name: str, unit: str, remark: str) -> tuple[str, Row]:
        words = "time trapped by adhesion" if name == "time_adhering" else name.replace("_", " ")
        return name, (words, number(name, unit), remark)

    def number(name: str, unit: str) -> str:
        if kept[name] is None:
            return "-"
        return f"{kept[name]:.4g} {unit}" if unit == "rad/s" else with_prefix(kept[name], unit, 4)

    yield "", ("Run summary", "", "")
    yield row("top_speed", "rad/s", "of the gear")
    yield row("time_to_speed", "s", "first sample with 95 % of the largest")
    held = f"held by {kept['held_by']} at the end" if kept["held_by"] else ""
    times = "once" if kept["sticks"] == 1 else f"{kept['sticks']} times"
    holder = "dry resistance or friction" if kept.get("friction_loss") else "dry resistance"
    yield row("time_at_rest", "s", f"held by {holder}, stuck {times}; {held}".rstrip("; "))
    yield row("time_adhering", "s", "rocking within half a pitch")
    if kept["largest_force"] is not None:
        yield row("largest_force", "N", f"at {number('largest_force_time', 's')}")
    if kept.get("friction_loss") and kept["efficiency"] is not None:
        share = f"{100.0 * kept['efficiency']:.4g} %"
        yield "efficiency", ("efficiency", share, "drag and dry resistance over all losses")


def _work_rows(ds: xr.Dataset) -> Iterator[Row]:
    """Where the work of a train's drive goes, part by part; the shares add up to 1."""
    if not (shares := work_shares(ds)):
        return
    yield "Work of the drive", with_prefix(float(ds["drive_work"]), "J", 5), "share of it"
    efficiency = passed_on(ds)
    for name, energy, share in shares:
        passes = efficiency.get(name, math.nan)
        words = "" if math.isnan(passes) else f"; passes {100.0 * passes:.4g} % of what arrives"
        yield name, with_prefix(energy, "J", 4), f"{100.0 * share:.3g} %{words}"


def _standing_rows(ds: xr.Dataset) -> Iterator[Row]:
    """How long the gear stood, and when it started."""
    if "standing_time" not in ds or ds["standing_time"].dims or math.isnan(float(ds["standing_time"])):
        return
    count, rest = int(ds["standstills"]), float(ds["standing_rest_time"])
    if count:
        times = "1 standstill" if count == 1 else f"{count} standstills"
        remark = f"{times}; {with_prefix(rest, 's', 4)} of it held at rest"
        yield "time standing", with_prefix(float(ds["standing_time"]), "s", 4), remark
    start = float(ds["start_time"])
    if count and start > 0.0:
        torque = with_prefix(float(ds["breakaway_torque"]), "N m", 4)
        yield (
            "start time",
            with_prefix(start, "s", 4),
            f"end of the last standstill, at a drive torque of {torque}",
        )


def _balance_rows(kept: dict[str, float]) -> Iterator[tuple[str, Row]]:
    yield "", ("Energy balance", "", "")
    least = sys.float_info.epsilon * kept["throughput"]  # what is smaller changes no digit of the sum
    for name, term in TERMS.items():
        if abs(kept[name]) > least:
            part = "input" if term.sign > 0 else "lost" if name in LOSSES else ""
            remark = ", ".join(filter(None, (part, term.remark)))
            yield name, (name.replace("_", " "), with_prefix(kept[name], "J", 5), remark)
    bound = with_prefix(kept["residual_bound"], "J", 2)
    out_by = imbalance(kept["residual"], kept["residual_bound"])
    remark = (
        f"{out_by:.2g} times its bound of {bound}: do not rely on this run"
        if out_by > 1.0
        else f"bound {bound}"
    )
    yield "residual", ("residual", with_prefix(kept["residual"], "J", 2), remark)
