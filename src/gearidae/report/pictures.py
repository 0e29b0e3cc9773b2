"""The pictures of a report, as drawings inside the page."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from gearidae import plot
from gearidae.archive.select import is_roller, swept_dims
from gearidae.drawing.picture import usual_style
from gearidae.errors import SceneError
from gearidae.plot.spectra import alias_note
from gearidae.report import html
from gearidae.report.svg import colour_rules, drawing

_OUTCOME = {"outcome": "Outcome of each run against what was swept"}
_GEARS = {
    "overview": "Speed of the gear and torque of the tooth contacts on it",
    "gap": "Smallest gap between the teeth, drive flank",
    "power_spectrum": "Power spectrum of the gear's speed",
    "impact_forces": "Largest forces of the impacts",
}
_RINGING = "impact_spectrum"
_SINGLE = {_RINGING: "Spectrum of the ringing after mesh impacts"}
_NUMBER = re.compile(r"\d[\d.e+-]*")
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
    aliases = _RINGING in wanted and not any(name == _RINGING for name, *_ in shown) and _alias_note(ds)
    lacking = html.paragraph(f"{wanted[_RINGING]}: not drawn, {aliases}.", "hint") if aliases else ""
    if not shown:
        return lacking
    content = "\n".join(
        f'<figure class="picture" data-name="{html.text(name)}"><div class="wide" role="region" tabindex="0" '
        f'aria-label="{html.text(caption)}">{text}</div><figcaption>{html.text(caption + note)}</figcaption></figure>'
        for name, text, note, caption in shown
    )
    return f"<style>\n{colour_rules(text for _, text, *_ in shown)}</style>\n{content}\n{lacking}"


def _alias_note(ds: xr.Dataset) -> str:
    """Say that the ringing cannot be told from aliases, where that is so."""
    try:
        return alias_note(ds)
    except SceneError:  # no samples
        return ""


def _drawn(ds: xr.Dataset, name: str, caption: str) -> tuple[str, str]:
    """Return the drawing, empty without enough data, and what it warns of: a reader of the page has no terminal."""
    try:
        with warnings.catch_warnings(record=True, action="always", category=UserWarning) as caught:
            made = getattr(plot, name)(ds)
    except SceneError:
        return "", ""
    figure = made if isinstance(made, Figure) else made.get_figure(root=True)
    # runs of a sweep warn of the same with other numbers
    notes: dict[str, list[str]] = {}
    for warning in caught:
        if warning.category is UserWarning:
            notes.setdefault(_NUMBER.sub("#", str(warning.message)), []).append(str(warning.message))
    words = [
        f"{first[:1].upper()}{first[1:]}{f' ({len(others) + 1} runs alike)' if others else ''}"
        for first, *others in notes.values()
    ]
    return drawing(figure, name, caption), "".join(f". {word}" for word in words)
