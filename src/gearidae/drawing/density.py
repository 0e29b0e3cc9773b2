"""Power spectral densities as colours over frequency, and the frequencies that excite them as lines on top."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.drawing.style import line_width

DECADES: Final = 6
"""Spectra are shown down to this many decades below their largest value."""
_APART: Final = 0.02
"""Part of the picture's height below which a line is not told from zero."""


def draw_density(ax: Axes, across: ArrayLike, frequency: ArrayLike, density: Floats, unit: str) -> None:
    """Draw a density in decibel, with a bar of its colours.

    Parameters
    ----------
    across : array_like, shape (n,)
        Time or speed.
    frequency : array_like, shape (m,)
        [Hz].
    density : ndarray, shape (m, n)
    unit : str
        Of the density, as it shall read.
    """
    strongest = float(np.nanmax(np.append(density, 0.0))) or 1.0
    level = 10.0 * np.log10(np.maximum(density, strongest * 10.0**-DECADES))
    colours = ax.pcolormesh(across, frequency, level, shading="nearest", cmap="viridis", rasterized=True)
    ax.figure.colorbar(colours, ax=ax, pad=0.02).set_label(f"dB re 1 {unit}")


def line_on_density(ax: Axes, across: ArrayLike, frequency: Floats, words: str, style: str = "-") -> None:
    """Draw a frequency over time or speed in white."""
    ax.plot(across, frequency, style, color="white", linewidth=line_width(0.8), label=words)


def is_apart(frequency: Floats, top: float) -> bool:
    """Whether a line can be told from zero in a picture up to some frequency [Hz]."""
    return bool(np.nanmax(frequency) > _APART * top)


def legend_on_density(ax: Axes, size: str) -> None:
    """Name the lines, in letters that are read on the colours."""
    ax.legend(loc="upper left", fontsize=size, labelcolor="white", facecolor="0.2")
