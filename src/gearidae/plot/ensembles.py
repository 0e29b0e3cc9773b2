"""Pictures of ensembles: probability of sticking, and what a figure depends on."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.errors import SceneError
from gearidae.plot.parameter_axis import parameter_axis
from gearidae.plot.style import NEGATIVE, POSITIVE, new_axes, tidy
from gearidae.studies._sticking_probability import drawn_keys
from gearidae.studies._sticking_probability import sticking_probability as probability_of

_COVERAGE = "coating.sam_fraction"


def sticking_probability(
    ds: xr.Dataset, ax: Axes | None = None, *, over: str | None = None, bins: int | None = None
) -> Axes:
    """Draw the probability of sticking against one of the keys that were drawn, with its 95 % band.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.ensemble`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    over : str, optional
        The key; by default the coverage if it was drawn, else the first.
    bins : int, optional
        As for `gearidae.studies.sticking_probability`.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is no ensemble, or the key was not drawn.
    """
    names = drawn_keys(ds)
    over = over or (_COVERAGE if _COVERAGE in names else next(iter(names)))
    found = probability_of(ds, over, bins=bins)
    name = names[over]
    along = parameter_axis(found[name])
    ax = new_axes(ax, height=3.8)
    ax.fill_between(
        along.places, found["low"], found["high"], color=POSITIVE, alpha=0.25, linewidth=0, label="95 % band"
    )
    ax.plot(
        along.places,
        found["probability"],
        color=POSITIVE,
        marker=".",
        linewidth=1.4,
        label="members that stick",
    )
    ax.set_ylim(-0.02, 1.02)
    ax.set_xlabel(along.label)
    ax.set_ylabel("probability of sticking")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


def sobol_indices(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw Sobol' indices as a tornado: the keys below each other, the most influential on top.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.ensemble` with ``of=``.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With standard uncertainties as error bars.

    Raises
    ------
    SceneError
        If the dataset has no indices.
    """
    if "total_order" not in ds:
        raise SceneError(
            "plot", "sobol_indices", "needs an ensemble with indices: studies.ensemble(..., of=figure)"
        )
    order = np.argsort(np.nan_to_num(ds["total_order"].values))
    keys = ds["parameter"].values[order]
    ax = new_axes(ax, height=1.4 + 0.5 * len(keys))
    for shift, name, colour, label in (
        (0.2, "total_order", POSITIVE, "total"),
        (-0.2, "first_order", NEGATIVE, "first order"),
    ):
        ax.barh(
            np.arange(len(keys)) + shift,
            ds[name].values[order],
            height=0.36,
            xerr=ds[f"{name}_uncertainty"].values[order],
            color=colour,
            ecolor="0.3",
            capsize=2.0,
            label=label,
        )
    ax.set_yticks(np.arange(len(keys)), keys)
    ax.axvline(0.0, color="0.3", linewidth=0.8)
    ax.set_xlabel(f"share of the variance of {ds.attrs['index_of']}")
    tidy(ax)
    ax.margins(x=0.05)
    ax.grid(visible=False, axis="y")
    ax.legend(frameon=False, fontsize="small", loc="lower right")
    return ax
