"""Where a run begins, how it ended, and what may end it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.continuing import Origin
from gearidae.records import Block, EnergyBalance, Extremes, Statistics

__all__ = ["Ended", "OnBlock", "Start"]


@dataclass(frozen=True, slots=True)
class Start:
    """Where a run begins: at the beginning, or at a checkpoint of an earlier run.

    Attributes
    ----------
    checkpoint : ndarray, optional
        From a `Block` of a run of the same scene by the same backend.
    origin : Origin, optional
        The end of another run that this one goes on from; without a checkpoint, it begins there.
    statistics : Statistics
        The solver's counters there.
    time, wall_time : float
        Simulated time and wall time until there [s].
    events : int
        Number of events until there.
    """

    checkpoint: NDArray[np.float64] | None = None
    origin: Origin | None = None
    statistics: Statistics = field(default_factory=Statistics)
    time: float = 0.0
    wall_time: float = 0.0
    events: int = 0


@dataclass(frozen=True, slots=True)
class Ended:
    """How a run ended.

    Attributes
    ----------
    statistics : Statistics
    status : str
        ``finished``, ``interrupted`` (by Ctrl-C), or the named reason why the run ended early.
    message : str
        The status in a sentence; empty when finished.
    reached : float
        Simulated time reached [s].
    balance : EnergyBalance, optional
        The latest energy balance; None if the run did not begin.
    extremes : Extremes, optional
        The latest extremes, likewise.
    checkpoint : ndarray, optional
        That of the end; None where the run ended between two.
    """

    statistics: Statistics
    status: str
    message: str
    reached: float
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None
    checkpoint: NDArray[np.float64] | None = None


OnBlock: TypeAlias = Callable[[Block], object]
"""What is told every block of output, and ends the run by returning True."""
