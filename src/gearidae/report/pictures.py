"""The pictures of a report, as drawings inside the page."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from gearidae import plot
from gearidae.archive.select import is_roller, swept_dims
from gearidae.drawing.picture import usual_style
from gearidae.errors import SceneError
from gearidae.report import html
from gearidae.report.svg import colour_rules, drawing

_OUTCOME = {"outcome": "Outcome of each run against what was swept"}
_GEARS = {
    "overview": "Speed of the gear and torque of the tooth contacts on it",
    "gap": "Smallest gap between the teeth, drive flank",
    "power_spectrum": "Power spectrum of the gear's speed",
}
_SINGLE = {"impact_spectrum": "Spectrum of the ringing after mesh impacts"}
_ROLLER = {"overview": "Contact force and gap of the roller"}


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
    wanted = _ROLLER if is_roller(ds) else _GEARS if swept else _GEARS | _SINGLE
    if swept:
        wanted = _OUTCOME | wanted
    return figures(ds, wanted)


def figures(ds: xr.Dataset, wanted: Mapping[str, str]) -> str:
    """Draw pictures, functions of `gearidae.plot` with their captions; those without enough data are left out."""
    with usual_style():
        drawn = [(name, *_drawn(ds, name, caption), caption) for name, caption in wanted.items()]
    shown = [(name, text, note, caption) for name, text, note, caption in drawn if text]
    if not shown:
        return ""
    content = "\n".join(
        f'<figure class="picture" data-name="{html.text(name)}"><div class="wide" role="region" tabindex="0" '
        f'aria-label="{html.text(caption)}">{text}</div><figcaption>{html.text(caption + note)}</figcaption></figure>'
        for name, text, note, caption in shown
    )
    return f"<style>\n{colour_rules(text for _, text, *_ in shown)}</style>\n{content}"


def _drawn(ds: xr.Dataset, name: str, caption: str) -> tuple[str, str]:
    """Return the drawing, empty without enough data, and what it warns of: a reader of the page has no terminal."""
    try:
        with warnings.catch_warnings(record=True, action="always", category=UserWarning) as caught:
            made = getattr(plot, name)(ds)
    except SceneError:
        return "", ""
    figure = made if isinstance(made, Figure) else made.get_figure(root=True)
    notes = dict.fromkeys(str(warning.message) for warning in caught if warning.category is UserWarning)
    return drawing(figure, name, caption), "".join(f". {note[:1].upper()}{note[1:]}" for note in notes)
