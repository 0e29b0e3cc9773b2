"""Lives of an ensemble: the share of gears that still turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearidae.drawing.style import POSITIVE, new_axes, tidy
from gearidae.studies._surviving_share import surviving_share

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def lives(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of gears that still turn against passages, with its 95 % band.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.lives`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        Lives that were followed no further are ticks on the curve.

    Raises
    ------
    SceneError
        If the dataset has no lives, or none is finished.
    """
    found = surviving_share(ds)
    ax = new_axes(ax, height=3.8)
    turning = ds["passages_turning"].values[ds["sticks"].values == 0.0]
    end = max([float(found["passages"][-1]), *turning.tolist()])
    at = np.append(found["passages"].values, end)
    share, low, high = (
        np.append(found[name].values, found[name].values[-1]) for name in ("share", "low", "high")
    )
    ax.fill_between(at, low, high, step="post", color=POSITIVE, alpha=0.25, linewidth=0, label="95 % band")
    ax.step(at, share, where="post", color=POSITIVE, linewidth=1.4, label="still turn")
    if turning.size:
        there = share[np.searchsorted(at[:-1], turning, side="right") - 1]
        ax.plot(turning, there, "|", color="0.3", markersize=8.0, label="followed no further")
    ax.set_ylim(-0.02, 1.02)
    ax.set_xlim(left=0.0)
    ax.set_xlabel("passages of each tooth of the pinion")
    ax.set_ylabel("share of the gears")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax
