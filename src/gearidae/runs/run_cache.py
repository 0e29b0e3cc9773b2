"""Finished runs of a sweep or a study, kept in its journal until its archive is written, so that it can go on."""

from __future__ import annotations

import hashlib
import json
import warnings
from array import array
from collections.abc import Collection, Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.journal import Journal, journal_of
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.archive.provenance import SCHEMA_VERSION, provenance
from gearidae.archive.variables import VERDICT
from gearidae.errors import SceneError
from gearidae.records import ROWS, EnergyBalance, Extremes, Solution, Statistics
from gearidae.records.train_results import AnySolution, TrainSolution

if TYPE_CHECKING:
    from gearidae.scene import Scene

_LAYOUT = 9
"""Version of what is kept of a run."""
_STATISTICS = tuple(field.name for field in fields(Statistics) if field.name not in ("ending", "fold_gap"))
"""What is kept of the statistics; a run that is kept has finished."""
_TRAIN_HEADER = ("shafts", "meshes", "status", "message", "reached", "start", "energy", "extremes", "held_by")
_TRAIN_TOTALS, _TRAIN_ROWS = ("shaft_totals", "mesh_totals"), ("events", "rests")
"""Fields of the solution of a train, in the header of its frame and in tables."""


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
    """The finished runs of one sweep, in the journal beside its archive.

    Each is a frame under the hash of all that its result depends on: the scene (with its duration, samples and
    tolerance), the driver of the solver, and the versions of the software. Runs are not forced onto the disk, which
    would take longer than many a run.

    Parameters
    ----------
    archive : Path
        Where the whole sweep is to go; claimed by this process.
    scene : Scene
        Any scene of the sweep.
    backend : str
        The driver that runs, ``native`` or ``sksundae``.
    store : OutputSelection, optional
        What each run leaves behind; by default everything.

    Raises
    ------
    SceneError
        If runs of version 0.3.0 are kept there, which it alone can read.
    """

    def __init__(
        self, archive: Path, scene: Scene, backend: str, selection: OutputSelection = EVERYTHING
    ) -> None:
        self.path = journal_of(archive)
        self._circumstances = {
            "layout": _LAYOUT,
            **circumstances(scene, backend),
            **({} if selection.names is None else {"keep": selection.asked}),
        }
        self._warned = False
        self._journal: Journal | None = None
        self._runs: dict[str, int] = {}  # where each begins
        self._obstacle = ""
        _refuse_older(archive)
        if self.path.exists():
            self._open()

    def count(self) -> int:
        """Count the runs that are kept."""
        return len(self._runs)

    def key(self, scene: Scene) -> str:
        """Hash of a scene and of all else that its result depends on."""
        return name_of(scene, self._circumstances)

    def store(
        self, scene: Scene, solution: AnySolution, judged: Mapping[str, str | int] | None = None
    ) -> None:
        """Write a finished run, or what it leaves behind and how it was judged, a value for each of `VERDICT`.

        A run that cannot be kept is no reason to stop; that is said in one warning for the sweep.
        """
        words = {name: (judged or {}).get(name) for name in VERDICT}
        if isinstance(solution, TrainSolution):
            header, tables = _of_train(solution, words)
        else:
            header, tables = _of_pair(solution, words)
        key = self.key(scene)
        try:
            if self._journal is None:
                self._journal = Journal.create(self.path, "runs")
            self._runs[key] = self._journal.append({"key": key, **header}, tables).begin
        except OSError as error:
            if not self._warned:
                warnings.warn(f"finished runs cannot be kept in {self.path} ({error})", stacklevel=2)
            self._warned = True

    def take(self, scene: Scene) -> tuple[AnySolution, dict[str, Any]] | None:
        """Read a run back, with how it was judged; that is empty if it was not. None if it is not there."""
        begin = self._runs.get(self.key(scene))
        if begin is None or self._journal is None:
            return None
        try:
            frame = self._journal.frame(begin)
            tables = {name: self._journal.table(frame, name) for name in frame.shapes}
            return (_train_rebuilt if "shafts" in frame.header else _rebuilt)(frame.header, tables)
        except (
            OSError,
            KeyError,
            TypeError,
            ValueError,
            AttributeError,
        ) as error:  # of another layout, or cut since
            warnings.warn(f"a run kept in {self.path} is ignored and computed again ({error})", stacklevel=2)
            return None

    def refuse_others(self) -> None:
        """Raise a SceneError if something else is in the place of the journal."""
        if self._obstacle:
            allowed = f"{self._obstacle}: start anew with --overwrite (overwrite=True), or name another"
            raise SceneError("archive", self.path.with_suffix(""), allowed)

    def note_strangers(self, scenes: Collection[Scene]) -> None:
        """Warn of kept runs that are none of these scenes."""
        strangers = len(self._runs.keys() - {self.key(scene) for scene in scenes})
        if strangers:
            warnings.warn(
                f"{strangers} of the runs kept in {self.path} are of other scenes, settings or versions; "
                "they are ignored and left there",
                stacklevel=2,
            )

    def remove(self, scenes: Collection[Scene] | None = None) -> None:
        """Delete the journal; if scenes are given, only where no other runs are kept in it."""
        strangers = set() if scenes is None else self._runs.keys() - {self.key(scene) for scene in scenes}
        self.close()
        if not strangers:
            self._runs, self._obstacle = {}, ""
            if self.path.is_file():
                self.path.unlink()

    def close(self) -> None:
        """Leave the runs as they are."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def _open(self) -> None:
        """Find the runs in the journal that is there; those that are altered are warned of."""
        altered = 0
        try:
            self._journal = Journal(self.path, "runs", "a")
            for frame in self._journal.frames():
                if frame is None:
                    altered += 1
                else:
                    self._runs[str(frame.header["key"])] = frame.begin
        except (OSError, ValueError, KeyError, TypeError) as error:
            self.close()
            self._obstacle = f"{self.path.name} beside it has no runs of a sweep or study ({error})"
            return
        if altered:
            what = f"{altered} of the runs kept in {self.path} are damaged"
            warnings.warn(f"{what}: they are ignored and computed again", stacklevel=2)


def _refuse_older(archive: Path) -> None:
    """Refuse to write where version 0.3.0 has kept what it has not finished."""
    folder = archive.with_name(f"{archive.name}.runs")
    if folder.is_dir() and any(folder.glob("*.npz")):
        allowed = f"was begun by gearidae 0.3.0: finish it with 0.3.0, or delete the folder {folder.name}"
        raise SceneError("archive", archive, allowed)


Tables = dict[str, NDArray[Any]]


def _of_pair(solution: Solution, judged: dict[str, Any]) -> tuple[dict[str, Any], Tables]:
    """Header and tables of a run: its samples and rows, and all else."""
    header = {
        "judged": judged,
        "columns": list(solution.samples),
        "statistics": {name: getattr(solution.statistics, name) for name in _STATISTICS},
        "status": solution.status,
        "message": solution.message,
        "reached": solution.reached,
        "balance": solution.balance,
        "extremes": solution.extremes,
    }
    return header, {
        "samples": np.stack([solution.time, *solution.samples.values()]),
        **{kind.field: getattr(solution, kind.field).table() for kind in ROWS},
    }


def _of_train(solution: TrainSolution, judged: dict[str, Any]) -> tuple[dict[str, Any], Tables]:
    """Header and tables of a run of a train."""
    samples = solution.samples
    header = {
        "judged": judged,
        "columns": {name: len(values) if values.ndim > 1 else 0 for name, values in samples.items()},
        "statistics": {name: getattr(solution.statistics, name) for name in _STATISTICS},
        **{name: getattr(solution, name) for name in _TRAIN_HEADER},
        **{
            name: {key: values.tolist() for key, values in getattr(solution, name).items()}
            for name in _TRAIN_TOTALS
        },
    }
    rows = [np.atleast_2d(values) for values in samples.values()]
    return header, {
        "samples": np.concatenate([solution.time[None], *rows]),
        **{name: _table(getattr(solution, name)) for name in _TRAIN_ROWS},
    }


def _table(columns: Mapping[str, NDArray[Any]]) -> NDArray[np.float64]:
    """Columns as rows of a table, in the order of their names."""
    return np.array([columns[name] for name in sorted(columns)], dtype=np.float64)


def _train_rebuilt(
    header: dict[str, Any], tables: Mapping[str, NDArray[Any]]
) -> tuple[TrainSolution, dict[str, Any]]:
    """Make a run of a train of its header and its tables."""
    none = TrainSolution.none(header["shafts"], header["meshes"], "", "")
    counts: dict[str, int] = header["columns"]
    rows = 1 + sum(max(count, 1) for count in counts.values())
    time, *columns = tables.get("samples", np.empty((rows, 0)))
    left, samples = iter(columns), {}
    for name, count in counts.items():
        samples[name] = np.array([next(left) for _ in range(count)]) if count else next(left).copy()
    made: dict[str, Any] = {}
    for name in _TRAIN_ROWS:
        kinds = {key: column.dtype for key, column in getattr(none, name).items()}
        parts = zip(sorted(kinds), tables.get(name, np.empty((len(kinds), 0))), strict=True)
        made[name] = {key: part.astype(kinds[key]) for key, part in parts}
    totals: dict[str, Any] = {
        name: {key: np.array(values) for key, values in header[name].items()} for name in _TRAIN_TOTALS
    }
    fields: dict[str, Any] = {name: header[name] for name in _TRAIN_HEADER}
    fields |= {name: tuple(header[name]) for name in ("shafts", "meshes", "held_by")}
    fields["extremes"] = header["extremes"] and _extremes(header["extremes"])
    statistics = Statistics(**header["statistics"])
    solution = TrainSolution(
        time=time.copy(), samples=samples, statistics=statistics, **fields, **made, **totals
    )
    return solution, _judged(header)


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
        extremes=extremes and _extremes(extremes),
        **rows,
    )
    return solution, _judged(header)


def _extremes(numbers: dict[str, Any]) -> Extremes:
    return Extremes(
        {**numbers, **{name: array("d", numbers[name]) for name in ("exposures", "standstill_list")}}
    )


def _judged(header: dict[str, Any]) -> dict[str, Any]:
    """How a run has been judged."""
    judged = {name: header["judged"][name] for name in VERDICT}
    kinds = {name: str if variable.dtype is np.str_ else int for name, variable in VERDICT.items()}
    return {name: kinds[name](value) for name, value in judged.items() if value is not None}
