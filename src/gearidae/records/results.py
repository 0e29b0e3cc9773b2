"""Output of a driver: blocks, and the solution of a whole run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.records.energy import EnergyBalance
from gearidae.records.events import Events
from gearidae.records.extremes import Extremes
from gearidae.records.impacts import Impacts
from gearidae.records.passages import Passages
from gearidae.records.row_table import Rows
from gearidae.records.statistics import Statistics

Words = NDArray[Any]
"""A vector of 8-byte words, whose layout only the engine knows."""


@dataclass(slots=True)
class Block:
    """Output of a part of a run.

    Attributes
    ----------
    rows : ndarray, shape (n, columns)
        Samples after those of the previous block, SI units.
    events : ndarray, shape (m, columns)
        Table of `Events`, asperities by their indices on their flanks.
    time : float
        Simulated time reached [s].
    checkpoint : ndarray of 8-byte words, optional
        State at the end of this block, from which a run can continue; present at checkpoints and at the end. Only the
        engine knows the layout of the words, and checks them before it continues.
    balance : EnergyBalance, optional
        The energy balance at the end of this block; missing if the block ends in the middle of a step.
    extremes : Extremes, optional
        The extremes at the end of this block; missing under the same condition.
    passages : ndarray, shape (k, columns)
        Table of `Passages`.
    impacts : ndarray, shape (l, columns)
        Table of `Impacts`.
    """

    rows: NDArray[np.float64]
    events: NDArray[np.float64]
    time: float
    checkpoint: Words | None = None
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None
    passages: NDArray[np.float64] = field(default_factory=Passages.no_table)
    impacts: NDArray[np.float64] = field(default_factory=Impacts.no_table)


ROWS: Final[tuple[type[Rows], ...]] = (Events, Passages, Impacts)
"""Kinds of rows that a run leaves, each a field of a block and of a solution."""


@dataclass(frozen=True, slots=True)
class Solution:
    """Result of one run.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Uniform sample times [s].
    samples : dict of str to ndarray, shape (n,)
        One array per column of `GEAR_COLUMNS` or `ROLLER_COLUMNS`, SI units.
    status : str
        ``finished``, or the named reason why the run ended early.
    message : str
        The status in a sentence; empty when finished.
    reached : float, optional
        Simulated time reached [s]; by default that of the last sample.
    balance : EnergyBalance, optional
        The energy balance; None for a run without output.
    extremes : Extremes, optional
        The extremes; None for a run without output.
    start : float
        Start time of the run [s].
    checkpoint : ndarray of 8-byte words, optional
        State at the end, from which another run can continue.
    passages : Passages
    impacts : Impacts
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
    passages: Passages = field(default_factory=Passages.none)
    impacts: Impacts = field(default_factory=Impacts.none)
