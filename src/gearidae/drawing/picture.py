"""Figures that show themselves in a notebook.

Figures here are made without pyplot, so that a notebook's own machinery does not know of them; and of axes it knows
nothing at all. These two say how they look, by the method that Jupyter asks objects for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from io import BytesIO
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_WIDTH = 100
"""Pixels of the page that an inch of a figure takes; the picture itself has more, for fine screens."""


class Picture(Figure):
    """A figure that shows itself in a notebook."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """Return the picture and its size on the page, as Jupyter asks for it."""
        buffer = BytesIO()
        self.savefig(buffer, format="png")
        width, height = (round(_WIDTH * float(inches)) for inches in self.get_size_inches())
        return buffer.getvalue(), {"width": width, "height": height}


class PictureAxes(Axes):
    """Axes that show their figure in a notebook."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]] | None:
        """Return the picture of the whole figure, nothing if that is not ours to show."""
        figure = self.get_figure(root=True)
        return figure._repr_png_() if isinstance(figure, Picture) else None


@contextmanager
def usual_style() -> Iterator[None]:
    """Draw by matplotlib's own settings inside the block, whatever the user's are: they may ask for LaTeX."""
    with mpl.rc_context():
        mpl.rcdefaults()
        yield


def new_picture(size: tuple[float, float], *, panels: bool = False, **options: Any) -> Picture:
    """Make an empty figure.

    Parameters
    ----------
    size : tuple of float
        Width and height [inches], unless ``figure.figsize`` of matplotlib's settings is not the usual one.
    panels : bool, optional
        Whether several panels lie below each other: their figure takes the width of the settings and keeps its shape.
    **options
        As for `matplotlib.figure.Figure`.
    """
    settings: Any = mpl.rcParams
    width, height = settings["figure.figsize"]
    if is_set("figure.figsize"):
        size = (width, width * size[1] / size[0]) if panels else (width, height)
    dpi = float(settings["figure.dpi"]) if is_set("figure.dpi") else 150.0
    return Picture(figsize=size, dpi=dpi, **options)


def is_set(name: str) -> bool:
    """Whether a setting of matplotlib is another than the usual one."""
    settings: Any = mpl.rcParams
    usual: Any = mpl.rcParamsDefault
    return bool(settings[name] != usual[name])


class Settings(AbstractContextManager[None]):
    """Settings of matplotlib that hold from now on, or until the end of a ``with`` block.

    Parameters
    ----------
    changes : dict
        Keys of `matplotlib.rcParams` and values.
    """

    def __init__(self, changes: Mapping[str, Any]) -> None:
        settings: Any = mpl.rcParams
        self._before = {name: settings[name] for name in changes}
        settings.update(changes)

    def __exit__(self, *_: object) -> None:
        settings: Any = mpl.rcParams
        settings.update(self._before)
