"""What the two drivers share: blocks of output, counters, and the names of what can go wrong."""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.records import Block, Ending, Statistics

__all__ = [
    "BLOCK_EVENTS",
    "BLOCK_ROWS",
    "BLOCK_STEPS",
    "CODES",
    "CONVERGENCE_FAILURES_HIGH",
    "Block",
    "Ending",
    "Tally",
    "ending_of_flag",
    "sample_time",
]

BLOCK_ROWS = 16_384
"""Samples in a full block."""
BLOCK_EVENTS = 16_384
"""Events in a full block."""
BLOCK_STEPS = 50_000
"""Steps after which a driver comes back to Python in any case: some tens of milliseconds."""
CHECKPOINT_STEPS = 200_000
"""Steps between checkpoints. Every run starts IDA afresh there, so that a resumed run is the same run."""


CONVERGENCE_FAILURES_HIGH = 40
"""Failures of Newton's iteration in one step, each of which quarters it: a step out of long flight lands in a tooth."""
CODES = (1, 2)
"""What a driver may end a run with of its own: crowded events, a gap beyond the model's bound."""

_FLAGS = {
    0: Ending.FINISHED,
    -2: Ending.TOO_ACCURATE,
    -3: Ending.STEP_UNDERFLOW,
    -4: Ending.NO_CONVERGENCE,
    1: Ending.CHATTER,
}


def ending_of_flag(flag: int, elastic: bool = False) -> Ending:
    """Name an error flag of IDA's (negative) or one of `CODES`."""
    if flag == CODES[1]:
        return Ending.TOO_DEEP if elastic else Ending.DEFLECTION
    return _FLAGS.get(flag, Ending.SOLVER_FAILURE)


Tally = Statistics
"""Solver statistics of a run under way."""


@compiled
def sample_time(index: int, total: int, end: float) -> float:
    """Scaled time of a sample: the first at 0, the last at the end itself, none beyond."""
    if index >= total:
        return math.inf
    return end if index == total - 1 else index * (end / (total - 1))
