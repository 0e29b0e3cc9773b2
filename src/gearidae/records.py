"""Plain records that the engine hands up: samples, events and what the solver did."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

__all__ = ["GEAR_COLUMNS", "ROLLER_COLUMNS", "EventKind", "Events", "Flank", "Solution", "Statistics"]

GEAR_COLUMNS = (
    "gear_speed",
    "pinion_speed",
    "gear_angle",
    "transmission_error",
    "mesh_force",
    "gear_contact_torque",
    "drive_gap",
    "coast_gap",
    "pairs_in_contact",
)
ROLLER_COLUMNS = ("height", "speed", "force")


class EventKind(IntEnum):
    """What happened, as stored in ``event_kind``."""

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


class Flank(IntEnum):
    """Which side of the tooth an event belongs to."""

    NONE = -1
    DRIVE = 0
    COAST = 1


@dataclass(frozen=True, slots=True)
class Events:
    """Events in the order they happened; every array has shape (n_events,).

    Attributes
    ----------
    time : ndarray of float64
        Time of the event [s].
    kind : ndarray of int8
        An `EventKind`.
    pair : ndarray of int64
        Number of the tooth pair, counted from the one that starts in mesh as 0.
    flank : ndarray of int8
        A `Flank`.
    gap_rate : ndarray of float64
        Rate of change of that pair's gap [m/s]; negative while it closes.
    """

    time: NDArray[np.float64]
    kind: NDArray[np.int8]
    pair: NDArray[np.int64]
    flank: NDArray[np.int8]
    gap_rate: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, slots=True)
class Statistics:
    """What the solver did, added up over restarts.

    Attributes
    ----------
    steps, residual_evaluations, jacobian_evaluations, guard_evaluations : int
        Work counters.
    error_test_failures, convergence_failures, restarts : int
        What went wrong, or had to start again at order one.
    skipped : dict
        What the scene did not need, by name.
    wall_time : float
        Wall time in the solver [s].
    backend : str
        The driver that ran: ``native`` or ``sksundae``.
    """

    steps: int
    residual_evaluations: int
    jacobian_evaluations: int
    error_test_failures: int
    convergence_failures: int
    restarts: int
    guard_evaluations: int
    wall_time: float
    backend: str
    skipped: dict[str, int] = field(default_factory=dict)


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
    """

    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    events: Events
    statistics: Statistics
    status: str
    message: str
    reached: float | None = None
