"""Archives that grow while a run goes on: readable at any time, by anyone, whatever happens to the run.

The file is in netCDF's classic format and made once, with room for every sample and for many events, and filled with
what stands for nothing; where events run out of room, a larger file takes its place. Each block of output is written to
its place, then the numbers of committed samples and events. So there is no instant at which the file could not be read,
no lock lies on it, and the memory needed does not depend on the run's length. The state to go on from is kept beside it
(`gearidae.archive.checkpoint`). When the run has ended, `finish` rewrites the file as any other archive.
"""

from __future__ import annotations

import json
import secrets
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, Self

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.asperity_events import teeth_in, tooth_of
from gearidae.archive.checkpoint import COUNTERS, Checkpoint, drop_checkpoints
from gearidae.archive.definition import define
from gearidae.archive.disk import disk_errors, sync
from gearidae.archive.end_state import packed_state
from gearidae.archive.extremes import extreme_variables
from gearidae.archive.library import LIBRARY, close, opened
from gearidae.archive.variables import EVENTS
from gearidae.records import Block, EventColumn, Statistics, sample_times
from gearidae.scene import Scene

COPIED = 2**20
"""Rows copied at a time."""
EVENT_ROOM = 65_536
"""Events to make room for, twice as many whenever they run out: along a dimension without limit each takes longer."""
CHECKPOINT_SECONDS = 1.0
"""Least wall time between checkpoints [s]: each waits for the disk."""
_EVENT_COLUMNS = ("event_time", "event_kind", "event_pair", "event_flank", "event_gap_rate")
_COUNTS: Final = ("committed_samples", "committed_events")
_RUN: Final = "run"
"""Attribute by which a run's checkpoint is found."""


class GrowingArchive:
    """The archive of a run under way, open for writing; `gearidae.archive.target.claims_target` keeps others away.

    Parameters
    ----------
    path : Path
        The file, made by `create`.
    template : xarray.Dataset
        What the run's dataset will be, without samples and events.

    Attributes
    ----------
    samples, events : int
        How many are committed.

    Raises
    ------
    DiskError
        If it cannot be opened or is damaged.
    """

    def __init__(self, path: Path, template: xr.Dataset) -> None:
        self.path = path
        self._template = template
        self._file: Any = None
        self._columns = [
            str(name) for name, variable in template.data_vars.items() if variable.dims == ("time",)
        ]
        self._fraction = float(template["sam_fraction"])
        self._has_asperities = "event_asperity" in template
        self._teeth = teeth_in(template.attrs)
        self._checkpointed = time.monotonic()
        self.samples = self.events = 0
        with disk_errors():
            self._open()

    @classmethod
    def create(cls, path: Path, template: xr.Dataset, samples: int, duration: float) -> Self:
        """Make an archive for a run that has not begun, in the place of whatever is there.

        Parameters
        ----------
        path : Path
            The file to make.
        template : xarray.Dataset
            What the run's dataset will be, without samples and events.
        samples : int
            Number of samples.
        duration : float
            Time of the last sample [s].

        Raises
        ------
        DiskError
            If the disk does not take it; nothing is left behind then.
        """
        part = _part(path)
        with disk_errors():
            try:
                _lay_out(part, template, secrets.token_hex(16), samples, EVENT_ROOM)
                _write_times(part, samples, float(template.attrs.get("start_time", 0.0)), duration)
                drop_checkpoints(path)
                part.replace(path)
            finally:
                part.unlink(missing_ok=True)
            sync(path.parent)
        return cls(path, template)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        file, self._file = self._file, None
        if file is not None:
            with LIBRARY, suppress(OSError, RuntimeError):  # of a full disk, once more
                close(file, written=True)

    def go_back(self) -> Checkpoint | None:
        """Take back what came after the newest checkpoint, or after the start of the run if there is none."""
        point = Checkpoint.newest(self.path, self._run)
        self.samples, self.events = (0, 0) if point is None else (point.samples, point.events)
        with disk_errors():
            self._commit()
        return point

    def take(self, block: Block, statistics: Statistics, wall_time: float, *, last: bool = False) -> None:
        """Append a block of output, then commit it.

        Parameters
        ----------
        block : Block
            From the engine.
        statistics : Statistics
            The solver's counters at the end of the block.
        wall_time : float
            Wall time in the solver until then [s].
        last : bool, optional
            Whether this is the end of the run: its checkpoint is then kept in any case.

        Raises
        ------
        DiskError
            If the disk does not take it; what was committed before stays as it is.
        """
        with disk_errors():
            self._append(block)
            due = last or time.monotonic() - self._checkpointed >= CHECKPOINT_SECONDS
            if block.checkpoint is not None and due:
                sync(self.path)
                counts = (self.samples, self.events)
                point = Checkpoint(
                    *counts, block.time, wall_time, statistics, block.checkpoint, block.extremes
                )
                point.keep(self.path, self._run)
                self._checkpointed = time.monotonic()

    def read(self, name: str, cut: slice) -> NDArray[Any]:
        """Return the values of a variable from ``cut.start`` to ``cut.stop``.

        Raises
        ------
        DiskError
            If the file does not give them.
        """
        with disk_errors(), LIBRARY:
            values: NDArray[Any] = self._file[name][cut]
            return values

    def finish(self, template: xr.Dataset) -> None:
        """Rewrite the file as any other archive, without room to spare, and close it.

        Parameters
        ----------
        template : xarray.Dataset
            The run's dataset with its final attributes, without samples and events.

        Raises
        ------
        DiskError
            If the disk does not take it; the growing archive then stays as it is.
        """
        part = _part(self.path)
        with disk_errors():
            part.unlink(missing_ok=True)
            try:
                self._compact(template, part)
                self.close()  # Windows replaces no file that is open
                part.replace(self.path)
            finally:
                part.unlink(missing_ok=True)
            sync(self.path.parent)
            drop_checkpoints(self.path)

    def _open(self) -> None:
        with LIBRARY:
            self._file = netCDF4.Dataset(self.path, "r+", keepweakref=True)
            self._file.set_auto_maskandscale(False)
            self._run = str(getattr(self._file, _RUN, ""))
            if missing := {*self._columns, *_EVENT_COLUMNS, *_COUNTS} - set(self._file.variables):
                raise OSError(f"{self.path.name} has no variable {min(missing)}")

    def _append(self, block: Block) -> None:
        if self.events + len(block.events) > len(self._file.dimensions["event"]):
            self._make_room(self.events + len(block.events))
        for column, name in enumerate(self._columns):
            self._write(name, self.samples, block.rows[:, column])
        for column, name in enumerate(_EVENT_COLUMNS):
            self._write(name, self.events, block.events[:, column].astype(EVENTS[name].dtype))
        if self._has_asperities:
            self._write("event_asperity", self.events, block.events[:, EventColumn.ASPERITY].astype(np.int64))
            teeth = tooth_of(
                self._teeth, block.events[:, EventColumn.PAIR], block.events[:, EventColumn.FLANK]
            )
            self._write("event_tooth", self.events, teeth)
        self._write("event_sam_fraction", self.events, np.full(len(block.events), self._fraction))
        self.samples += len(block.rows)
        self.events += len(block.events)
        self._commit()

    def _write(self, name: str, first: int, values: NDArray[Any]) -> None:
        if values.size:
            with LIBRARY:
                self._file[name][first : first + values.size] = values

    def _commit(self) -> None:
        """Say what is there; done after it is."""
        with LIBRARY:
            self._file.sync()
            for name, count in zip(_COUNTS, (self.samples, self.events), strict=True):
                self._file[name][...] = count
            self._file.sync()

    def _make_room(self, events: int) -> None:
        """Move to a file with room for more events, which takes the old one's place when it is complete."""
        times, room = (len(self._file.dimensions[name]) for name in ("time", "event"))
        while room < events:
            room *= 2
        part, committed = _part(self.path), {"time": self.samples, "event": self.events}
        try:
            _lay_out(part, self._template, self._run, times, room)
            with opened(part, "a") as file:
                for name, variable in file.variables.items():
                    if variable.dimensions:
                        self._copy(
                            name, variable, times if name == "time" else committed[variable.dimensions[0]]
                        )
                    elif name in _COUNTS:
                        variable[...] = self._file[name][...]
            sync(part)
            self.close()  # Windows replaces no file that is open
            try:
                part.replace(self.path)
            finally:
                self._open()
        finally:
            part.unlink(missing_ok=True)
        sync(self.path.parent)

    def _compact(self, template: xr.Dataset, part: Path) -> None:
        define(template, part, {"time": self.samples, "event": self.events})
        with opened(part, "a") as file:
            file.set_auto_maskandscale(False)
            for name, variable in file.variables.items():
                if set(variable.dimensions) & {"time", "event"} and variable.size:
                    self._copy(name, variable, len(variable))
        sync(part)

    def _copy(self, name: str, variable: Any, length: int) -> None:
        """Copy what is committed into a variable of another file, whole chunks at a time."""
        chunks, step = variable.chunking(), COPIED
        if isinstance(chunks, list):
            step = max(COPIED // chunks[0], 1) * chunks[0]
            variable.set_var_chunk_cache(size=0)  # whole chunks come once each: nothing to remember
        for start in range(0, length, step):
            count = min(step, length - start)
            variable[start : start + count] = self.read(name, slice(start, start + count))


def is_growing(ds: xr.Dataset) -> bool:
    """Whether a dataset has been read from the archive of a run that is not at its end."""
    return all(name in ds.variables for name in _COUNTS)


def trimmed(ds: xr.Dataset, path: Path, *, running: bool) -> xr.Dataset:
    """Cut a growing archive down to what has been committed, and say how the run stands.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from the file.
    path : Path
        The file.
    running : bool
        Whether a process was writing it.
    """
    samples, events = (max(int(ds[name].item()), 0) for name in _COUNTS)
    cut = ds.isel(time=slice(samples), event=slice(events)).drop_vars(_COUNTS)
    point = Checkpoint.newest(path, str(cut.attrs.pop(_RUN, "")))
    cut.attrs |= {"status": "running" if running else "interrupted", "message": "not at its end yet"}
    if point is not None:
        cut.attrs |= {
            "message": f"not at its end yet; checkpoint at {point.time:g} s",
            "end_state": packed_state(point.state),
            "wall_time": point.wall_time,
            **{name: getattr(point.statistics, name) for name in COUNTERS if name in cut.attrs},
        }
        scene = Scene.from_dict(json.loads(cut.attrs["scene"]))
        cut = cut.assign(extreme_variables(scene, [point.extremes]))
    return cut


def _lay_out(path: Path, template: xr.Dataset, run: str, samples: int, room: int) -> None:
    """Write the file's structure, filled with what stands for nothing."""
    path.unlink(missing_ok=True)
    grown = template.assign({name: ((), np.int64(0), {"units": "1"}) for name in _COUNTS})
    # a length of 0 is one without limit to netCDF
    define(grown.assign_attrs({_RUN: run}), path, {"time": max(samples, 1), "event": room}, in_place=True)


def _write_times(path: Path, total: int, begin: float, duration: float) -> None:
    """Write the times of the samples, which are known."""
    with opened(path, "a") as file:
        for start in range(0, total, COPIED):
            times = sample_times(begin, duration, total, range(start, min(start + COPIED, total)))
            file["time"][start : start + times.size] = times
    sync(path)


def _part(path: Path) -> Path:
    """Name of the file in the making; there is one at most, since its maker holds the lock."""
    return path.with_name(f".{path.name}.part")
