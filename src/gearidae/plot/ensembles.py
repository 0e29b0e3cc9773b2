"""Pictures of ensembles: probability of sticking, and what a figure depends on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.analysis.verdict.codes import STUCK
from gearidae.archive.select import what_of
from gearidae.archive.specimen import SEED_KEYS
from gearidae.archive.variables import COVERAGE_KEY
from gearidae.arrays import Floats
from gearidae.drawing.parameter_axis import parameter_axis
from gearidae.drawing.style import NEGATIVE, POSITIVE, legend_columns, line_width, mark_value, new_axes, tidy
from gearidae.errors import SceneError
from gearidae.plot.outcome import style_of
from gearidae.studies._sticking_probability import as_ensemble, drawn_keys
from gearidae.studies._sticking_probability import sticking_probability as probability_of


def sticking_probability(
    ds: xr.Dataset, ax: Axes | None = None, *, over: str | None = None, bins: int | None = None
) -> Axes:
    """Draw what each member of an ensemble did, and the probability of sticking against one of the keys drawn.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.ensemble`, or a sweep over seeds and other keys.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    over : str, optional
        The key; by default the coverage if it was drawn, else the first other than the seed.
    bins : int, optional
        As for `gearidae.studies.sticking_probability`.

    Returns
    -------
    Axes
        With the 95 % band, and a mark for the verdict of each member: above the curve of those that stick, below it of
        the others.

    Raises
    ------
    SceneError
        If the dataset is no ensemble, or the key was not drawn.
    """
    ds = as_ensemble(ds)
    names = drawn_keys(ds)
    drawn = [key for key in (COVERAGE_KEY, *names) if key in names and key not in SEED_KEYS]
    over = over or next(iter(drawn), next(iter(names)))
    estimate = probability_of(ds, over, bins=bins)
    name = names[over]
    along = parameter_axis(ds[name])
    at = estimate[name].values * along.factor
    ax = new_axes(ax, height=3.8)
    style: dict[str, Any] = {"color": POSITIVE, "alpha": 0.25, "label": "95 % band"}
    if len(at) > 1:
        ax.fill_between(at, estimate["low"], estimate["high"], linewidth=0, **style)
    else:  # a band would have no width
        ax.vlines(at, estimate["low"], estimate["high"], linewidth=6, **style)
    ax.plot(
        at,
        estimate["probability"],
        color=POSITIVE,
        marker=".",
        linewidth=line_width(1.4),
        label="members that stick",
    )
    _mark_members(ax, along.positions, ds["verdict"].values.tolist())
    ax.set_ylim(-0.12, 1.12)
    ax.set_yticks(np.linspace(0.0, 1.0, 6))
    ax.set_xlabel(along.label)
    ax.set_ylabel("probability of sticking")
    tidy(ax)
    ax.margins(x=0.03)
    labels = ax.get_legend_handles_labels()[1]
    ax.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=legend_columns(ax, labels),
        frameon=False,
        fontsize="small",
    )
    return ax


def _mark_members(ax: Axes, positions: Floats, verdicts: Sequence[str]) -> None:
    """Mark what each member did, with a line of marks for those that stick and one for the others."""
    for verdict in dict.fromkeys(verdicts):
        chosen = np.array([other == verdict for other in verdicts])
        style = style_of(verdict)
        ax.plot(
            positions[chosen],
            np.full(chosen.sum(), 1.06 if verdict in STUCK else -0.06),
            style.marker,
            color=style.colour,
            markersize=5,
            alpha=0.7,
            label=f"{verdict} ({chosen.sum()})",
        )


def specimens(ds: xr.Dataset, ax: Axes | None = None, *, of: str | None = None) -> Axes:
    """Draw the distribution function of a figure over the members of an ensemble, with its mean and standard error.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.ensemble`, over the seeds of a population for instance.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    of : str, optional
        The figure; by default the mean speed of the gear, or the final speed of a roller.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is no ensemble, or has no such figure.
    """
    drawn_keys(ds)
    of = of or ("settled_gear_speed" if "settled_gear_speed" in ds else "final_speed")
    if of not in ds or ds[of].dims != ("member",):
        raise SceneError("of", of, "must be a figure of the ensemble's members")
    values = np.sort(ds[of].values[np.isfinite(ds[of].values)])
    if not values.size:
        raise SceneError("plot", "specimens", f"no member has a {of}")
    ax = new_axes(ax, height=3.8)
    share = np.arange(1, values.size + 1) / values.size
    ax.step(
        values,
        share,
        where="post",
        color=POSITIVE,
        marker=".",
        linewidth=line_width(1.2),
        label=f"one {what_of(ds)} each",
    )
    mean = float(values.mean())
    mark_value(ax.axvline, mean, "mean")
    if values.size > 1:
        error = float(values.std(ddof=1)) / np.sqrt(values.size)
        ax.axvspan(mean - error, mean + error, color="0.3", alpha=0.2, linewidth=0, label="standard error")
    ax.set_ylim(0.0, 1.02)
    ax.set_xlabel(f"{ds[of].attrs['long_name']} ({ds[of].attrs['units']})")
    ax.set_ylabel(f"share of {values.size} members below")
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
    ax.axvline(0.0, color="0.3", linewidth=line_width(0.8))
    ax.set_xlabel(f"share of the variance of {ds.attrs['index_of']}")
    tidy(ax)
    ax.margins(x=0.05)
    ax.grid(visible=False, axis="y")
    ax.legend(frameon=False, fontsize="small", loc="lower right")
    return ax
