"""The form of the archive of a run under way: its counters and checkpoints, and the dataset that it stands for.

Beside the variables of every archive it has the numbers of committed samples and events, and two slots for checkpoints.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from gearidae.archive.definition import define
from gearidae.archive.disk import sync
from gearidae.archive.end_state import packed_state
from gearidae.archive.journal import COUNTERS, newest
from gearidae.archive.library import opened
from gearidae.records import sample_times

__all__ = ["COPIED", "is_growing", "lay_out", "trimmed"]

COPIED = 2**20
"""Rows copied at a time."""
_COUNTERS = {
    "committed_samples": (),
    "committed_events": (),
    "checkpoint": ("checkpoint_slot", "checkpoint_word"),
}


def is_growing(ds: xr.Dataset) -> bool:
    """Whether a dataset has been read from the archive of a run that is not at its end."""
    return all(name in ds.variables for name in _COUNTERS)


def trimmed(ds: xr.Dataset, *, running: bool) -> xr.Dataset:
    """Cut a growing archive down to what has been committed, and say how the run stands.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from the file.
    running : bool
        Whether a process was writing it.
    """
    counts = {
        dim: min(max(int(ds[f"committed_{dim}s"].item()), 0), ds.sizes["time" if dim == "sample" else dim])
        for dim in ("sample", "event")
    }
    point = newest(slot.astype("<f8").tobytes() for slot in ds["checkpoint"].values)
    cut = ds.isel(time=slice(counts["sample"]), event=slice(counts["event"])).drop_vars(list(_COUNTERS))
    if point.sequence:
        cut.attrs["end_state"] = packed_state(point.state)
    cut.attrs |= {
        "status": "running" if running else "interrupted",
        "message": f"not at its end yet; checkpoint at {point.time:g} s",
        "wall_time": point.wall_time,
        **{name: getattr(point.statistics, name) for name in COUNTERS if name in cut.attrs},
    }
    return cut


def lay_out(path: Path, template: xr.Dataset, sizes: Mapping[str, int], duration: float) -> None:
    """Write the file's structure, and the times of the samples, which are known."""
    path.unlink(missing_ok=True)
    define(template, path, sizes, _COUNTERS)
    total, begin = sizes["time"], float(template.attrs.get("start_time", 0.0))
    with opened(path, "a") as file:
        for start in range(0, total, COPIED):
            times = sample_times(begin, duration, total, range(start, min(start + COPIED, total)))
            file["time"][start : start + times.size] = times
        file["checkpoint"][:] = 0.0
    sync(path)
