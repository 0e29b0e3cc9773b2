"""The journal of a run: its blocks as they come, the state to go on from, and the dataset of what is there.

The first frame is the run's head, the attributes of its dataset. The others are blocks of output; those that a run can
go on from hold its state, too. Reading needs no more memory than what is asked for: samples and rows stay in the file
until they are used.
"""

from __future__ import annotations

import itertools
import logging
import time
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, Self, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from xarray.backends import BackendArray
from xarray.core.indexing import (
    ExplicitIndexer,
    IndexingSupport,
    LazilyIndexedArray,
    explicit_indexing_adapter,
)

from gearidae.archive.attributes import readable_scene
from gearidae.archive.dataset import to_dataset
from gearidae.archive.end_state import end_state_attributes
from gearidae.archive.journal import RUN, Journal, journal_of
from gearidae.archive.row_variables import archived, teeth_in
from gearidae.archive.time_index import LARGEST_IN_MEMORY, with_times
from gearidae.archive.totals import total_variables
from gearidae.archive.variables import SAM_FRACTION
from gearidae.records import (
    COUNTERS,
    ROWS,
    Block,
    EnergyBalance,
    Events,
    Extremes,
    Solution,
    Statistics,
    Words,
    sample_times,
)
from gearidae.scene import Scene
from gearidae.scene.sampled import columns_of

log = logging.getLogger(__name__)

RESUMABLE: Final = "; go on with --resume (resume=True)"
"""End of the message of a run that nobody goes on with."""
CHECKPOINT_SECONDS = 1.0
"""Least wall time between states that are kept [s]: each waits for the disk."""
CHECKPOINT_SHARE: Final = 0.01
"""Least wall time between them over that of the whole run until then: those of elastic bodies take up to a megabyte,
and are kept to the end of the run; of ten hours there are 700."""

_FIELDS: Final[Mapping[str, str]] = {"time": "samples", **{kind.dim: kind.field for kind in ROWS}}
"""Dimensions that grow, each with the array of a block that holds its columns."""
_Part: TypeAlias = Callable[[int, int, int], NDArray[Any]]
"""Gives the values of a variable in a block, from one to before another."""
FRAME_SHARE: Final = 0.001
"""Least wall time between frames over that of the run until then: of ten hours there are 6,000, in place of the 180,000
blocks of a fifth of a second that the engine hands up, each of which costs its reader time."""
FRAME_BYTES: Final = 2**20
"""Size from which on blocks do not wait for others."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Where a run can go on from.

    Attributes
    ----------
    time : float
        Simulated time [s].
    wall_time : float
        Wall time in the solver until then [s].
    statistics : Statistics
        The solver's counters there.
    state : ndarray of 8-byte words
        What the engine needs, kept to the last bit; the engine checks it.
    events : int
        Events until then.
    extremes : Extremes, optional
        Of the run until then, without exposures.
    balance : EnergyBalance, optional
        Of the run until then.
    """

    time: float
    wall_time: float
    statistics: Statistics
    state: Words
    events: int
    extremes: Extremes | None = None
    balance: EnergyBalance | None = None


class JournalOfRun(ABC):
    """What journals of single runs have in common: the head with the scene, and the whole frames behind it.

    Parameters
    ----------
    path : Path
        The journal.
    mode : {"r", "a"}, optional
        To read, or to go on with the run.

    Attributes
    ----------
    kind : str
        What it is of, `gearidae.archive.journal.RUN` or another.
    attributes : dict
        Of the run's dataset, as it began.
    scene : Scene

    Raises
    ------
    OSError
        If the disk does not give it.
    ValueError
        If it is not of such a run, or damaged at its head; a SceneError if its scene is none of this version.
    """

    kind: ClassVar[str]

    def __init__(self, path: Path, mode: Literal["r", "a"] = "r") -> None:
        self._journal = Journal(path, self.kind, mode)
        try:
            self._read()
            self._check()
        except (KeyError, TypeError, AttributeError) as error:  # sound, but of something else
            self.close()
            raise ValueError(
                f"it is not of a run of this version ({type(error).__name__}: {error})"
            ) from error
        except BaseException:
            self.close()
            raise
        self._written = time.monotonic()

    @classmethod
    def create(cls, archive: Path, attributes: Mapping[str, Any]) -> Self:
        """Begin the journal of a run, in the place of whatever is there.

        Raises
        ------
        OSError
            If the disk does not take it; nothing is left behind then.
        """
        path = journal_of(archive)
        with Journal.create(path, cls.kind, attributes=dict(attributes)) as journal:
            journal.sync()
        return cls(path, "a")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._journal.close()

    def _read(self) -> None:
        """Read the head, and the whole frames up to the first that is altered."""
        found = [*self._journal.frames()]
        self._frames = [
            frame for frame in itertools.takewhile(lambda frame: frame is not None, found) if frame
        ]
        if len(self._frames) < len(found):
            count = len(self._frames)
            log.warning("%s is damaged: what comes after its frame %d is left out", self._journal.path, count)
        self.attributes: dict[str, Any] = dict(self._journal.head.header["attributes"])
        scene = readable_scene(self.attributes["scene"])
        if scene is None:
            raise ValueError("its scene is not readable")
        self.scene = Scene.from_dict(scene)

    @abstractmethod
    def _check(self) -> None:
        """Refuse frames that are not of the scene: raise a ValueError."""


class RunJournal(JournalOfRun):
    """The journal of a single run."""

    kind = RUN

    def __init__(self, path: Path, mode: Literal["r", "a"] = "r") -> None:
        super().__init__(path, mode)
        self._checkpointed = self._written
        self._held: list[Block] = []

    def take(self, block: Block, statistics: Statistics, wall_time: float, *, last: bool = False) -> None:
        """Append a block of output.

        Parameters
        ----------
        block : Block
            From the engine.
        statistics : Statistics
            The solver's counters at the end of the block.
        wall_time : float
            Wall time in the solver until then [s].
        last : bool, optional
            Whether this is the end of the run: its state is then kept in any case.

        Raises
        ------
        OSError
            If the disk does not take it; what was there before stays as it is.
        """
        self._held.append(block)
        now = time.monotonic()
        is_due = now - self._checkpointed >= max(CHECKPOINT_SECONDS, CHECKPOINT_SHARE * wall_time)
        if block.checkpoint is not None and (last or is_due):
            header = {
                "wall_time": wall_time,
                "statistics": {counter.name: getattr(statistics, counter.name) for counter in COUNTERS},
                "balance": block.balance,
                "extremes": block.extremes and {**block.extremes, "exposures": ()},
            }
            # as words: some may be no numbers
            self._append(header, {"state": np.ascontiguousarray(block.checkpoint).view(np.uint64)})
            self._journal.sync()
            self._checkpointed = time.monotonic()
        elif now - self._written >= FRAME_SHARE * wall_time or sum(map(_size, self._held)) >= FRAME_BYTES:
            self.flush()

    def flush(self) -> None:
        """Write the blocks that wait for others; those that the disk does not take are given up.

        Raises
        ------
        OSError
            If it does not.
        """
        if self._held:
            self._append({}, {})

    def _append(self, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
        """Write the blocks that wait as one frame, and what else is there at its end."""
        held, self._held = self._held, []
        columns = {
            "samples": np.concatenate([block.rows for block in held]).T,
            **{kind.field: np.concatenate([getattr(block, kind.field) for block in held]).T for kind in ROWS},
        }
        frame = self._journal.append({"time": held[-1].time, **header}, {**columns, **arrays})
        self._frames.append(frame)
        self._written = time.monotonic()

    def go_back(self) -> Checkpoint | None:
        """Take back what came after the newest checkpoint, or after the head if there is none."""
        if self._frames and self.checkpoint is None:
            log.warning("%s has no whole checkpoint: the run begins anew", self._journal.path)
        while self._frames and "state" not in self._frames[-1].shapes:
            self._frames.pop()
        self._journal.cut((self._frames or [self._journal.head])[-1].end)
        return self.checkpoint

    @property
    def checkpoint(self) -> Checkpoint | None:
        """The newest checkpoint; None without one."""
        for number in reversed(range(len(self._frames))):
            if "state" in self._frames[number].shapes:
                return self._checkpoint(number)
        return None

    def filled(self, template: xr.Dataset) -> xr.Dataset:
        """Put the samples and rows that are there into a run's dataset, which reads them as they are used.

        Parameters
        ----------
        template : xarray.Dataset
            The run's dataset without samples and rows.
        """
        variables = {name: self._variable(str(name), template) for name in template.variables}
        times = variables["time"]
        is_long = times.size > LARGEST_IN_MEMORY
        coords = {name: variables[name] for name in template.coords if not (is_long and name == "time")}
        ds = xr.Dataset({name: variables[name] for name in template.data_vars}, coords, template.attrs)
        if is_long:
            ds = with_times(ds, times)
        ds.set_close(self.close)
        return ds

    def dataset(self, *, running: bool) -> xr.Dataset:
        """Make the dataset of what is there, and say how the run stands.

        Parameters
        ----------
        running : bool
            Whether a process is writing it.
        """
        remedy = "" if running else RESUMABLE
        nothing = Solution(np.empty(0), {}, Events.none(), Statistics(), "", "")
        ds = to_dataset(self.scene, nothing).assign_attrs(self.attributes)
        ds.attrs |= {
            "status": "running" if running else "interrupted",
            "message": f"not at its end yet{remedy}",
        }
        if (point := self.checkpoint) is not None:
            ds.attrs |= {
                "message": f"not at its end yet; checkpoint at {point.time:g} s{remedy}",
                **end_state_attributes(0.0, point.state),
                "wall_time": point.wall_time,
                **{
                    counter.name: getattr(point.statistics, counter.name)
                    for counter in COUNTERS
                    if counter.name in ds.attrs
                },
            }
            ds["reached"] = ((), point.time, ds["reached"].attrs)
            ds = ds.assign(total_variables(self.scene, [self.scene], [point]))
        return self.filled(ds)

    def _check(self) -> None:
        """Refuse frames that are not of the scene."""
        self._columns = columns_of(self.scene)
        sizes = {"samples": len(self._columns), **{kind.field: len(kind.columns) for kind in ROWS}}
        for number, frame in enumerate(self._frames, 1):
            columns = {field: shape[0] for field, shape in frame.shapes.items() if len(shape) == 2}
            if columns != sizes or len(frame.shapes.get("state", (0,))) != 1:
                raise ValueError(f"its frame {number} is not of its scene")
        if sum(self._lengths("samples")) > self.scene.run.sample_count:
            raise ValueError("it has more samples than its scene")
        _ = self.checkpoint

    def _lengths(self, field: str) -> list[int]:
        return [frame.shapes[field][1] for frame in self._frames]

    def _checkpoint(self, number: int) -> Checkpoint:
        header = self._frames[number].header
        extremes, balance = header["extremes"], header["balance"]
        counts: dict[str, Any] = {name: int(count) for name, count in header["statistics"].items()}
        statistics = Statistics(**counts)
        return Checkpoint(
            float(header["time"]),
            float(header["wall_time"]),
            statistics,
            self._journal.values(self._frames[number], "state").view(np.float64).copy(),
            sum(self._lengths(Events.field)[: number + 1]),
            extremes and Extremes(extremes),
            balance and EnergyBalance(balance),
        )

    def _variable(self, name: str, template: xr.Dataset) -> xr.Variable:
        """Variable of the run: of samples and rows, one that reads them."""
        variable = template.variables[name]
        dim = str(variable.dims[0]) if variable.dims else ""
        if dim not in _FIELDS:
            return variable
        lengths = self._lengths(_FIELDS[dim])
        if name == "time":
            values = _Along(variable.dtype, [sum(lengths)], self._times)
        else:
            values = _Along(variable.dtype, lengths, self._of_block(name, template))
        return xr.Variable(dim, LazilyIndexedArray(values), variable.attrs)

    def _of_block(self, name: str, template: xr.Dataset) -> _Part:
        """Reader of a variable's values in a block."""
        if name in self._columns:
            return partial(self._column, "samples", self._columns.index(name))
        kind = next(kind for kind in ROWS if name.startswith(f"{kind.dim}_"))
        column = name.removeprefix(f"{kind.dim}_")
        if column in kind.columns:
            return partial(self._column, kind.field, list(kind.columns).index(column))
        teeth, label = teeth_in(self.attributes), float(template[SAM_FRACTION.name])

        def derived(number: int, first: int, last: int) -> NDArray[Any]:
            rows = kind.of_table(self._journal.table(self._frames[number], kind.field).T)
            return archived(rows, teeth, label)[name][first:last]

        return derived

    def _column(self, field: str, column: int, number: int, first: int, last: int) -> NDArray[Any]:
        before = column * self._frames[number].shapes[field][1]
        return self._journal.values(self._frames[number], field, before + first, before + last)

    def _times(self, _: int, first: int, last: int) -> NDArray[np.float64]:
        run, begin = self.scene.run, float(self.attributes.get("start_time", 0.0))
        return sample_times(begin, run.duration, run.sample_count, range(first, last))


def _size(block: Block) -> int:
    return sum(table.nbytes for table in (block.rows, block.events, block.passages))


class _Along(BackendArray):
    """Values of one variable in a journal, block by block."""

    def __init__(self, dtype: np.dtype[Any], lengths: Sequence[int], part: _Part) -> None:
        self._starts, self._part = np.cumsum([0, *lengths]).tolist(), part
        self.shape, self.dtype = (self._starts[-1],), dtype

    def __getitem__(self, key: ExplicitIndexer) -> Any:
        return explicit_indexing_adapter(key, self.shape, IndexingSupport.BASIC, self._get)

    def _get(self, key: tuple[Any, ...]) -> Any:
        wanted = range(self.shape[0])[key[0]]
        if isinstance(wanted, int):
            return self._get((slice(wanted, wanted + 1),))[0]
        numbers = wanted if wanted.step > 0 else wanted[::-1]
        values = np.empty(len(numbers), self.dtype)
        done, number = 0, bisect_right(self._starts, numbers.start) - 1
        while done < len(numbers):
            start, stop = self._starts[number : number + 2]
            count = len(range(numbers[done], min(stop, numbers.stop), numbers.step))
            if count:
                part = self._part(number, numbers[done] - start, min(stop, numbers.stop) - start)
                values[done : done + count] = part[:: numbers.step]
            done, number = done + count, number + 1
        return values if wanted.step > 0 else values[::-1]
