"""Settings of matplotlib for figures in a journal, or from a file."""

from __future__ import annotations

import os
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
from matplotlib.style import library

from gearidae.drawing.picture import Settings
from gearidae.errors import SceneError

_WIDTHS: Final = {1: (3.4, 2.4), 2: (7.0, 3.2)}
"""Width and height [inches] of a figure over one and two columns of a page; journals of physics have 86 and 178 mm."""
_JOURNAL: Final[dict[str, Any]] = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
    "lines.markersize": 4.0,
    "hatch.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "savefig.dpi": 600.0,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Letters as letters also in PDF (TrueType), as publishers ask for."""
_NEVER: Final = ("backend", "interactive", "toolbar")
"""Settings of a file that no style changes."""


def style(name: str | os.PathLike[str] = "journal", *, columns: int = 1) -> AbstractContextManager[None]:
    """Draw in a style from now on, or inside a ``with`` block only.

    Parameters
    ----------
    name : str or path-like, optional
        ``journal``, a style of matplotlib (``ggplot``), or a file with settings (``mine.mplstyle``).
    columns : {1, 2}, optional
        Of the page that a figure of the style ``journal`` spans: 3.4 or 7.0 inches.

    Returns
    -------
    context manager
        At the end of its block the settings are again what they were.

    Raises
    ------
    SceneError
        If there is no such style, or another number of columns.

    Notes
    -----
    What is set are matplotlib's own ``rcParams``, which all functions of `gearidae.plot` follow: size of the figure and
    of its letters, widths of lines, the cycle of colours. Figures of several panels take the width and keep their
    shape. Blue for what pushes, orange for what pulls, and the colours of verdicts stay.
    """
    if name == "journal":
        if columns not in _WIDTHS:
            raise SceneError("columns", columns, "must be 1 or 2")
        return Settings({**_JOURNAL, "figure.figsize": _WIDTHS[columns]})
    return Settings(_settings(name))


def _settings(name: str | os.PathLike[str]) -> dict[str, Any]:
    """Settings of a style of matplotlib or of a file."""
    if str(name) in library:
        known: Any = library[str(name)]
        return {key: value for key, value in known.items() if key not in _NEVER}
    try:
        found: Any = mpl.rc_params_from_file(Path(name), use_default_template=False)
    except (OSError, UnicodeDecodeError) as error:
        names = ", ".join(sorted(str(other) for other in library if not str(other).startswith("_")))
        raise SceneError(
            "style", name, f"must be journal, a file that can be read, or one of {names}"
        ) from error
    return {key: value for key, value in found.items() if key not in _NEVER}
