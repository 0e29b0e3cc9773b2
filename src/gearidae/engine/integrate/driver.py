"""What the two drivers share: blocks of output, counters, and the names of what can go wrong."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.model.state import PROGRESS, Floats, Model, Record
from gearidae.records import Extremes, Ledger

__all__ = [
    "BLOCK_EVENTS",
    "BLOCK_ROWS",
    "BLOCK_STEPS",
    "BOUND_EXCEEDED",
    "CHATTER",
    "CONVERGENCE_FAILURES_HIGH",
    "Block",
    "Ending",
    "Output",
    "Tally",
    "ending_of_flag",
    "fill_tally",
    "sample_time",
]

COUNTERS = tuple(name for name in PROGRESS.names or () if name != "next_sample")
"""Work counters that a run keeps."""

BLOCK_ROWS = 16_384
"""Samples in a full block."""
BLOCK_EVENTS = 16_384
"""Events in a full block."""
BLOCK_STEPS = 50_000
"""Steps after which a driver comes back to Python in any case: some tens of milliseconds."""
CHECKPOINT_STEPS = 200_000
"""Steps between checkpoints. Every run starts IDA afresh there, so that a resumed run is the same run."""


class Ending(Enum):
    """How a run ended: its status in the dataset, and a sentence."""

    FINISHED = ("finished", "")
    CHATTER = ("chatter", "event followed event without the time going on")
    STEP_UNDERFLOW = ("step_underflow", "the error test failed again and again: the steps became too small")
    NO_CONVERGENCE = ("no_convergence", "Newton's iteration did not converge, however small the step")
    TOO_ACCURATE = (
        "too_accurate",
        "the tolerance asks for more than double precision can give: raise run.rtol",
    )
    SOLVER_FAILURE = ("solver_failure", "SUNDIALS IDA gave up")
    FOLD = (
        "fold",
        "the elastic contact folds: adhesion outgrows the stiffness of the bodies, and the surfaces would jump",
    )
    DEFLECTION = (
        "deflection",
        "the bodies give way too much for the asperity model; set contact.model to elastic",
    )
    TOO_DEEP = (
        "too_deep",
        "the teeth were pressed together by more than 39 roughnesses: use less speed or load, or a rougher surface",
    )
    NOT_FINITE = ("not_finite", "the solution is no longer a finite number")

    @property
    def status(self) -> str:
        """Name, as in the dataset."""
        return self.value[0]

    @property
    def message(self) -> str:
        """A sentence; empty when finished."""
        return self.value[1]


CONVERGENCE_FAILURES_HIGH = 40
"""Failures of Newton's iteration in one step, each of which quarters it: a step out of long flight lands in a tooth."""
CHATTER, BOUND_EXCEEDED = 1, 2
"""What a driver may end a run with of its own: crowded events, a gap beyond the model's bound."""

_FLAGS = {
    0: Ending.FINISHED,
    -2: Ending.TOO_ACCURATE,
    -3: Ending.STEP_UNDERFLOW,
    -4: Ending.NO_CONVERGENCE,
    CHATTER: Ending.CHATTER,
}


def ending_of_flag(flag: int, elastic: bool = False) -> Ending:
    """Name an error flag of IDA's (negative) or one of the driver's own."""
    if flag == BOUND_EXCEEDED:
        return Ending.TOO_DEEP if elastic else Ending.DEFLECTION
    return _FLAGS.get(flag, Ending.SOLVER_FAILURE)


@dataclass(slots=True)
class Block:
    """Output of a stretch of a run.

    Attributes
    ----------
    rows : ndarray, shape (n, columns)
        Samples that follow those of the block before, SI units.
    events : ndarray, shape (m, 5)
        Time [s], kind, pair, flank, gap rate [m/s].
    time : float
        Simulated time reached [s].
    checkpoint : ndarray, optional
        All that it takes to go on from the end of this block; present at checkpoints and at the end.
    ledger : Ledger, optional
        The energy ledger at the end of this block; missing where a block ends in the middle of a step.
    extremes : Extremes, optional
        Likewise.
    """

    rows: Floats
    events: Floats
    time: float
    checkpoint: Floats | None = None
    ledger: Ledger | None = None
    extremes: Extremes | None = None


@dataclass(slots=True)
class Tally:
    """Counters of a run and how it ended, filled in by the driver as it goes."""

    steps: int = 0
    residual_evaluations: int = 0
    jacobian_evaluations: int = 0
    error_test_failures: int = 0
    convergence_failures: int = 0
    restarts: int = 0
    guard_evaluations: int = 0
    flight_steps: int = 0
    ending: Ending = field(default=Ending.FINISHED)
    fold_gap: float | None = None

    def note_fold(self, gap: float) -> None:
        """Call the ending a fold if it was one; NaN if not, else the gap at which the contact folds [m]."""
        if not math.isnan(gap):
            self.ending, self.fold_gap = Ending.FOLD, float(gap)

    @property
    def message(self) -> str:
        """The ending in a sentence; empty when finished."""
        if self.fold_gap is not None:
            return f"{self.ending.message}, at a gap of {self.fold_gap:.6g} m"
        return self.ending.message


def fill_tally(tally: Tally, progress: Record) -> None:
    """Take a driver's counters over."""
    for name in COUNTERS:
        setattr(tally, name, int(progress[name]))


class Output(NamedTuple):
    """Samples and events of a block, before it is handed out.

    Attributes
    ----------
    rows : ndarray, shape (BLOCK_ROWS, columns)
    events : ndarray, shape (BLOCK_EVENTS, 5)
    """

    rows: Floats
    events: Floats

    @classmethod
    def empty(cls, columns: int) -> Output:
        """Room for a block."""
        return cls(np.empty((BLOCK_ROWS, columns)), np.empty((BLOCK_EVENTS, 5)))

    def block(
        self,
        m: Model,
        time: float,
        checkpoint: Floats | None = None,
        kept: tuple[Ledger | None, Extremes | None] = (None, None),
    ) -> Block:
        """Hand out what there is, and begin anew.

        Parameters
        ----------
        m : Model
        time : float
            Reached, over tau.
        checkpoint
            See `Block`.
        kept : tuple
            Ledger and extremes, likewise; see `gearidae.engine.model.problem.Problem.kept`.
        """
        driver = m.work.driver
        block = Block(
            self.rows[: driver.rows].copy(),
            self.events[: driver.events].copy(),
            time * float(m.scene.time_unit),
            checkpoint,
            *kept,
        )
        driver.rows = driver.events = 0
        return block


@compiled
def sample_time(index: int, total: int, end: float) -> float:
    """Scaled time of a sample: the first at 0, the last at the end itself, none beyond."""
    if index >= total:
        return math.inf
    return end if index == total - 1 else index * (end / (total - 1))
