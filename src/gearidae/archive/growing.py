"""Archives that grow while a run goes on: readable at any time, by anyone, whatever happens to the run.

The netCDF4 file is created once, with every variable at its full length (the number of samples is known; for events
there is room to spare), contiguous, and filled with what stands for nothing. From then on its HDF5 structure never
changes: blocks of output are written straight to the variables' places in the file, then the counters of what is
there. So there is no instant at which the file could not be read, HDF5 holds no lock on it, and the memory needed
does not depend on the run's length. When the run has ended, `finish` rewrites it as any other archive.

Two slots take checkpoints in turn, each with a checksum; the run goes on from the newest one that is sound.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Self

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.asperity_events import teeth_in, tooth_of
from gearidae.archive.definition import define, offsets
from gearidae.archive.disk import commit, disk_errors, open_file, read_at, sync, write_at
from gearidae.archive.growing_layout import COPIED, lay_out
from gearidae.archive.integrity import with_checksums
from gearidae.archive.journal import HEADER, Checkpoint, newest
from gearidae.archive.library import opened
from gearidae.archive.variables import EVENTS, POPULATION_EVENTS
from gearidae.records import Block, Statistics

__all__ = ["GrowingArchive"]

Floats = NDArray[np.float64]

EVENT_ROOM = 65_536
"""Least number of events to make room for; as many as samples are, and twice as many whenever they run out."""
CHECKPOINT_SECONDS = 1.0
"""Least wall time between checkpoints [s]: each waits for the disk."""
_EVENT_COLUMNS = ("event_time", "event_kind", "event_pair", "event_flank", "event_gap_rate")


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
        self._columns = [
            str(name) for name, variable in template.data_vars.items() if variable.dims == ("time",)
        ]
        self._fraction = float(template["sam_fraction"])
        self._checkpointed = time.monotonic()
        self._sequence = 0
        self.samples = self.events = 0
        with disk_errors():
            self._descriptor = self._open(path)

    @classmethod
    def create(cls, path: Path, template: xr.Dataset, samples: int, duration: float, words: int) -> Self:
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
        words : int
            Numbers in the state of a checkpoint at most.

        Raises
        ------
        DiskError
            If the disk does not take it; nothing is left behind then.
        """
        sizes = {
            "time": samples,
            "event": max(samples, EVENT_ROOM),
            "checkpoint_slot": 2,
            "checkpoint_word": HEADER + words,
        }
        part = _part(path)
        with disk_errors():
            try:
                lay_out(part, template, sizes, duration)
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
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def go_back(self) -> Checkpoint:
        """Return to the newest checkpoint: what has been committed since is taken back."""
        with disk_errors():
            point = newest(self._slot(k) for k in (0, 1))
            self._sequence = point.sequence
            self.samples, self.events = point.samples, point.events
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
                self._sequence += 1
                counts = (self._sequence, self.samples, self.events)
                self._keep(Checkpoint(*counts, block.time, wall_time, statistics, block.checkpoint))

    def _append(self, block: Block) -> None:
        if self.events + len(block.events) > self._sizes["event"]:
            self._make_room("event", self.events + len(block.events))
        for column, name in enumerate(self._columns):
            self._write(name, self.samples, block.rows[:, column])
        for column, name in enumerate(_EVENT_COLUMNS):
            self._write(name, self.events, block.events[:, column].astype(EVENTS[name].dtype))
        if "event_asperity" in self._template:
            self._write("event_asperity", self.events, block.events[:, 5].astype(np.int64))
            teeth = tooth_of(teeth_in(self._template.attrs), block.events[:, 2], block.events[:, 3])
            self._write("event_tooth", self.events, teeth)
        self._write("event_sam_fraction", self.events, np.full(len(block.events), self._fraction))
        self.samples += len(block.rows)
        self.events += len(block.events)
        self._commit()

    def read(self, name: str, cut: slice) -> NDArray[Any]:
        """Return the values of a variable from ``cut.start`` to ``cut.stop``.

        Raises
        ------
        DiskError
            If the file does not give them.
        """
        dtype = self._types[name]
        with disk_errors():
            place = self._places[name] + dtype.itemsize * cut.start
            return np.frombuffer(
                read_at(self._descriptor, dtype.itemsize * (cut.stop - cut.start), place), dtype
            )

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

    def _compact(self, template: xr.Dataset, part: Path) -> None:
        define(with_checksums(template), part, {"time": self.samples, "event": self.events})
        with opened(part, "a") as file:
            file.set_auto_maskandscale(False)
            for name, variable in file.variables.items():
                if set(variable.dimensions) & {"time", "event"} and variable.size:
                    self._copy(name, variable)
        sync(part)

    def _open(self, path: Path) -> int:
        """Open the file, and look where its variables are."""
        descriptor = open_file(path)
        try:
            self._places = offsets(path)
            with opened(path) as file:
                self._sizes = {name: len(dimension) for name, dimension in file.dimensions.items()}
                self._types = {name: variable.dtype for name, variable in file.variables.items()}
        except BaseException:
            os.close(descriptor)
            raise
        self._slot_size = 8 * self._sizes["checkpoint_word"]
        return descriptor

    def _write(self, name: str, first: int, values: NDArray[Any]) -> None:
        if values.size:
            write_at(self._descriptor, values, self._places[name] + first * values.dtype.itemsize)

    def _commit(self) -> None:
        """Say what is there; done after it is."""
        for name, count in (("committed_samples", self.samples), ("committed_events", self.events)):
            write_at(self._descriptor, np.int64(count).tobytes(), self._places[name])

    def _keep(self, point: Checkpoint) -> None:
        """Write a checkpoint, once what it rests on is on the disk, over the older of the two."""
        record = point.pack()
        if len(record) > self._slot_size:  # another contact model has taken over, with more to remember
            self._make_room("checkpoint_word", len(record) // 8)
        commit(self._descriptor)
        write_at(self._descriptor, record, self._places["checkpoint"] + point.sequence % 2 * self._slot_size)
        self._checkpointed = time.monotonic()

    def _make_room(self, dimension: str, least: int) -> None:
        """Move to a file with room for at least twice as much; it takes the old one's place when complete."""
        room = self._sizes[dimension]
        while room < least:
            room *= 2
        part = _part(self.path)
        try:
            begin = float(self._template.attrs.get("start_time", 0.0))
            last = self._times(max(self._sizes["time"] - 1, 0), 1)
            duration = float(last.max(initial=begin)) - begin
            lay_out(part, self._template, self._sizes | {dimension: room}, duration)
            self._copy_all(part)
            self.close()  # Windows replaces no file that is open
            try:
                part.replace(self.path)
            finally:
                self._descriptor = self._open(self.path)
        finally:
            part.unlink(missing_ok=True)
        sync(self.path.parent)

    def _copy_all(self, part: Path) -> None:
        """Copy everything that is committed into another file of this kind."""
        places, slots = offsets(part), [self._slot(k) for k in (0, 1)]
        with opened(part) as file:
            slot_size = 8 * len(file.dimensions["checkpoint_word"])
        descriptor = open_file(part)
        try:
            for name, place in places.items():
                for start, data in self._raw(name):
                    write_at(descriptor, data, place + start)
            for k, slot in enumerate(slots):
                write_at(descriptor, slot, places["checkpoint"] + k * slot_size)
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

    def _slot(self, number: int) -> bytes:
        place = self._places["checkpoint"] + number * self._slot_size
        return read_at(self._descriptor, self._slot_size, place)

    def _times(self, first: int, count: int) -> Floats:
        if not self._sizes["time"]:
            return np.empty(0)
        return np.frombuffer(read_at(self._descriptor, 8 * count, self._places["time"] + 8 * first))

    def _length(self, name: str) -> int:
        """Bytes of a variable that mean something."""
        size = int(self._types[name].itemsize)
        if name == "checkpoint":
            return 0  # its slots may get another size
        if name == "time":
            return size * self._sizes["time"]
        if name in self._columns:
            return size * self.samples
        return size * self.events if name in EVENTS or name in POPULATION_EVENTS else size

    def _raw(self, name: str) -> Iterator[tuple[int, bytes]]:
        """Go through a variable's bytes piece by piece."""
        length = self._length(name)
        for start in range(0, length, 8 * COPIED):
            size = min(8 * COPIED, length - start)
            yield start, read_at(self._descriptor, size, self._places[name] + start)

    def _copy(self, name: str, variable: Any) -> None:
        """Copy what is committed into a variable of another file, whole chunks at a time."""
        chunks, step = variable.chunking(), COPIED
        if isinstance(chunks, list):
            step = max(COPIED // chunks[0], 1) * chunks[0]
            variable.set_var_chunk_cache(size=0)  # whole chunks come once each: nothing to remember
        for start in range(0, len(variable), step):
            count = min(step, len(variable) - start)
            variable[start : start + count] = self.read(name, slice(start, start + count))


def _part(path: Path) -> Path:
    """Name of the file in the making; there is one at most, since its maker holds the lock."""
    return path.with_name(f".{path.name}.part")
