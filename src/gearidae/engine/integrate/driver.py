"""What the two drivers share: blocks of output, counters, and the names of what can go wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.engine.model.state import Floats, Model, Record
from gearidae.engine.observers import impacts as impact_rows
from gearidae.engine.observers import passages as passage_rows
from gearidae.records import COUNTERS, Block, Ending, EnergyBalance, Extremes, Impacts, Passages, Statistics

if TYPE_CHECKING:
    from gearidae.engine.setup.problem import Problem

__all__ = [
    "BLOCK_EVENTS",
    "BLOCK_IMPACTS",
    "BLOCK_PASSAGES",
    "BLOCK_ROWS",
    "BLOCK_SECONDS",
    "BLOCK_STEPS",
    "BOUND_EXCEEDED",
    "CHATTER",
    "CONVERGENCE_FAILURES_HIGH",
    "LAW_CHATTER",
    "LIGHT",
    "MANY_EVENTS",
    "MODEL_CHANGES",
    "Block",
    "Ending",
    "Output",
    "SampleReader",
    "ending_of_flag",
    "sample_time",
    "update_statistics",
]

BLOCK_ROWS = 16_384
"""Samples in a full block."""
BLOCK_EVENTS = 16_384
"""Events in a full block."""
BLOCK_PASSAGES = 1024
"""Passages in a full block."""
BLOCK_IMPACTS = 4096
"""Impacts in a full block."""
BLOCK_STEPS = 50_000
"""Steps after which a driver comes back to Python in any case."""
BLOCK_SECONDS = 0.2
"""Wall time after which it should: progress and Ctrl-C are handled between blocks."""
CHECKPOINT_STEPS = 200_000
"""Steps between checkpoints. Every run restarts IDA there, so that a resumed run is equal to an uninterrupted one."""


CONVERGENCE_FAILURES_HIGH = 40
"""Failures of Newton's iteration in one step, each of which quarters it: a step out of long flight lands in a tooth."""
CHATTER, BOUND_EXCEEDED, LIGHT, MANY_EVENTS, LAW_CHATTER = 1, 2, 3, 4, 5
"""What a driver may end a run with of its own: crowded events, a gap beyond the model's bound, contacts of elastic
bodies that have been light for long, more events of asperities than can be followed, a law that
switches in every step."""
MODEL_CHANGES: Final = (BOUND_EXCEEDED, LIGHT)
"""Those from which a run goes on, with another contact model."""

_FLAGS = {
    0: Ending.FINISHED,
    -2: Ending.TOO_ACCURATE,
    -3: Ending.STEP_UNDERFLOW,
    -4: Ending.NO_CONVERGENCE,
    CHATTER: Ending.CHATTER,
    MANY_EVENTS: Ending.MANY_EVENTS,
    LAW_CHATTER: Ending.LAW_CHATTER,
    LIGHT: Ending.LIGHT,
}


def ending_of_flag(flag: int, alone: bool = False) -> Ending:
    """Name an error flag of IDA's (negative) or one of the driver's own; `alone` if no other contact model goes on."""
    if flag == BOUND_EXCEEDED:
        return Ending.TOO_DEEP if alone else Ending.DEFLECTION
    return _FLAGS.get(flag, Ending.SOLVER_FAILURE)


def update_statistics(statistics: Statistics, progress: Record) -> None:
    """Take a driver's counters over."""
    for counter in COUNTERS:
        setattr(statistics, counter.name, int(progress[counter.name]))


class SampleReader(Protocol):
    """What reads the model at some samples, between the last accepted time and the next."""

    @property
    def sample(self) -> int:
        """Coming sample to read at; below zero where there is none any more."""

    def read(self, problem: Problem, t: float, state: Callable[[], Floats]) -> None:
        """Read at the coming sample; the model stays as it is.

        Parameters
        ----------
        t : float
            Time of the sample over tau.
        state : callable
            Returns the scaled state there.
        """


class Output(NamedTuple):
    """Samples and rows of a block, before it is yielded.

    Attributes
    ----------
    rows : ndarray, shape (BLOCK_ROWS, columns)
    events : ndarray, shape (BLOCK_EVENTS, EVENT_NUMBERS)
    passages : ndarray, shape (BLOCK_PASSAGES, PASSAGE_NUMBERS)
        Scaled.
    impacts : ndarray, shape (BLOCK_IMPACTS, IMPACT_NUMBERS)
        Scaled.
    """

    rows: Floats
    events: Floats
    passages: Floats
    impacts: Floats

    @classmethod
    @contextmanager
    def lent(cls, columns: int) -> Iterator[Output]:
        """Room for the blocks of a run, which later runs use again: new memory costs more than a millisecond."""
        sizes = (columns, BLOCK_ROWS, BLOCK_EVENTS, BLOCK_PASSAGES, BLOCK_IMPACTS)
        rooms = _rooms.setdefault(sizes, [])
        try:
            room = rooms.pop()
        except IndexError:  # others run at the same time, or none has run so far
            room = cls.empty(columns)
        try:
            yield room
        finally:
            rooms.append(room)

    @classmethod
    def empty(cls, columns: int) -> Output:
        """Room for a block."""
        return cls(
            np.empty((BLOCK_ROWS, columns)),
            np.empty((BLOCK_EVENTS, EVENT_NUMBERS)),
            np.empty((BLOCK_PASSAGES, passage_rows.PASSAGE_NUMBERS)),
            np.empty((BLOCK_IMPACTS, impact_rows.IMPACT_NUMBERS)),
        )

    def before(self, m: Model, sample: int) -> Output:
        """Room for what comes before a sample, if there is one to come: the step that has it waits."""
        if sample < 0:
            return self
        count = int(m.work.driver.rows) + max(sample - int(m.state.progress.next_sample), 0)
        return self._replace(rows=self.rows[:count])

    def block(
        self,
        m: Model,
        time: float,
        checkpoint: Floats | None = None,
        kept: tuple[EnergyBalance | None, Extremes | None] = (None, None),
    ) -> Block:
        """Return the data so far as a block, and begin a new one.

        Parameters
        ----------
        time : float
            Reached, over tau.
        checkpoint
            See `Block`.
        kept : tuple
            EnergyBalance and extremes, from `gearidae.engine.setup.problem.Problem.kept`.
        """
        driver = m.work.driver
        rows, events, passages = int(driver.rows), int(driver.events), int(driver.passages)
        impacts = self.impacts[: int(driver.impacts)]
        block = Block(
            self.rows[:rows].copy(),
            self.events[:events].copy(),
            time * float(m.scene.time_unit),
            checkpoint,
            *kept,
            passages=self.passages[:passages] * passage_rows.units(m.scene)
            if passages
            else Passages.no_table(),
            impacts=impacts * impact_rows.units(m.scene) if len(impacts) else Impacts.no_table(),
        )
        driver.rows = driver.events = driver.passages = driver.impacts = 0
        return block


_rooms: Final[dict[tuple[int, ...], list[Output]]] = {}
"""Rooms that no run uses now, by their sizes."""


@compiled
def sample_time(m: Model, index: int) -> float:
    """Scaled time of a sample: the first at the start, the last at the end itself, none beyond."""
    total = m.scene.samples
    if index >= total:
        return math.inf
    if index == 0:
        return float(m.scene.start)
    if index == total - 1:
        return float(m.scene.end)
    return float((m.scene.first_sample + index) * ((m.scene.end - m.scene.start) / (total - 1)))
