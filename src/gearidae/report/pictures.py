"""The pictures of a report, as data inside the page."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from gearidae import plot
from gearidae.archive.select import is_roller, swept_dims
from gearidae.errors import SceneError
from gearidae.report import html

__all__ = ["pictures"]

_DPI = 130
_Draw = Callable[[xr.Dataset], Any]

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
        Figures with captions; a picture that the dataset is too short or too empty for is left out.
    """
    wanted = _ROLLER if is_roller(ds) else _GEARS if swept_dims(ds) else _GEARS + _SINGLE
    return "\n".join(filter(None, (_figure(ds, draw, caption) for draw, caption in wanted)))


def _figure(ds: xr.Dataset, draw: _Draw, caption: str) -> str:
    try:
        drawn = draw(ds)
    except SceneError:
        return ""
    figure = drawn if isinstance(drawn, Figure) else drawn.get_figure(root=True)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=_DPI)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    width, height = (round(_DPI * inches) for inches in figure.get_size_inches())
    return (
        f'<figure><img alt="{html.text(caption)}" width="{width}" height="{height}" '
        f'src="data:image/png;base64,{data}"><figcaption>{html.text(caption)}</figcaption></figure>'
    )
