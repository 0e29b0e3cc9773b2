"""Errors of single teeth beside the forces that the teeth carried."""

from __future__ import annotations

from typing import Final

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator

from gearidae.archive.select import motion_samples, run_scene
from gearidae.arrays import Floats
from gearidae.drawing.picture import new_picture
from gearidae.drawing.style import line_colour, scale_for, tidy
from gearidae.errors import SceneError
from gearidae.plot.teeth_view import mesh_states
from gearidae.records import Flank
from gearidae.records.tooth_states import MeshState
from gearidae.scene import GearScene, require_gears
from gearidae.scene.coating_table import met_teeth
from gearidae.scene.pitch_errors import SIDES, errors_of_teeth, has_pitch_errors

_MOST_STATES: Final = 4000
"""Samples at which forces are looked at: some two hundred for each mesh of twenty."""


def tooth_errors(ds: xr.Dataset, *, figure: Figure | SubFigure | None = None) -> Figure | SubFigure:
    """Draw the error of each tooth of both gears, and below it the largest force that it carried.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair whose teeth have errors; from a sweep, one selected with ``sel``.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw, half as high as wide; by default a new one.

    Returns
    -------
    matplotlib Figure or SubFigure
        A column for each gear. Errors are positive where a tooth stands back from its drive flank. Forces are those of
        the drive flank at up to 4000 samples, the largest of each tooth; teeth that have not met have none.

    Raises
    ------
    SceneError
        If the dataset is of a roller, of several runs, or has no samples, its teeth have no errors, or the run cannot
        be repeated.

    Notes
    -----
    Forces of single pairs are not recorded: the scene runs again for them, see `gearidae.analysis.tooth_contacts`.
    """
    count = motion_samples(ds) if "transmission_error" in ds.variables else 0
    last = max(count - 1, 0)
    times = ds["time"].values[np.unique(np.linspace(0, last, min(count, _MOST_STATES)).round().astype(int))]
    states = mesh_states(ds, times if count else [0.0])
    scene = require_gears(run_scene(ds))
    if not has_pitch_errors(scene):
        raise SceneError(
            "plot", "tooth_errors", "teeth have no errors: mesh.pinion_pitch_error and others are empty"
        )
    errors, forces = errors_of_teeth(scene), largest_forces(scene, states)
    figure = figure or new_picture((7.6, 4.2), panels=True)
    axes = figure.subplots(2, 2, sharex="col", width_ratios=[1.0, 1.6])
    figure.subplots_adjust(left=0.1, right=0.98, top=0.96, bottom=0.12)
    scales = [
        scale_for(max(float(np.abs(values).max()) for values in both if values.size), unit)
        for both, unit in ((errors, "m"), ([side[np.isfinite(side)] for side in forces], "N"))
    ]
    for column, name in enumerate(SIDES):
        upper, lower = axes[0, column], axes[1, column]
        for ax, values, scale in ((upper, errors[column], scales[0]), (lower, forces[column], scales[1])):
            _bars(ax, values * scale.factor, line_colour(column))
        lower.set_xlabel(f"tooth of the {name}", fontsize="small")
        if not column:
            upper.set_ylabel(f"stands back ({scales[0].unit})", fontsize="small")
            lower.set_ylabel(f"largest force ({scales[1].unit})", fontsize="small")
    for row in axes:
        for ax in row:
            ax.set_ylim(min(ax.get_ylim()[0] for ax in row), max(ax.get_ylim()[1] for ax in row))
    return figure


def largest_forces(scene: GearScene, states: list[MeshState]) -> tuple[Floats, Floats]:
    """Largest force of each tooth of pinion and gear on its drive flank, at some samples [N].

    Returns
    -------
    pinion, gear : ndarray, shape (teeth,)
        NaN of teeth that have not been near another.
    """
    sides = tuple(np.full(errors.size, np.nan) for errors in errors_of_teeth(scene))
    for state in states:
        for contact in state.contacts:
            if contact.flank == Flank.DRIVE:
                for side, tooth in zip(sides, met_teeth(np.array(contact.pair), coast=False), strict=True):
                    index = int(tooth) % side.size
                    side[index] = np.fmax(side[index], contact.force)
    return sides[0], sides[1]


def _bars(ax: Axes, values: Floats, colour: str) -> None:
    """Draw a bar for each tooth that has a value."""
    ax.bar(np.arange(values.size), np.nan_to_num(values), color=colour, width=0.8)
    ax.axhline(0.0, color="0.3", linewidth=0.6)
    ax.set_xlim(-0.7, values.size - 0.3)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.tick_params(labelsize="x-small")
    tidy(ax)
