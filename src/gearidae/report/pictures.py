"""The pictures of a report, as drawings inside the page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from gearidae import plot
from gearidae.archive.select import is_roller, swept_dims
from gearidae.drawing.picture import usual_style
from gearidae.errors import SceneError
from gearidae.report import html
from gearidae.report.svg import colour_rules, drawing

_Draw = Callable[[xr.Dataset], Any]

_OUTCOME: tuple[_Draw, str] = (plot.outcome, "Outcome of each run against what was swept")
_GEARS: tuple[tuple[_Draw, str], ...] = (
    (plot.overview, "Speed of the gear and torque of the tooth contacts on it"),
    (plot.gap, "Smallest gap between the teeth, drive flank"),
    (plot.power_spectrum, "Power spectrum of the gear's speed"),
)
_SINGLE: tuple[tuple[_Draw, str], ...] = (
    (plot.impact_spectrum, "Spectrum of the ringing after mesh impacts"),
)
_ROLLER: tuple[tuple[_Draw, str], ...] = ((plot.overview, "Contact force and gap of the roller"),)


def pictures(ds: xr.Dataset) -> str:
    """Draw what a dataset allows to be drawn.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.

    Returns
    -------
    str
        Figures with captions, and the colours of both schemes; a picture that the dataset is too short or too empty for
        is left out.
    """
    swept = bool(swept_dims(ds))
    wanted = _ROLLER if is_roller(ds) else _GEARS if swept else _GEARS + _SINGLE
    if swept:
        wanted = (_OUTCOME, *wanted)
    return figures(ds, wanted)


def figures(ds: xr.Dataset, wanted: Sequence[tuple[_Draw, str]]) -> str:
    """Draw pictures with their captions; those for which a dataset is too short or too empty are left out."""
    with usual_style():
        drawn = [(draw.__name__, _drawn(ds, draw, caption), caption) for draw, caption in wanted]
    shown = [(name, text, caption) for name, text, caption in drawn if text]
    if not shown:
        return ""
    content = "\n".join(
        f'<figure class="picture" data-name="{html.text(name)}"><div class="wide" role="region" tabindex="0" '
        f'aria-label="{html.text(caption)}">{text}</div><figcaption>{html.text(caption)}</figcaption></figure>'
        for name, text, caption in shown
    )
    return f"<style>\n{colour_rules(text for _, text, _ in shown)}</style>\n{content}"


def _drawn(ds: xr.Dataset, draw: _Draw, caption: str) -> str:
    try:
        made = draw(ds)
    except SceneError:
        return ""
    figure = made if isinstance(made, Figure) else made.get_figure(root=True)
    return drawing(figure, draw.__name__, caption)
