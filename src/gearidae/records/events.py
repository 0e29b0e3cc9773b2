"""Events of a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class EventKind(IntEnum):
    """Kind of an event, as stored in ``event_kind``."""

    ONSET = 0
    SEPARATION = 1
    TURNING_POINT = 2
    FULL_STRETCH = 3
    MESH_ENTRY = 4
    MESH_EXIT = 5
    STICK = 6
    SLIP = 7
    FLANK_CHANGE = 8
    SCHEDULE_KNOT = 9
    ASPERITY_ONSET = 10
    ASPERITY_DETACHMENT = 11
    SLIDING_REVERSAL = 12
    FLANK_STICK = 13
    FLANK_SLIP = 14


class Flank(IntEnum):
    """Side of the tooth to which an event belongs."""

    NONE = -1
    DRIVE = 0
    COAST = 1


class EventColumn(IntEnum):
    """Column of an event in a driver's block of output, shape (n, 6)."""

    TIME = 0
    KIND = 1
    PAIR = 2
    FLANK = 3
    GAP_RATE = 4
    ASPERITY = 5


@dataclass(frozen=True, slots=True)
class Events:
    """Events in the order of time; every array has shape (n_events,).

    Attributes
    ----------
    time : ndarray of float64
        Time of the event [s].
    kind : ndarray of int8
        An `EventKind`.
    pair : ndarray of int64
        Number of the tooth pair; the pair that starts in mesh is 0.
    flank : ndarray of int8
        A `Flank`.
    gap_rate : ndarray of float64
        Rate of change of that pair's gap [m/s]; negative while it closes.
    asperity : ndarray of int64, optional
        Number of the asperity on its flank, of a population; -1, the default, where an event is of no single one.
    """

    time: NDArray[np.float64]
    kind: NDArray[np.int8]
    pair: NDArray[np.int64]
    flank: NDArray[np.int8]
    gap_rate: NDArray[np.float64]
    asperity: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        """Let events be of no single asperity where none are named."""
        if self.asperity.size == 0:
            object.__setattr__(self, "asperity", np.full(len(self.time), -1, np.int64))

    def __len__(self) -> int:
        return len(self.time)
