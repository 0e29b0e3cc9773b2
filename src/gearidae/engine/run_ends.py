"""How a run ended, and what may end it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.records import Block, EnergyBalance, Extremes, Statistics


@dataclass(frozen=True, slots=True)
class Ended:
    """How a run ended.

    Attributes
    ----------
    status : str
        ``finished``, ``interrupted`` (by Ctrl-C), or the named reason why the run ended early.
    message : str
        The status in a sentence; empty when finished.
    end_time : float
        Simulated time at the end [s].
    balance : EnergyBalance, optional
        The latest energy balance; None if the run did not begin.
    extremes : Extremes, optional
        The latest extremes; None if the run did not begin.
    checkpoint : ndarray, optional
        Checkpoint at the end; None where the run ended between two.
    """

    statistics: Statistics
    status: str
    message: str
    end_time: float
    balance: EnergyBalance | None = None
    extremes: Extremes | None = None
    checkpoint: NDArray[np.float64] | None = None


OnBlock: TypeAlias = Callable[[Block], object]
"""Called with every block of output; a return value of True ends the run."""
