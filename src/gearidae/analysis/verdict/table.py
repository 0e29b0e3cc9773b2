"""Verdicts as a table in a notebook."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from typing import Any, TypeVar

from gearidae.scene.prefixes import with_prefix

T = TypeVar("T")

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


class Shown:
    """An outcome that shows itself in a notebook."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        return _table([self])


class Outcomes(list[T]):
    """Outcomes of several runs, which show themselves as one table in a notebook."""

    def _repr_html_(self) -> str:
        return _table(self)


def _table(outcomes: Sequence[Any]) -> str:
    if not outcomes:
        return "<table></table>"
    first = outcomes[0]
    names = [name for name in _COLUMNS if hasattr(first, name)]
    headings = [*first.label, "outcome", *(_COLUMNS[name][0] for name in names)]
    rows = [
        [
            *(_plain(value) for value in one.label.values()),
            one.words,
            *(_number(getattr(one, name), _COLUMNS[name][1]) for name in names),
        ]
        for one in outcomes
    ]
    head = "".join(f"<th>{html.escape(str(text))}</th>" for text in headings)
    body = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _number(value: float, unit: str) -> str:
    if math.isnan(value):
        return "-"
    if not unit or unit == "rad/s":
        return f"{value:.4g} {unit}".rstrip()
    return with_prefix(value, unit, 4)


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
