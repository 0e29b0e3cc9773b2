"""What a driver hands out: blocks of output, and the solution of a whole run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.records.events import Events
from gearidae.records.statistics import Statistics
from gearidae.records.totals import EnergyBalance, Extremes

__all__ = ["Block", "Solution", "Words"]

Words = NDArray[Any]
"""A vector of 8-byte words whose meaning only their maker knows."""


@dataclass(slots=True)
class Block:
    """Output of a stretch of a run.

    Attributes
    ----------
    rows : ndarray, shape (n, columns)
        Samples that follow those of the block before, SI units.
    events : ndarray, shape (m, 6)
        Time [s], kind, pair, flank, gap rate [m/s], asperity by its place on its flank or -1.
    time : float
        Simulated time reached [s].
    checkpoint : ndarray of 8-byte words, optional
        All that it takes to go on from the end of this block; present at checkpoints and at the end. Only the engine
        knows what the words mean, and checks them when it is to go on from there.
    balance : EnergyBalance, optional
        The energy balance at the end of this block; missing where a block ends in the middle of a step.
    extremes : Extremes, optional
        Likewise.
    """

    rows: NDArray[np.float64]
    events: NDArray[np.float64]
    time: float
    checkpoint: Words | None = None
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None


@dataclass(frozen=True, slots=True)
class Solution:
    """One run as the engine leaves it.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Uniform sample times [s].
    samples : dict of str to ndarray, shape (n,)
        One array per column of `GEAR_COLUMNS` or `ROLLER_COLUMNS`, SI units.
    events : Events
    statistics : Statistics
    status : str
        ``finished``, or the named reason why the run ended early.
    message : str
        The status in a sentence; empty when finished.
    reached : float, optional
        Simulated time reached [s]; by default that of the last sample.
    balance : EnergyBalance, optional
        The energy balance; None if the run produced nothing.
    extremes : Extremes, optional
        Likewise.
    start : float
        When the run began [s].
    checkpoint : ndarray of 8-byte words, optional
        That of the end, from which another run can go on.
    """

    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    events: Events
    statistics: Statistics
    status: str
    message: str
    reached: float | None = None
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None
    start: float = 0.0
    checkpoint: Words | None = None
