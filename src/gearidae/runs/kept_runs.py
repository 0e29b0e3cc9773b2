"""Finished runs of a sweep, kept on disk until the whole sweep is, so that it can go on where it was cut off."""

from __future__ import annotations

import hashlib
import json
import re
import warnings
from array import array
from collections.abc import Collection, Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import netCDF4
import numpy as np
from numpy.typing import NDArray

from gearidae.archive.disk import part_beside
from gearidae.archive.keep import EVERYTHING, Keep
from gearidae.archive.library import LIBRARY
from gearidae.archive.provenance import SCHEMA_VERSION, provenance
from gearidae.archive.variables import VERDICT
from gearidae.records import EnergyBalance, Events, Extremes, Solution, Statistics
from gearidae.runs.run_journal import RunJournal

if TYPE_CHECKING:
    from gearidae.scene import Scene

__all__ = ["KeptRuns", "circumstances", "folder_beside", "name_of"]

Floats = NDArray[np.float64]

_LAYOUT = 5
"""Version of the files' layout."""
_JOURNAL = "runs.jsonl"
"""Holds the runs without samples and events."""
_OURS = re.compile(r"\.?([0-9a-f]{64}|runs\.jsonl)(\.[0-9]+-[0-9a-f]{8}\.part|\.nc)")
"""Names of our other files, finished or cut off while they were written."""
_EVENTS = {
    "time": np.float64,
    "kind": np.int8,
    "pair": np.int64,
    "flank": np.int8,
    "gap_rate": np.float64,
    "asperity": np.int64,
}
"""Rows of the table of events, all of which double precision holds exactly, and their types in memory."""

_STATISTICS = tuple(field.name for field in fields(Statistics) if field.name not in ("ending", "fold_gap"))
"""What is kept of the statistics; a run that is kept has finished."""


def folder_beside(archive: Path) -> Path:
    """Where the runs of an unfinished sweep are kept: ``OUT.nc.runs`` beside ``OUT.nc``."""
    return archive.with_name(f"{archive.name}.runs")


def circumstances(scene: Scene, backend: str) -> dict[str, Any]:
    """Return what a result depends on besides its scene.

    Parameters
    ----------
    scene : Scene
        Any of a sweep.
    backend : str
        The driver that runs, ``native`` or ``sksundae``.
    """
    return {
        "schema": SCHEMA_VERSION,
        "software": provenance(scene, "")["source"],
        "backend": backend,
    }


def name_of(scene: Scene, about: Mapping[str, Any]) -> str:
    """Hash of a scene and of all else that a result depends on: what its file is called.

    Parameters
    ----------
    scene : Scene
    about : mapping
        Ready for JSON; from `circumstances`, and more.
    """
    text = json.dumps({**about, "scene": scene.to_dict()}, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


class KeptRuns:
    """The folder of finished runs of one sweep.

    Each run is a netCDF file named by the hash of all that its result depends on: the scene (with its
    duration, samples and tolerance), the driver of the solver, and the versions of the software. It appears
    under its name only when it is complete. A run without samples and events is a line of the file ``runs.jsonl``
    instead, under the same hash: a file of its own takes ten times as long. Runs are not forced onto the disk, which
    would take longer than many a run; what a power failure leaves of them is found by checksums. Nothing in a file is
    ever executed.

    Parameters
    ----------
    archive : Path
        Where the whole sweep is to go.
    scene : Scene
        Any scene of the sweep.
    backend : str
        The driver that runs, ``native`` or ``sksundae``.
    keep : Keep, optional
        What each run leaves behind; by default everything.
    """

    def __init__(self, archive: Path, scene: Scene, backend: str, keep: Keep = EVERYTHING) -> None:
        self.folder = folder_beside(archive)
        self._journal = RunJournal(self.folder / _JOURNAL)
        self._circumstances = {
            "layout": _LAYOUT,
            **circumstances(scene, backend),
            **({} if keep.names is None else {"keep": keep.asked}),
        }
        self._warned = False

    def count(self) -> int:
        """Count the runs that are kept."""
        return sum(path.suffix == ".nc" for path in self._files()) + len(self._journal)

    def key(self, scene: Scene) -> str:
        """Hash of a scene and of all else that its result depends on."""
        return name_of(scene, self._circumstances)

    def keep(self, scene: Scene, solution: Solution, judged: Mapping[str, str | int] | None = None) -> None:
        """Write a finished run, or what it leaves behind and how it was judged, a value for each of `VERDICT`.

        A run that cannot be kept is no reason to stop; that is said in one warning for the sweep.
        """
        key = self.key(scene)
        header = _header(key, solution, {name: (judged or {}).get(name) for name in VERDICT})
        try:
            self.folder.mkdir(exist_ok=True)
            if not len(solution.time) and not len(solution.events):
                self._journal.append(key, header)
            else:
                self._write(key, header, solution)
        except (OSError, RuntimeError) as error:  # netCDF4 reports a full disk as either
            if not self._warned:
                warnings.warn(f"finished runs cannot be kept in {self.folder} ({error})", stacklevel=2)
            self._warned = True

    def take(self, scene: Scene) -> tuple[Solution, dict[str, Any]] | None:
        """Read a run back, with how it was judged; that is empty if it was not.

        None, and a warning, if its file is damaged or not what its name says.
        """
        key = self.key(scene)
        path = self._path(key)
        try:
            if path.is_file():
                return _read(path, key)
            path = self._journal.path
            text = self._journal.read(key)
            return None if text is None else _rebuilt(json.loads(text), key)
        except Exception as error:  # a damaged file can make the netCDF stack raise almost anything
            warnings.warn(f"{path} is ignored and its run computed again ({error})", stacklevel=2)
            return None

    def note_strangers(self, scenes: Collection[Scene]) -> None:
        """Warn of kept runs that are none of these scenes."""
        own = {self.key(scene) for scene in scenes}
        strangers = sum(path.suffix == ".nc" and path.stem not in own for path in self._files())
        strangers += len(self._journal.keys() - own)
        if strangers:
            warnings.warn(
                f"{strangers} of the runs kept in {self.folder} are of other scenes, settings or versions; "
                "they are ignored and left there",
                stacklevel=2,
            )

    def remove(self, scenes: Collection[Scene] | None = None) -> None:
        """Delete the kept runs of some scenes, or all of them, and the folder if nothing else is in it."""
        own = None if scenes is None else {self.key(scene) for scene in scenes}
        for path in self._files():
            if own is None or path.stem in own or path.suffix == ".part":
                path.unlink(missing_ok=True)
        self._journal.remove(self._journal.keys() if own is None else own)
        if self.folder.is_dir() and not any(self.folder.iterdir()):
            self.folder.rmdir()

    def _write(self, key: str, header: str, solution: Solution) -> None:
        """Write a run to a file of its own, which appears when it is whole."""
        part = part_beside(self.folder / key)
        try:
            _write(part, header, solution)
            part.replace(self._path(key))
        finally:
            part.unlink(missing_ok=True)

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.nc"

    def _files(self) -> list[Path]:
        if not self.folder.is_dir():
            return []
        return [path for path in self.folder.iterdir() if _OURS.fullmatch(path.name)]


def _header(key: str, solution: Solution, judged: dict[str, Any]) -> str:
    """All of a run but its samples and events."""
    return json.dumps(
        {
            "key": key,
            "judged": judged,
            "columns": list(solution.samples),
            "statistics": {name: getattr(solution.statistics, name) for name in _STATISTICS},
            "status": solution.status,
            "message": solution.message,
            "reached": solution.reached,
            "balance": None if solution.balance is None else _numbers(solution.balance),
            "extremes": None if solution.extremes is None else _numbers(solution.extremes),
        },
        default=_plain,
    )


def _write(path: Path, header: str, solution: Solution) -> None:
    """Two tables and a header in the classic format: a tenth of the time that an archive takes."""
    samples = np.stack([solution.time, *solution.samples.values()])
    events = np.stack([getattr(solution.events, name).astype(np.float64) for name in _EVENTS])
    with LIBRARY, netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.set_fill_off()
        for name, table in (("samples", samples), ("events", events)):
            if not table.size:  # the classic format has no dimensions of length zero
                continue
            dims = (f"{name}_row", f"{name}_number")
            for dim, size in zip(dims, table.shape, strict=True):
                file.createDimension(dim, size)
            file.createVariable(name, np.float64, dims)[:] = table
        file.setncatts(
            {
                "title": "a finished run of an unfinished sweep of gearidae",
                "header": header,
                "checksum": _checksum(header, samples, events),
            }
        )


def _plain(value: Any) -> Any:
    """What JSON has not: arrays, and numpy's integers."""
    return value.tolist() if isinstance(value, array) else int(value)


def _numbers(record: EnergyBalance | Extremes) -> dict[str, Any]:
    """Fields of a record of numbers; `dataclasses.asdict` copies each of them deeply, which takes longer."""
    return {field.name: getattr(record, field.name) for field in fields(record)}


def _read(path: Path, key: str) -> tuple[Solution, dict[str, Any]]:
    """Rebuild what `_write` wrote; ValueError if the file is another's or damaged."""
    with LIBRARY, netCDF4.Dataset(path, "r") as file:
        file.set_auto_maskandscale(False)
        text = str(file.getncattr("header"))
        header: dict[str, Any] = json.loads(text)
        samples, events = (
            np.array(file[name][:], np.float64) if name in file.variables else np.empty((rows, 0))
            for name, rows in (("samples", 1 + len(header["columns"])), ("events", len(_EVENTS)))
        )
        if file.getncattr("checksum") != _checksum(text, samples, events):
            raise ValueError("its checksum does not agree")
    return _rebuilt(header, key, samples, events)


def _rebuilt(
    header: dict[str, Any], key: str, samples: Floats | None = None, events: Floats | None = None
) -> tuple[Solution, dict[str, Any]]:
    """Make a run of its header and its tables, which may be empty; ValueError if it is another's."""
    samples = np.empty((1 + len(header["columns"]), 0)) if samples is None else samples
    events = np.empty((len(_EVENTS), 0)) if events is None else events
    if header["key"] != key:
        raise ValueError("it is of another scene, setting or version")
    columns = {name: row.copy() for name, row in zip(header["columns"], samples[1:], strict=True)}
    table = {name: row.astype(dtype) for (name, dtype), row in zip(_EVENTS.items(), events, strict=True)}
    solution = Solution(
        samples[0].copy(),
        columns,
        Events(**table),
        Statistics(**header["statistics"]),
        header["status"],
        header["message"],
        header["reached"],
        None if header["balance"] is None else EnergyBalance(**header["balance"]),
        _extremes(header.get("extremes")),
    )
    found = {name: header["judged"][name] for name in VERDICT}
    kinds = {name: str if variable.dtype is np.str_ else int for name, variable in VERDICT.items()}
    return solution, {name: kinds[name](value) for name, value in found.items() if value is not None}


def _extremes(numbers: dict[str, Any] | None) -> Extremes | None:
    """Read extremes back; JSON has no arrays."""
    if numbers is None:
        return None
    return Extremes(**{**numbers, "exposures": array("d", numbers.get("exposures", ()))})


def _checksum(header: str, *tables: Floats) -> str:
    digest = hashlib.sha256(header.encode())
    for table in tables:
        digest.update(repr(table.shape).encode())
        digest.update(np.ascontiguousarray(table, dtype="<f8").tobytes())
    return digest.hexdigest()
