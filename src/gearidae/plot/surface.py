"""Picture of a measured surface: its asperities against the cut-off wavelength."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axis import Axis
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import LogLocator, NullFormatter

from gearidae.drawing.picture import new_picture
from gearidae.drawing.style import label_axis, line_colour, line_style, line_width, tidy
from gearidae.errors import SceneError

_PANELS = (
    ("roughness", "roughness $\\sigma$", "m"),
    ("asperity_density", "density $N$", "1/µm²"),
    ("asperity_radius", "tip radius $\\beta$", "m"),
)
_PER_SQUARE_MICRON = 1e-12


def surface(
    ds: xr.Dataset, cutoff: float | None = None, *, figure: Figure | SubFigure | None = None
) -> Figure | SubFigure:
    """Draw the three numbers of a rough surface against the cut-off wavelength.

    Parameters
    ----------
    ds : Dataset
        ``statistics`` of `gearidae.surface_from`.
    cutoff : float, optional
        Chosen cut-off wavelength [m], to be marked.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw; by default a new one.

    Returns
    -------
    Figure
        Three panels over one axis: roughness, density and tip radius of the asperities, by summits and by moments.

    Raises
    ------
    SceneError
        If the dataset is none of a measured surface.
    """
    missing = [name for name in ("by", "cutoff", *(name for name, *_ in _PANELS)) if name not in ds.variables]
    if missing:
        raise SceneError("plot", ", ".join(missing), "is missing: give .statistics of gearidae.surface_from")
    figure = figure or new_picture((6.4, 6.0), panels=True, layout="constrained")
    panels = figure.subplots(len(_PANELS), 1, sharex=True)
    for ax, (name, label, unit) in zip(panels, _PANELS, strict=True):
        factor = _PER_SQUARE_MICRON if unit.startswith("1/") else 1.0
        for number, way in enumerate(ds["by"].values.tolist()):
            ax.plot(
                ds["cutoff"].values,
                factor * ds[name].sel(by=way).values,
                color=line_colour(number),
                linestyle=line_style(number),
                marker="os"[number % 2],
                markersize=3,
                linewidth=line_width(1.3),
                label=f"by {way}",
            )
        if cutoff is not None:
            ax.axvline(cutoff, color="0.5", linewidth=line_width(0.9))
        ax.set_xscale("log")
        if np.nanmax(ds[name].values) > 5.0 * np.nanmin(ds[name].values):
            ax.set_yscale("log")
            _label_decades(ax.yaxis)
        if unit == "m":
            label_axis(ax.yaxis, label, unit)
        else:
            ax.yaxis.set_major_formatter("{x:g}")
            ax.set_ylabel(f"{label} ({unit})")
        tidy(ax)
    panels[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")
    _label_decades(panels[-1].xaxis)
    label_axis(panels[-1].xaxis, "cut-off wavelength, shorter waves are left out", "m")
    return figure


def _label_decades(axis: Axis) -> None:
    """Label 1, 2 and 5 of each decade: most of these axes are not much longer than one."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_formatter(NullFormatter())
