"""The force of a population of asperities over one mesh cycle, with every joining and detachment."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae.archive.select import is_train, run_scene, swept_dims
from gearidae.archive.select import runs as single_runs
from gearidae.archive.train import judged_view
from gearidae.arrays import Floats
from gearidae.drawing.style import (
    NEGATIVE,
    POSITIVE,
    largest,
    line_width,
    new_axes,
    runs_of,
    scale_for,
    tidy,
    zero_line,
)
from gearidae.errors import SceneError
from gearidae.records import EventKind, Flank

_FORCES = ("mesh_force", "force")


def asperity_events(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the force of the contacts over the last whole mesh cycle, and each asperity that joins or detaches in it.

    A cycle lasts from a pair's entry on the drive flank to the next; of a train the judged mesh is drawn. Of a roller,
    or of a run without a whole cycle, all of it is drawn. Marks stand at the recorded force, interpolated between
    samples.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run with ``contact.roughness = "discrete"``, with samples and the events of single asperities.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is of several runs or of another contact model, or has no samples or no such events.
    """
    if dims := swept_dims(ds):
        raise SceneError(
            "dataset", f"runs along {dims[0]}", "must be a single run: select one, as --select does"
        )
    of_mesh = f" of mesh {ds.attrs['judged_mesh']}" if is_train(ds) else ""
    ds = judged_view(ds)
    run = next(run for _, run in single_runs(ds))
    scene = run_scene(run)
    if not scene.contact.is_discrete:
        raise SceneError("contact.roughness", scene.contact.roughness, "must be discrete for this picture")
    if not scene.run.asperity_events:
        raise SceneError("run.asperity_events", "false", "must be true for this picture")
    name = next((name for name in _FORCES if name in ds), _FORCES[0])
    (drawn,) = runs_of(ds, name)
    start, end = _cycle(run)
    time, force = run["time"].values, drawn.data[name].values
    here = (time >= start) & (time <= end)
    ax = new_axes(ax, height=3.6)
    across, up = scale_for(end, "s"), scale_for(largest([drawn], name), "N")
    ax.plot(time[here] * across.factor, force[here] * up.factor, color="0.45", linewidth=line_width(0.9))
    zero_line(ax)
    for kind, mark, colour, words in (
        (EventKind.ASPERITY_ONSET, "^", POSITIVE, "joins"),
        (EventKind.ASPERITY_DETACHMENT, "v", NEGATIVE, "detaches"),
    ):
        at = _times(run, kind, start, end)
        height = np.interp(at, time, force)
        ax.plot(
            at * across.factor,
            height * up.factor,
            mark,
            color=colour,
            label=f"asperity {words} ({at.size})",
            markersize=5.5,
            markeredgecolor="white",
            markeredgewidth=0.5,
        )
    tidy(ax)
    ax.set_xlabel(f"time ({across.unit})")
    ax.set_ylabel(f"force of the contacts{of_mesh} ({up.unit})")
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize="small")
    return ax


def _cycle(run: xr.Dataset) -> tuple[float, float]:
    """Begin and end of the last mesh cycle [s], or of the run."""
    entries = run["event_time"].values[
        (run["event_kind"].values == EventKind.MESH_ENTRY) & (run["event_flank"].values == Flank.DRIVE)
    ]
    if entries.size > 1:
        return float(entries[-2]), float(entries[-1])
    return float(run["time"][0]), float(run["time"][-1])


def _times(run: xr.Dataset, kind: EventKind, start: float, end: float) -> Floats:
    """Times of the events of single asperities of a kind [s]."""
    time = run["event_time"].values
    return np.asarray(time[(run["event_kind"].values == kind) & (time >= start) & (time <= end)])
