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
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.keep import EVERYTHING, OutputSelection
from gearidae.archive.provenance import SCHEMA_VERSION, provenance
from gearidae.archive.store import Store
from gearidae.archive.variables import VERDICT
from gearidae.records import ROWS, EnergyBalance, Extremes, Solution, Statistics

if TYPE_CHECKING:
    from gearidae.scene import Scene

_LAYOUT = 8
"""Version of the entries' layout."""
_KEY: Final = re.compile(r"[0-9a-f]{64}")
"""Keys of runs."""
_STATISTICS = tuple(field.name for field in fields(Statistics) if field.name not in ("ending", "fold_gap"))
"""What is kept of the statistics; a run that is kept has finished."""


def folder_beside(archive: Path) -> Path:
    """Where the runs of an unfinished sweep are kept: ``OUT.nc.runs`` beside ``OUT.nc``."""
    return Store(archive).folder


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
    about : mapping
        Ready for JSON; from `circumstances`, and more.
    """
    text = json.dumps({**about, "scene": scene.to_dict()}, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


class RunCache:
    """The finished runs of one sweep, in the `Store` beside its archive.

    Each is an entry under the hash of all that its result depends on: the scene (with its duration, samples and
    tolerance), the driver of the solver, and the versions of the software. Runs are not forced onto the disk, which
    would take longer than many a run. Nothing in a file is ever executed.

    Parameters
    ----------
    archive : Path
        Where the whole sweep is to go.
    scene : Scene
        Any scene of the sweep.
    backend : str
        The driver that runs, ``native`` or ``sksundae``.
    keep : OutputSelection, optional
        What each run leaves behind; by default everything.
    """

    def __init__(self, archive: Path, scene: Scene, backend: str, keep: OutputSelection = EVERYTHING) -> None:
        self._store = Store(archive)
        self.folder = self._store.folder
        self._circumstances = {
            "layout": _LAYOUT,
            **circumstances(scene, backend),
            **({} if keep.names is None else {"keep": keep.asked}),
        }
        self._warned = False

    def count(self) -> int:
        """Count the runs that are kept."""
        return len(self._keys())

    def key(self, scene: Scene) -> str:
        """Hash of a scene and of all else that its result depends on."""
        return name_of(scene, self._circumstances)

    def keep(self, scene: Scene, solution: Solution, judged: Mapping[str, str | int] | None = None) -> None:
        """Write a finished run, or what it leaves behind and how it was judged, a value for each of `VERDICT`.

        A run that cannot be kept is no reason to stop; that is said in one warning for the sweep.
        """
        header = _header(solution, {name: (judged or {}).get(name) for name in VERDICT})
        tables = {
            "samples": np.stack([solution.time, *solution.samples.values()]),
            **{kind.field: getattr(solution, kind.field).table() for kind in ROWS},
        }
        try:
            self._store.put(
                self.key(scene), header, {name: table for name, table in tables.items() if table.size}
            )
        except OSError as error:
            if not self._warned:
                warnings.warn(f"finished runs cannot be kept in {self.folder} ({error})", stacklevel=2)
            self._warned = True

    def take(self, scene: Scene) -> tuple[Solution, dict[str, Any]] | None:
        """Read a run back, with how it was judged; that is empty if it was not.

        None, and a warning, if its file is damaged or not what its name says.
        """
        key = self.key(scene)
        try:
            entry = self._store.take(key)
            return None if entry is None else _rebuilt(*entry)
        except Exception as error:  # what a damaged file makes the libraries raise may be anything
            path = self._store.path(key)
            warnings.warn(f"{path} is ignored and its run computed again ({error})", stacklevel=2)
            return None

    def note_strangers(self, scenes: Collection[Scene]) -> None:
        """Warn of kept runs that are none of these scenes."""
        strangers = len(self._keys() - {self.key(scene) for scene in scenes})
        if strangers:
            warnings.warn(
                f"{strangers} of the runs kept in {self.folder} are of other scenes, settings or versions; "
                "they are ignored and left there",
                stacklevel=2,
            )

    def remove(self, scenes: Collection[Scene] | None = None) -> None:
        """Delete the kept runs of some scenes, or all of them, and the folder if nothing else is in it."""
        self._store.remove(self._keys() if scenes is None else {self.key(scene) for scene in scenes})

    def _keys(self) -> set[str]:
        return {key for key in self._store.entries() if _KEY.fullmatch(key)}


def _header(solution: Solution, judged: dict[str, Any]) -> dict[str, Any]:
    """All of a run but its samples and rows."""
    return {
        "judged": judged,
        "columns": list(solution.samples),
        "statistics": {name: getattr(solution.statistics, name) for name in _STATISTICS},
        "status": solution.status,
        "message": solution.message,
        "reached": solution.reached,
        "balance": solution.balance,
        "extremes": solution.extremes,
    }


def _rebuilt(header: dict[str, Any], tables: Mapping[str, NDArray[Any]]) -> tuple[Solution, dict[str, Any]]:
    """Make a run of its header and its tables."""
    time, *samples = tables.get("samples", np.empty((1 + len(header["columns"]), 0)))
    columns = {name: row.copy() for name, row in zip(header["columns"], samples, strict=True)}
    rows: dict[str, Any] = {
        kind.field: kind.of_table(tables.get(kind.field, kind.no_table())) for kind in ROWS
    }
    extremes = header["extremes"]  # JSON has no arrays
    solution = Solution(
        time.copy(),
        columns,
        statistics=Statistics(**header["statistics"]),
        status=header["status"],
        message=header["message"],
        reached=header["reached"],
        balance=header["balance"] and EnergyBalance(header["balance"]),
        extremes=extremes and Extremes({**extremes, "exposures": array("d", extremes["exposures"])}),
        **rows,
    )
    judged = {name: header["judged"][name] for name in VERDICT}
    kinds = {name: str if variable.dtype is np.str_ else int for name, variable in VERDICT.items()}
    return solution, {name: kinds[name](value) for name, value in judged.items() if value is not None}
