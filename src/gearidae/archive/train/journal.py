"""The journal of a run of a train: its blocks as they come, each with the state to go on from."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.journal import TRAIN, Frame
from gearidae.archive.train.dataset import train_dataset
from gearidae.archive.unfinished import CHECKPOINT_SECONDS, CHECKPOINT_SHARE, RESUMABLE, JournalOfRun
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
from gearidae.scene import is_long_train


class TrainJournal(JournalOfRun):
    """The journal of a single run of a train."""

    kind = TRAIN

    def __init__(self, path: Path, mode: Literal["r", "a"] = "r") -> None:
        super().__init__(path, mode)
        self._held: list[TrainBlock] = []

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
            [shaft.name for shaft in self._of_train.train.shafts],
            [mesh.name for mesh in self._of_train.train.meshes],
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
        ds = train_dataset(self._of_train, solution)
        kept = {name: self.attributes[name] for name in ("started_from", "parent") if name in self.attributes}
        return ds.assign_attrs(kept)

    def _check(self) -> None:
        """Refuse frames that are not of the scene."""
        if not is_long_train(self.scene):
            raise ValueError("its scene is no train of several meshes")
        self._of_train = self.scene
        self._counts = n, m = len(self.scene.train.shafts), len(self.scene.train.meshes)
        sizes = {name: columns_of(name, n, m) for name in (*TABLES, "resting")}
        for number, frame in enumerate(self._frames, 1):
            columns = {name: shape[1] for name, shape in frame.shapes.items() if len(shape) == 2}
            if columns != sizes or len(frame.shapes.get("state", ())) != 1:
                raise ValueError(f"its frame {number} is not of its scene")
        if sum(frame.shapes["samples"][0] for frame in self._frames) > self.scene.run.sample_count:
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
