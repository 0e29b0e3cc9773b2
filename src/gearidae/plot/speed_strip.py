"""The speed over a whole run as a strip below a picture of one time."""

from __future__ import annotations

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from gearidae.drawing.style import NEGATIVE, runs_of, scale_for, tidy


def speed_strip(ax: Axes, ds: xr.Dataset, shaft: str) -> tuple[float, Line2D]:
    """Draw the speed of the gear, or of a train's judged shaft, over the whole run with a mark for the time.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run.
    shaft : str
        What the axis calls it.

    Returns
    -------
    factor : float
        From seconds to the unit of the axis.
    cursor : matplotlib Line2D
        The mark, at time 0.
    """
    (run,) = runs_of(ds, "gear_speed")
    at, values = run.trace("gear_speed")
    scale = scale_for(float(at[-1]), "s")
    ax.plot(at * scale.factor, values, color="0.35", linewidth=0.8)
    tidy(ax)
    ax.set_xlabel(f"time ({scale.unit})", fontsize="small", labelpad=1)
    ax.set_ylabel(f"{shaft} (rad/s)", fontsize="small")
    ax.yaxis.set_label_coords(-0.065, 0.5)
    ax.tick_params(labelsize="x-small")
    return scale.factor, ax.axvline(0.0, color=NEGATIVE, linewidth=1.4)
