"""Archives on disk: one netCDF4 file that holds a dataset exactly, written whole or not at all.

Numbers along a dimension carry HDF5's Fletcher-32, piece by piece; the whole file, and what it says in words, have
checksums too (`gearidae.archive.integrity`). What cannot be read of a damaged file, or has been edited so that it does
not fit the rest, is named in one line. Archives of older versions are brought to what this one writes.
"""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.backends.netCDF4_ import NetCDF4ArrayWrapper
from xarray.core.indexing import ExplicitIndexer, LazilyIndexedArray

from gearidae.archive.agreement import disagreement
from gearidae.archive.attributes import readable_scene, wrong_attribute
from gearidae.archive.definition import CHUNK, LONGEST_WHOLE, write
from gearidae.archive.disk import disk_errors
from gearidae.archive.integrity import check_content, check_seal, seal, with_checksums
from gearidae.archive.journal import SIGNATURE, TRAIN, file_of, kind_of
from gearidae.archive.lock import is_locked
from gearidae.archive.netcdf_access import await_lock, check_size, uninterrupted
from gearidae.archive.output_selection import kept_in
from gearidae.archive.pieces import reached
from gearidae.archive.provenance import SCHEMA_VERSION
from gearidae.archive.row_variables import kinds_in, needed
from gearidae.archive.select import is_train
from gearidae.archive.target import as_path, whole_file
from gearidae.archive.time_index import LARGEST_IN_MEMORY, in_memory, with_times
from gearidae.archive.train.variables import (
    COORDINATES,
    MESH_TOTALS,
    OF_AGEING,
    OF_ASPERITIES,
    SHAFT_TOTALS,
    TRAIN_SAMPLES,
)
from gearidae.archive.unfinished import RunJournal
from gearidae.archive.variables import ENERGY_BALANCE, OF_SWEPT_RUN
from gearidae.errors import SceneError
from gearidae.records import GEAR_SAMPLES, ROLLER_SAMPLES, sampled_columns
from gearidae.records.energy import TERMS
from gearidae.scene import Scene

_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""How archives begin."""
_HEADER = 2**12
"""Bytes in which an unfinished archive of version 0.3.0, in netCDF's classic format, names its dimensions."""
_JUDGED = ("verdict", "impacts")
"""What archives of runs that kept parts only have had from the first."""


class OtherFileError(SceneError):
    """A file of gearidae that is no archive of runs."""


@uninterrupted()
def save(
    ds: xr.Dataset, path: str | os.PathLike[str], *, overwrite: bool = False, compress: bool = True
) -> Path:
    """Write a dataset to a netCDF4 file.

    The file appears under its name only when it is complete and on the disk: whatever happens meanwhile,
    either the old state or the new one is there.

    Parameters
    ----------
    ds : xarray.Dataset
        What `simulate` or `sweep` returned.
    path : path-like
        Where to write.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    compress : bool, optional
        Whether samples, events and other large variables are compressed, without loss: files of half the size, written
        at some 90 MB/s.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the target is refused (see `check_target`), the disk does not take the data, or they are the table that
        ``ds.gearidae.train()`` makes of a pair.
    """
    is_train(ds)  # refuses that table, which no reader takes for an archive
    with whole_file(path, overwrite=overwrite) as part, disk_errors():
        write(with_checksums(ds), part, compress=compress)
        seal(part)
    return Path(os.path.realpath(path))


@uninterrupted()
def open_archive(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read an archive that `simulate`, `sweep` or the command line wrote.

    Parameters
    ----------
    path : path-like
        The netCDF4 file.

    Returns
    -------
    xarray.Dataset
        Identical to the saved dataset. For an unfinished run the data so far, with the status
        ``running`` or ``interrupted``. Archives of more than 128 MB are read piece by piece as they are used, each
        time they are used (the file stays open until ``ds.close()``; ``ds.load()`` reads all), smaller ones at
        once.

    Raises
    ------
    SceneError
        If the file is missing, unreadable, damaged, not an archive of gearidae, or of a layout this version
        does not know. Nothing in the file is ever executed.
    """
    source = as_path(path)
    if source.exists() and not (source.is_file() or source.is_dir()):
        raise SceneError("archive", path, "is no file that can be read")
    running = is_locked(
        source
    )  # asked first: a run that ends meanwhile puts its archive in the journal's place
    if (journal := file_of(source)) != source:
        return _unfinished(journal, path, running=running)
    try:
        with source.open("rb") as file:
            head, looked_at = file.read(_HEADER), os.fstat(file.fileno())
    except OSError as error:
        raise SceneError("archive", path, f"cannot be read ({error.strerror})") from error
    if head.startswith(SIGNATURE[:-2]):
        return _unfinished(source, path, running=is_locked(source.with_suffix("")))
    if head.startswith(b"CDF") and b"record_byte" in head:
        raise SceneError(
            "archive", path, "is of a run that gearidae 0.3.0 has not finished: finish it with 0.3.0"
        )
    if not head.startswith(_SIGNATURE):
        raise SceneError("archive", path, "is not a netCDF4 file")
    try:
        check_seal(source)
    except ValueError as error:
        raise SceneError("archive", path, f"is damaged: {error}") from None
    try:
        ds = _opened(source)
    except SceneError:
        raise
    except Exception as error:  # a damaged file can make the netCDF stack raise almost anything
        if source.exists() and not os.path.samestat(looked_at, source.stat()):
            return open_archive(path)  # the netCDF library met the finished file half-way
        raise SceneError("archive", path, f"is damaged or not a netCDF4 file ({error})") from error
    return _checked(ds, path)


def _unfinished(journal: Path, path: str | os.PathLike[str], *, running: bool) -> xr.Dataset:
    """Read the journal of an archive that is not finished."""
    try:
        return _checked(_left_in(journal, running=running), path)
    except FileNotFoundError as error:
        if not as_path(path).exists():
            raise SceneError("archive", path, f"cannot be read ({error.strerror})") from error
        return open_archive(path)  # which has been finished since
    except SceneError:
        raise
    except OSError as error:
        raise SceneError("archive", path, f"cannot be read ({error.strerror or error})") from error
    except ValueError as error:
        allowed = f"is not finished, and {journal.name} has no run that can be read ({error})"
        raise SceneError("archive", path, allowed) from None


def _left_in(journal: Path, *, running: bool) -> xr.Dataset:
    """Make the dataset of what a journal holds of a single run."""
    if kind_of(journal) != TRAIN:
        return RunJournal(journal).dataset(running=running)
    from gearidae.archive.train.journal import TrainJournal  # which few archives need

    with TrainJournal(journal) as of_train:
        return of_train.dataset(running=running)


def _checked(ds: xr.Dataset, path: str | os.PathLike[str]) -> xr.Dataset:
    """Look at a dataset that has been opened, and read it whole if it is not long."""
    try:
        ds.attrs.pop("checksums", None)  # of version 0.1.0
        check_content(ds)
        _check_layout(ds, path)
        ds = converted(ds)
        at_once = ds.nbytes <= LONGEST_WHOLE
        ds = in_memory(ds) if at_once else ds
        if wrong := disagreement(ds, times=at_once):
            raise SceneError("archive", path, f"is damaged: {wrong}")
    except SceneError:
        ds.close()
        raise
    except Exception as error:  # as above: chunks are decoded only now
        ds.close()
        raise SceneError("archive", path, f"is damaged ({error})") from error
    if at_once:
        ds.close()
    return ds


def _opened(source: Path) -> xr.Dataset:
    """Open a file; no more is read than it takes to describe it."""
    await_lock(source)
    store = CheckedStore.open(str(source))  # type: ignore[no-untyped-call]
    try:
        check_size(store.ds, source)
        return _described(store)
    except BaseException:
        store.close()
        raise


def _described(store: CheckedStore) -> xr.Dataset:
    """Make the dataset of an open file."""
    variables = store.ds.variables
    if sum(8 * math.prod(variable.shape) for variable in variables.values()) <= LONGEST_WHOLE:
        return xr.open_dataset(store, decode_times=False)
    for variable in variables.values():
        if isinstance(variable.chunking(), list):
            # two chunks are enough to go through in order; the library's own 64 MB count for each variable
            variable.set_var_chunk_cache(size=2 * CHUNK)
    times = variables.get("time")
    if times is None or times.size <= LARGEST_IN_MEMORY:
        return xr.open_dataset(store, decode_times=False, cache=False)
    ds = xr.open_dataset(store, decode_times=False, cache=False, drop_variables="time")
    return with_times(ds, store.open_store_variable("time", times))


def _check_layout(ds: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Refuse what this version of gearidae did not write or could misread."""
    version = ds.attrs.get("schema_version")
    if version is None or "scene" not in ds.attrs:
        raise SceneError("archive", path, "is not an archive of gearidae (no scene, no schema_version)")
    if not isinstance(version, int | np.integer) or version != SCHEMA_VERSION:
        raise SceneError(
            "archive",
            path,
            f"has schema_version {version!s}: this version of gearidae reads {SCHEMA_VERSION}",
        )
    if "checkpoint" in ds.variables:
        raise SceneError(
            "archive", path, "is of a run that gearidae 0.1.0 has not finished and alone can read"
        )
    scene = readable_scene(ds.attrs["scene"])
    if scene is None:
        raise SceneError("archive", path, "is damaged: its scene is not readable")
    expected = _expected(ds, scene)
    missing = [name for name in expected if name not in ds.variables]
    if "keep" not in ds.attrs and {*expected} - {*missing} <= {"time"}:  # nothing of a run
        what = f'is no archive of runs but "{ds.attrs.get("title", "of a study")}"'
        raise OtherFileError("archive", path, f"{what}: gearidae.open reads it")
    wrong = f"it lacks {', '.join(missing)}" if missing else wrong_attribute(ds)
    if wrong:
        raise SceneError("archive", path, f"is damaged: {wrong}")


def _expected(ds: xr.Dataset, scene: dict[str, Any]) -> tuple[str, ...]:
    """Variables that an archive of any version has at least."""
    later = {column.name for column in (*GEAR_SAMPLES, *ROLLER_SAMPLES) if column.since}
    sampled = tuple(name for name in sampled_columns(roller="roller" in scene) if name not in later)
    rows = tuple(name for kind in kinds_in(ds) for name in needed(kind))  # a user may drop them
    always: tuple[str, ...] = ()
    if is_train(ds):
        later = {*OF_AGEING, *OF_ASPERITIES}
        sampled, totals = (
            tuple(name for name in names if name not in later)
            for names in (TRAIN_SAMPLES, (*SHAFT_TOTALS, *MESH_TOTALS))
        )
        rows, always = (*totals, *rows), tuple(COORDINATES)
    if "keep" not in ds.attrs:
        return (*always, "time", *sampled, *rows)
    try:
        selection = kept_in(ds.attrs, Scene.from_dict(scene))
    except SceneError as error:
        raise SceneError("archive", ds.encoding.get("source", ""), f"is damaged: {error}") from None
    some = tuple(name for name in sampled if selection.holds(name))
    return (*always, *(("time",) if some else ()), *some, *filter(selection.holds, rows), "status", *_JUDGED)


class CheckedStore(xr.backends.NetCDF4DataStore):
    """A netCDF4 file whose variables, whenever they are read, say which of them cannot be."""

    def open_store_variable(self, name: str, var: Any) -> xr.Variable:
        """Describe a variable; its values are read when they are used."""
        variable: xr.Variable = super().open_store_variable(name, var)
        stored = NetCDF4ArrayWrapper(name, self)  # type: ignore[no-untyped-call]
        values = LazilyIndexedArray(_Checked(stored, name, self._filename))
        return xr.Variable(variable.dims, values, variable.attrs, variable.encoding)


class _Checked(BackendArray):
    """Values of one variable in a file."""

    def __init__(self, values: NetCDF4ArrayWrapper, name: str, path: str) -> None:
        self._values, self._name, self._path = values, name, path
        self.shape, self.dtype = values.shape, values.dtype

    def __getitem__(self, key: ExplicitIndexer) -> Any:
        try:
            return self._values[key]
        except (RuntimeError, OSError, ValueError, MemoryError) as error:
            # netCDF4 has one kind of error for a wrong checksum, an unknown filter and a missing piece
            damage = f"is damaged: its variable {self._name} cannot be read ({error})"
            raise SceneError("archive", self._path, damage) from error


def converted(ds: xr.Dataset) -> xr.Dataset:
    """Put the energy balance of a single run, JSON in an attribute up to version 0.2.0, into variables.

    A loss that the version did not know is 0, also in a sweep. The run summary, another attribute, follows from
    the rest.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from a file of any version.
    """
    ds.attrs.pop("account", None)
    kept: dict[str, Any] = json.loads(ds.attrs.pop("energy_balance", "{}"))
    if "swept" not in ds.attrs and "reached" not in ds:
        samples = reached(ds["time"])
        last = float(ds["time"][samples - 1]) if samples else float(ds.attrs["t_end"])
        ds["reached"] = ((), float(kept.get("time", last)), OF_SWEPT_RUN["reached"].attributes)
    later = {name for name, term in TERMS.items() if term.since}
    for name in ENERGY_BALANCE if kept else ():
        ds[name] = (
            (),
            float(kept.get(name, 0.0) if name in later else kept[name]),
            _balance_attributes(name),
        )
    if all(name in ds for name in ENERGY_BALANCE if name not in later):
        for name in later - set(map(str, ds.variables)):
            ds[name] = (ds["residual"].dims, 0.0 * ds["residual"].values, _balance_attributes(name))
    return ds


def _balance_attributes(name: str) -> dict[str, Any]:
    return ENERGY_BALANCE[name].attributes
