"""The picture of the pull-off forces of drawn pairs."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.drawing.style import COLOURS, new_axes, scale_for, tidy
from gearidae.studies.products import require


def pull_off(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of drawn pairs that part below a force.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.pull_off`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is none of pull-off forces.
    """
    forces = np.sort(require(ds, "pull_off")["pull_off"].values)
    scale = scale_for(float(forces[-1]), "N")
    ax = new_axes(ax, height=3.2)
    shares = np.arange(1, forces.size + 1) / forces.size
    ax.step(np.append(0.0, forces) * scale.factor, np.append(0.0, shares), where="post", color=COLOURS[0])
    ax.set_xlabel(f"pull-off ({scale.unit})")
    ax.set_ylabel("share of the pairs that part")
    ax.set_ylim(0.0, 1.0)
    tidy(ax)
    return ax
