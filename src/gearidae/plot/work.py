"""Where the work of a train's drive goes, stage by stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.archive.train import work_shares
from gearidae.drawing.style import line_colour, new_axes, tidy
from gearidae.errors import SceneError
from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def work(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw where the work of the drive goes in a run of a train: a bar for each mesh, each hub, the load and the rest.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of a train of several meshes.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With shares of the drive's work in per cent, from the drive at the top to the load and what is left in motion.

    Raises
    ------
    SceneError
        If it is something else.
    """
    shares = work_shares(ds)
    if not shares:
        raise SceneError(
            "plot", "work", "has no works: the run has not followed its balance (run.balance = false)"
        )
    ax = new_axes(ax, height=1.2 + 0.3 * len(shares))
    colours = {"mesh": 1, "hub": 2, "drags": 3}
    for row, (name, energy, share) in enumerate(shares):
        colour = line_colour(colours.get(name.split()[0], 0))
        ax.barh(row, 100.0 * share, color=colour, height=0.6)
        ax.annotate(
            f" {100.0 * share:.3g} %, {with_prefix(energy, 'J', 3)}",
            (100.0 * max(share, 0.0), row),
            va="center",
            fontsize="small",
        )
    ax.set_yticks(range(len(shares)), [name for name, _, _ in shares])
    ax.invert_yaxis()
    ax.margins(x=0.25)
    ax.set_xlabel(f"share of the drive's work, {with_prefix(float(ds['drive_work']), 'J', 3)} (%)")
    tidy(ax)
    return ax
