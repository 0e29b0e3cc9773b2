"""How hard the teeth meet: histograms of the largest force of each impact."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.archive.select import refuse_train
from gearidae.arrays import Floats
from gearidae.drawing.style import legend, line_width, new_axes, runs_of, scale_for, tidy
from gearidae.errors import SceneError
from gearidae.records import Flank

_FORCE, _FLANK = "tooth_impact_largest_force", "tooth_impact_flank"
_PER_DECADE = 10
"""Bins of a decade of the force."""


def impact_forces(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw how many impacts were how hard: a histogram of their largest forces, of a single run by flanks.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep with ``run.impacts``; of more than seven runs, seven are shown.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If no impacts have been kept, or none pushes.
    """
    if _FORCE not in ds:
        refuse_train(ds)
        raise SceneError("run.impacts", "false", "must be true for this picture")
    drawn = runs_of(ds, _FORCE)
    forces = [run.data[_FORCE].values for run in drawn]
    pushing = np.concatenate([force[force > 0.0] for force in forces])
    if not pushing.size:
        raise SceneError("plot", "impact_forces", "no impact has a force above zero")
    edges = _edges(pushing)
    across = scale_for(float(edges[-1]), "N")
    ax = new_axes(ax)
    if len(drawn) > 1:
        for run, force in zip(drawn, forces, strict=True):
            counts, _ = np.histogram(force, edges)
            ax.stairs(
                counts, edges * across.factor, color=run.colour, linestyle=run.line, linewidth=line_width(1.4)
            )
            ax.plot([], [], color=run.colour, linestyle=run.line, label=run.label)
        legend(ax, drawn)
    else:
        flank = drawn[0].data[_FLANK].values
        groups = [(side, forces[0][flank == side]) for side in (Flank.DRIVE, Flank.COAST)]
        groups = [(side, force) for side, force in groups if force.size]
        ax.hist(
            [force * across.factor for _, force in groups],
            (edges * across.factor).tolist(),
            stacked=True,
            label=[f"{side.name.lower()} flank ({force.size})" for side, force in groups],
        )
        ax.legend(frameon=False, fontsize="small")
    ax.set_xscale("log")
    tidy(ax)
    ax.set_xlabel(f"largest force of an impact ({across.unit})")
    ax.set_ylabel("impacts")
    return ax


def _edges(forces: Floats) -> Floats:
    """Edges of the bins: equal shares of a decade."""
    low, high = (np.log10(extreme) for extreme in (forces.min(), forces.max()))
    first, last = np.floor(_PER_DECADE * low), np.floor(_PER_DECADE * high) + 1.0
    return np.asarray(10.0 ** (np.arange(first, last + 1.0) / _PER_DECADE))
