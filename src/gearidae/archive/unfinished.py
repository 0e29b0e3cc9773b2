"""Reading the archive of a run that is not at its end: what is committed and intact, and how the run stands."""

from __future__ import annotations

import json
import logging
from pathlib import Path
from typing import Any, Final

import xarray as xr

from gearidae.archive.checkpoint import RUN, Checkpoint
from gearidae.archive.commits import COUNTS, RECORDS, Commit, constants_of
from gearidae.archive.end_state import end_state_attributes
from gearidae.archive.totals import total_variables
from gearidae.records import COUNTERS
from gearidae.scene import Scene

log = logging.getLogger(__name__)

RESUMABLE: Final = "; go on with --resume (resume=True)"
"""End of the message of a run that nobody goes on with."""


def intact(file: Any, commits: list[Commit], path: Path) -> Commit:
    """Return the newest state whose values are in an open file as they were written; an older one is warned of.

    Parameters
    ----------
    commits : list of Commit
        From `check_bytes`, not empty.
    path : Path
        The file.

    Raises
    ------
    ValueError
        If there is none.
    """
    newest = commits[0]
    if constants_of(file) != newest.constants:
        raise ValueError("its values have been altered")
    if newest.holds(file):
        return newest
    point = Checkpoint.newest(path, str(getattr(file, RUN, "")))
    for commit in (*commits[1:], *([] if point is None else [point.commit])):
        if commit.lengths.get("time") and commit.holds(file):
            log.warning(
                "%s is damaged after %d of its %d samples: the rest is left out",
                path,
                commit.lengths["time"],
                newest.lengths["time"],
            )
            return commit
    raise ValueError("its values have been altered")


def is_growing(ds: xr.Dataset) -> bool:
    """Whether a dataset has been read from the archive of a run that is not at its end."""
    return COUNTS["time"] in ds.variables


def trimmed(ds: xr.Dataset, path: Path, commit: Commit | None, *, running: bool) -> xr.Dataset:
    """Cut a growing archive down to what has been committed, and say how the run stands.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from the file.
    path : Path
        The file.
    commit : Commit, optional
        The state to show; None of an archive of version 0.2.0.
    running : bool
        Whether a process was writing it.
    """
    grown = {dim: name for dim, name in COUNTS.items() if name in ds}
    lengths = {dim: max(int(ds[name].values.item()), 0) for dim, name in grown.items()}
    if commit is not None:
        lengths = {**lengths, **commit.lengths}
    cut = ds.isel({dim: slice(length) for dim, length in lengths.items()})
    cut = cut.drop_vars([*grown.values(), RECORDS], errors="ignore")
    point = Checkpoint.newest(path, str(cut.attrs.pop(RUN, "")))
    remedy = "" if running else RESUMABLE
    cut.attrs |= {
        "status": "running" if running else "interrupted",
        "message": f"not at its end yet{remedy}",
    }
    if point is not None:
        cut.attrs |= {
            "message": f"not at its end yet; checkpoint at {point.time:g} s{remedy}",
            **end_state_attributes(0.0, point.state),
            "wall_time": point.wall_time,
            **{
                counter.name: getattr(point.statistics, counter.name)
                for counter in COUNTERS
                if counter.name in cut.attrs
            },
        }
        scene = Scene.from_dict(json.loads(cut.attrs["scene"]))
        cut["reached"] = ((), point.time, cut["reached"].attrs)
        cut = cut.assign(total_variables(scene, [scene], [point]))
    return cut
