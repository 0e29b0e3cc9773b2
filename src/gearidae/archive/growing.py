"""Archives that grow while a run goes on: readable at any time, by anyone, whatever happens to the run.

The file is in netCDF's classic format and made once, with room for every sample and for many events and passages, and
filled with what stands for nothing; where these run out of room, a larger file takes its place. Each block of output is
written to its place, then a record of what is committed, with checksums (`gearidae.archive.commits`). So there is no
instant at which the file could not be read, no lock lies on it, and the memory needed does not depend on the run's
length. The state to go on from is kept beside it (`gearidae.archive.checkpoint`). When the run has ended, `finish`
rewrites the file as any other archive.
"""

from __future__ import annotations

import logging
import secrets
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Self

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.checkpoint import RUN, Checkpoint, drop_checkpoints
from gearidae.archive.commits import COPIED, COUNTS, LENGTH, RECORDS, Commit, check_bytes
from gearidae.archive.definition import define
from gearidae.archive.disk import disk_errors, sync
from gearidae.archive.integrity import seal, with_checksums
from gearidae.archive.library import LIBRARY, close, opened
from gearidae.archive.rows import archived, kinds_in, teeth_in
from gearidae.records import Block, Rows, Statistics, sample_times

ROOM: Final = {"event": 65_536, "passage": 4096}
"""Rows to make room for, twice as many whenever they run out: along a dimension without limit each takes longer."""
CHECKPOINT_SECONDS = 1.0
"""Least wall time between checkpoints [s]: each waits for the disk."""
log = logging.getLogger(__name__)


class GrowingArchive:
    """The archive of a run under way, open for writing; `gearidae.archive.target.claims_target` keeps others away.

    Parameters
    ----------
    path : Path
        The file, made by `create`.
    template : xarray.Dataset
        What the run's dataset will be, without samples and rows.

    Attributes
    ----------
    lengths : dict of str to int
        How much is committed along each dimension that grows.

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
        self._kinds = tuple(kinds_in(template))
        self._teeth = teeth_in(template.attrs)
        self._checkpointed = time.monotonic()
        self.lengths = self._nothing = {dim: 0 for dim in COUNTS if dim in template.dims}
        self._commits = Commit()
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
            What the run's dataset will be, without samples and rows.
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
        try:
            with disk_errors(part):
                _lay_out(part, template, secrets.token_hex(16), {"time": samples, **ROOM})
                _write_times(part, samples, float(template.attrs.get("start_time", 0.0)), duration)
                with opened(part, "a") as file:
                    Commit.first(file, part).write(file)
                drop_checkpoints(path)
                part.replace(path)
                sync(path.parent)
        finally:
            part.unlink(missing_ok=True)
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
        """Take back what came after the newest checkpoint, or after the start of the run if there is none.

        Raises
        ------
        DiskError
            If what came before the checkpoint is not in the file as it was written.
        """
        point = Checkpoint.newest(self.path, self._run)
        commit = Commit() if point is None else point.commit
        with disk_errors():
            with LIBRARY:
                if not commit.holds(self._file):
                    raise OSError("it is damaged before the checkpoint: begin anew with --overwrite")
            if point is None and any(self.lengths.values()):
                log.warning("%s has no whole checkpoint: the run begins anew", self.path)
            self.lengths = {**self._nothing, **commit.lengths}
            self._commits = replace(self._commits, checksums=commit.checksums)
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
                point = Checkpoint(
                    self.lengths,
                    block.time,
                    wall_time,
                    statistics,
                    block.checkpoint,
                    block.extremes,
                    self._commits.checksums,
                    block.balance,
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

    def finish(self, template: xr.Dataset, *, compress: bool = True) -> None:
        """Rewrite the file as any other archive, without room to spare, and close it.

        Parameters
        ----------
        template : xarray.Dataset
            The run's dataset with its final attributes, without samples and rows.
        compress : bool, optional
            As for `gearidae.save`.

        Raises
        ------
        DiskError
            If the disk does not take it; the growing archive then stays as it is.
        """
        part = _part(self.path)
        part.unlink(missing_ok=True)
        try:
            with disk_errors(part):
                self._compact(template, part, compress=compress)
                self.close()  # Windows replaces no file that is open
                part.replace(self.path)
                sync(self.path.parent)
                drop_checkpoints(self.path)
        finally:
            part.unlink(missing_ok=True)

    def _open(self) -> None:
        with LIBRARY:
            self._file = netCDF4.Dataset(self.path, "r+", keepweakref=True)
            self._file.set_auto_maskandscale(False)
            self._run = str(getattr(self._file, RUN, ""))
            counts = (COUNTS[dim] for dim in self._nothing)
            if missing := {*self._columns, *counts, RECORDS, *self._row_names()} - set(self._file.variables):
                raise OSError(f"{self.path.name} has no variable {min(missing)}")
        try:
            self._commits = check_bytes(self.path)[0]
        except ValueError as error:
            raise OSError(str(error)) from error

    def _append(self, block: Block) -> None:
        tables = {kind: getattr(block, kind.field) for kind in self._kinds}
        after = {"time": self.lengths["time"] + len(block.rows)}
        after |= {kind.dim: self.lengths[kind.dim] + len(table) for kind, table in tables.items()}
        if any(after[kind.dim] > len(self._file.dimensions[kind.dim]) for kind in tables):
            self._make_room(after)
        for column, name in enumerate(self._columns):
            self._write(name, self.lengths["time"], block.rows[:, column])
        for kind, table in tables.items():
            values = archived(kind.of_table(table), self._teeth, self._fraction)
            for name in self._row_names(kind):
                self._write(name, self.lengths[kind.dim], values[name])
        self.lengths = after
        self._commit()

    def _row_names(self, *kinds: type[Rows]) -> list[str]:
        """Variables of some kinds of rows, or of all."""
        dims = [(kind.dim,) for kind in kinds or self._kinds]
        return [str(name) for name, variable in self._template.data_vars.items() if variable.dims in dims]

    def _write(self, name: str, first: int, values: NDArray[Any]) -> None:
        if values.size:
            with LIBRARY:
                variable = self._file[name]
                values = values.astype(variable.dtype, copy=False)
                variable[first : first + values.size] = values
            sums = {**self._commits.checksums, name: self._commits.checksum(name, values)}
            self._commits = replace(self._commits, checksums=sums)

    def _commit(self) -> None:
        """Say what is there; done after it is."""
        self._commits = replace(self._commits, number=self._commits.number + 1, lengths=self.lengths)
        with LIBRARY:
            self._file.sync()
            self._commits.write(self._file)
            for dim, count in self.lengths.items():
                self._file[COUNTS[dim]][...] = count
            self._file.sync()

    def _make_room(self, wanted: Mapping[str, int]) -> None:
        """Move to a file with room for more rows, which takes the old one's place when it is complete."""
        room = {dim: len(self._file.dimensions[dim]) for dim in self.lengths}
        times = room["time"]
        for kind in self._kinds:
            while room[kind.dim] < wanted[kind.dim]:
                room[kind.dim] *= 2
        part, counts = _part(self.path), [COUNTS[dim] for dim in self.lengths]
        try:
            _lay_out(part, self._template, self._run, room)
            with opened(part, "a") as file:
                for name, variable in file.variables.items():
                    if {*variable.dimensions} & {*self.lengths}:
                        self._copy(
                            name, variable, times if name == "time" else self.lengths[variable.dimensions[0]]
                        )
                    elif name in counts:
                        variable[...] = self._file[name][...]
                file.sync()
                replace(self._commits, structure=Commit.first(file, part).structure).write(file)
            sync(part)
            self.close()  # Windows replaces no file that is open
            try:
                part.replace(self.path)
            finally:
                self._open()
        finally:
            part.unlink(missing_ok=True)
        sync(self.path.parent)

    def _compact(self, template: xr.Dataset, part: Path, *, compress: bool) -> None:
        define(with_checksums(template), part, self.lengths, compress=compress)
        with opened(part, "a") as file:
            file.set_auto_maskandscale(False)
            for name, variable in file.variables.items():
                if set(variable.dimensions) & {*self.lengths} and variable.size:
                    self._copy(name, variable, len(variable))
        seal(part)
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


def _lay_out(path: Path, template: xr.Dataset, run: str, room: Mapping[str, int]) -> None:
    """Write the file's structure with room along dimensions, filled with what stands for nothing."""
    path.unlink(missing_ok=True)
    sizes = {dim: max(size, 1) for dim, size in room.items() if dim in template.dims}
    grown = template.assign({COUNTS[dim]: ((), np.int64(0), {"units": "1"}) for dim in sizes})
    grown[RECORDS] = ("record_byte", np.full(2 * LENGTH, ord(" "), np.uint8))
    # a length of 0 is one without limit to netCDF
    define(grown.assign_attrs({RUN: run}), path, sizes, in_place=True)


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
