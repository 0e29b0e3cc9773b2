"""Verdicts as a table in a notebook, and standstills with the verdict of each."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from typing import Any, TypeVar

import xarray as xr

from gearidae.analysis.verdict.judge import standing_verdict
from gearidae.archive.select import runs, swept_dims
from gearidae.archive.totals import standstills_from_text
from gearidae.archive.variables import STANDSTILL_LIST
from gearidae.errors import SceneError
from gearidae.records.standing import COLUMNS, Holding
from gearidae.scene.prefixes import with_prefix

T = TypeVar("T")

_SHORT = ("min_speed", "max_speed", "peak_force", "pull_off_force", "restitution", "impacts", "wall_time")
"""What stands beside the words, which say when a gear came to stand and after how many exits."""

_OF_STANDSTILLS = (
    "begin",
    "end",
    "advance",
    "free_advance",
    "held_torque",
    "held_by",
    "verdict",
    "rest_time",
)
_COLUMNS = {
    "min_speed": ("min speed", "rad/s"),
    "max_speed": ("max speed", "rad/s"),
    "stick_time": ("came to stand at", "s"),
    "mesh_exits": ("mesh exits", ""),
    "peak_force": ("peak force", "N"),
    "pull_off_force": ("pull-off force", "N"),
    "restitution": ("restitution", ""),
    "impacts": ("impacts", ""),
    "wall_time": ("wall time", "s"),
}
"""Attribute of an outcome to heading and unit."""


def headings(outcome: Any) -> list[str]:
    """Name the columns of `cells`."""
    return ["outcome", *(_COLUMNS[name][0] for name in _SHORT if hasattr(outcome, name))]


def cells(outcome: Any, rtol: float) -> list[str]:
    """Write an outcome as the terminal and the report list it: in words, then numbers with their units.

    Parameters
    ----------
    outcome : GearOutcome or RollerOutcome
    rtol : float
        Relative tolerance of the run, below which a smallest speed is not resolved.
    """
    numbers = {name: getattr(outcome, name) for name in _SHORT if hasattr(outcome, name)}
    if "min_speed" in numbers:
        numbers["min_speed"] = outcome.resolved_min_speed(rtol)
    early = "" if outcome.status == "finished" or outcome.verdict == "unfinished" else f" ({outcome.status})"
    return [outcome.words + early, *(_number(name, value) for name, value in numbers.items())]


class Shown:
    """An outcome that shows itself in a notebook."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        return _table([self])


class Outcomes(list[T]):
    """Outcomes of several runs, which show themselves as one table in a notebook."""

    def _repr_html_(self) -> str:
        return _table(self)


def standstill_rows(ds: xr.Dataset) -> tuple[list[str], list[list[Any]]]:
    """Return names and rows of the table of standstills.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, a sweep, or a selection from one.

    Raises
    ------
    SceneError
        If the runs have not kept their standstills.
    """
    if STANDSTILL_LIST.name not in ds.variables:
        raise SceneError(
            "standstills",
            "(not kept)",
            "need runs of gears of this version; a sweep keeps them with its extremes",
        )
    rows = [
        [*label.values(), *(standstill[name] for name in _OF_STANDSTILLS)]
        for label, run in runs(ds)
        for standstill in _standstills_of(run)
    ]
    return [*swept_dims(ds), *_OF_STANDSTILLS], rows


def _standstills_of(run: xr.Dataset) -> list[dict[str, Any]]:
    standstills = []
    for numbers in standstills_from_text(run[STANDSTILL_LIST.name].item() or "[]"):
        standstill: dict[str, Any] = {"settled": 0.0} | dict(zip(COLUMNS, numbers, strict=False))
        end = float(run["followed_time"]) if math.isnan(standstill["end"]) else standstill["end"]
        standstill["held_by"] = Holding(int(standstill["holding"])).words
        standstill["verdict"] = standing_verdict(
            standstill["free_advance"], standstill["driven_time"], end, int(standstill["settled"])
        )
        standstills.append(standstill)
    return standstills


def _table(outcomes: Sequence[Any]) -> str:
    if not outcomes:
        return "<table></table>"
    first = outcomes[0]
    names = [name for name in _COLUMNS if hasattr(first, name)]
    headings = [*first.label, "outcome", *(_COLUMNS[name][0] for name in names)]
    rows = [
        [
            *(_plain(value) for value in outcome.label.values()),
            outcome.words,
            *(_number(name, getattr(outcome, name)) for name in names),
        ]
        for outcome in outcomes
    ]
    head = "".join(f"<th>{html.escape(str(text))}</th>" for text in headings)
    body = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _number(name: str, value: float) -> str:
    unit = _COLUMNS[name][1]
    if math.isnan(value):
        return "-"
    if not unit or unit == "rad/s":
        return f"{value:.4g} {unit}".rstrip()
    return with_prefix(value, unit, 2 if name == "wall_time" else 4)


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
