"""The journal of a run of a train: its blocks as they come, each with the state to go on from."""

from __future__ import annotations

import itertools
import logging
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.attributes import readable_scene
from gearidae.archive.journal import TRAIN, Frame, Journal, journal_of
from gearidae.archive.train.dataset import train_dataset
from gearidae.archive.unfinished import CHECKPOINT_SECONDS, CHECKPOINT_SHARE, RESUMABLE
from gearidae.records import Statistics, sample_times
from gearidae.records.train_results import (
    MESH_TOTALS,
    SHAFT_TOTALS,
    TABLES,
    TrainBlock,
    TrainTotals,
    columns_of,
    solution_of,
)
from gearidae.scene import Scene, is_long_train

log = logging.getLogger(__name__)


class TrainJournal:
    """The journal of a single run of a train.

    Parameters
    ----------
    path : Path
        The journal.
    mode : {"r", "a"}, optional
        To read, or to go on with the run.

    Attributes
    ----------
    attributes : dict
        Of the run's dataset, as it began.

    Raises
    ------
    OSError
        If the disk does not give it.
    ValueError
        If it is not of a train, or damaged at its head.
    """

    def __init__(self, path: Path, mode: Literal["r", "a"] = "r") -> None:
        self._journal = Journal(path, TRAIN, mode)
        self._held: list[TrainBlock] = []
        self._written = time.monotonic()
        try:
            self._read()
        except (KeyError, TypeError, AttributeError) as error:  # sound, but of something else
            self.close()
            raise ValueError(
                f"it is not of a run of this version ({type(error).__name__}: {error})"
            ) from error
        except BaseException:
            self.close()
            raise

    @classmethod
    def create(cls, archive: Path, attributes: Mapping[str, Any]) -> TrainJournal:
        """Begin the journal of a run, in the place of whatever is there.

        Raises
        ------
        OSError
            If the disk does not take it; nothing is left behind then.
        """
        path = journal_of(archive)
        with Journal.create(path, TRAIN, attributes=dict(attributes)) as journal:
            journal.sync()
        return cls(path, "a")

    def __enter__(self) -> TrainJournal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._journal.close()

    def take(self, block: TrainBlock) -> None:
        """Append a block; several that come in quick succession are one frame.

        Raises
        ------
        OSError
            If the disk does not take it; what was there before stays as it is.
        """
        self._held.append(block)
        if time.monotonic() - self._written >= max(CHECKPOINT_SECONDS, CHECKPOINT_SHARE * block.wall_time):
            self.flush()

    def flush(self) -> None:
        """Write the blocks that wait, and wait for the disk.

        Raises
        ------
        OSError
            If it does not take them; they are given up.
        """
        if not self._held:
            return
        held, self._held = self._held, []
        last, totals = held[-1], held[-1].totals
        header = {
            "time": last.time,
            "wall_time": last.wall_time,
            "shafts": {name: values.tolist() for name, values in totals.shafts.items()},
            "meshes": {name: values.tolist() for name, values in totals.meshes.items()},
            "energy": totals.energy,
        }
        tables = {name: np.concatenate([block.tables[name] for block in held]) for name in TABLES}
        # as words: some may be no numbers
        state = np.ascontiguousarray(last.checkpoint).view(np.uint64)
        self._frames.append(
            self._journal.append(header, {**tables, "resting": totals.resting, "state": state})
        )
        self._journal.sync()
        self._written = time.monotonic()

    def blocks(self) -> list[TrainBlock]:
        """Return the blocks that are there, to go on behind the last of them; what is not whole is cut off."""
        self._journal.cut((self._frames or [self._journal.head])[-1].end)
        return [self._block(frame) for frame in self._frames]

    def dataset(self, *, running: bool) -> xr.Dataset:
        """Make the dataset of what is there, and say how the run stands.

        Parameters
        ----------
        running : bool
            Whether a process is writing it.
        """
        remedy = "" if running else RESUMABLE
        message, blocks, n, m = "", [self._block(frame) for frame in self._frames], *self._counts
        start = float(self.attributes.get("start_time", 0.0))
        sizes = [columns_of(name, n, m) for name in TABLES]
        tables: list[NDArray[np.float64]] = [
            np.concatenate([np.empty((0, size)), *(block.tables[name] for block in blocks)])
            for name, size in zip(TABLES, sizes, strict=True)
        ]
        if blocks:
            message = f"; checkpoint at {blocks[-1].time:g} s"
        run = self.scene.run
        solution = solution_of(
            [shaft.name for shaft in self.scene.train.shafts],
            [mesh.name for mesh in self.scene.train.meshes],
            sample_times(start, run.duration, run.sample_count),
            np.empty(0),
            tables,
            blocks[-1].totals if blocks else TrainTotals.none(n, m),
            status="running" if running else "interrupted",
            message=f"not at its end yet{message}{remedy}",
            reached=blocks[-1].time if blocks else start,
            start=start,
            statistics=Statistics(
                wall_time=blocks[-1].wall_time if blocks else 0.0, backend=str(self.attributes["backend"])
            ),
            checkpoint=blocks[-1].checkpoint if blocks else None,
        )
        ds = train_dataset(self.scene, solution)
        kept = {name: self.attributes[name] for name in ("started_from", "parent") if name in self.attributes}
        return ds.assign_attrs(kept)

    def _read(self) -> None:
        """Read the head, and the whole frames up to the first that is altered."""
        found = [*self._journal.frames()]
        self._frames: list[Frame] = [
            frame for frame in itertools.takewhile(lambda frame: frame is not None, found) if frame
        ]
        if len(self._frames) < len(found):
            count = len(self._frames)
            log.warning("%s is damaged: what comes after its frame %d is left out", self._journal.path, count)
        self.attributes: dict[str, Any] = dict(self._journal.head.header["attributes"])
        scene = readable_scene(self.attributes["scene"])
        made = None if scene is None else Scene.from_dict(scene)
        if made is None or not is_long_train(made):
            raise ValueError("its scene is not readable")
        self.scene = made
        self._counts = n, m = len(made.train.shafts), len(made.train.meshes)
        sizes = {name: columns_of(name, n, m) for name in (*TABLES, "resting")}
        for number, frame in enumerate(self._frames, 1):
            columns = {name: shape[1] for name, shape in frame.shapes.items() if len(shape) == 2}
            if columns != sizes or len(frame.shapes.get("state", ())) != 1:
                raise ValueError(f"its frame {number} is not of its scene")
        if sum(frame.shapes["samples"][0] for frame in self._frames) > made.run.sample_count:
            raise ValueError("it has more samples than its scene")

    def _block(self, frame: Frame) -> TrainBlock:
        header, table = frame.header, self._journal.table
        totals = TrainTotals(
            {name: np.array(header["shafts"][name], dtype=float) for name in SHAFT_TOTALS},
            {name: np.array(header["meshes"][name], dtype=float) for name in MESH_TOTALS},
            {name: float(value) for name, value in header["energy"].items()},
            table(frame, "resting"),
        )
        state = self._journal.values(frame, "state").view(np.float64).copy()
        tables = {name: table(frame, name) for name in TABLES}
        return TrainBlock(float(header["time"]), float(header["wall_time"]), tables, state, totals)
