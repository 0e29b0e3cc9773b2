"""The picture of a sticking threshold."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.drawing.parameter_axis import parameter_axis
from gearidae.drawing.style import NEGATIVE, POSITIVE, new_axes, tidy
from gearidae.errors import SceneError
from gearidae.studies.products import require


def sticking_threshold(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the limit at which a gear begins to stick against the mesh exits waited for, with its bracket.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.sticking_threshold`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is no sticking threshold.
    """
    require(ds, "sticking_threshold")
    ax = new_axes(ax, height=3.8)
    ds = ds.isel(exits=np.isfinite(ds["limit"].values))
    if not ds.sizes["exits"]:
        raise SceneError("plot", "sticking_threshold", "no run has stuck")
    exits = ds["exits"].values
    together = xr.concat([ds[name].drop_attrs() for name in ("passes", "limit", "sticks")], "end")
    key = str(ds["limit"].attrs["long_name"]).removeprefix("sticking limit of ")
    along = parameter_axis(together.rename(key.rpartition(".")[2]).assign_attrs(ds["limit"].attrs))
    passes, limit, sticks = along.places
    ax.plot(exits, passes, "^", color=POSITIVE, markersize=5, label="passes")
    ax.plot(exits, limit, color="0.3", linewidth=1.2, label="limit")
    ax.plot(exits, sticks, "X", color=NEGATIVE, markersize=5, label="sticks")
    ax.set_xscale("log")
    ax.set_xticks(exits, [str(number) for number in exits])
    ax.minorticks_off()
    ax.set_xlabel("mesh exits waited for")
    ax.set_ylabel(along.label)
    tidy(ax)
    ax.margins(x=0.03)
    ax.legend(frameon=False, fontsize="small")
    return ax
