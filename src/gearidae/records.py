"""Plain records that cross floors: blocks of output, samples, events, endings, solver statistics, energy balance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "GEAR_BOUND",
    "GEAR_COLUMNS",
    "ROLLER_BOUND",
    "ROLLER_COLUMNS",
    "Block",
    "Ending",
    "EventKind",
    "Events",
    "Flank",
    "Ledger",
    "Solution",
    "Statistics",
    "Words",
]

Words = NDArray[Any]
"""A vector of 8-byte words whose meaning only their maker knows."""

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


GEAR_BOUND = 10.0
"""Residual of a gear pair's energy ledger over rtol and throughput, at most; the largest of the tests' cases is 0.5."""
ROLLER_BOUND = 100.0
"""The same of a roller, all of whose energy goes through one impact; the largest is 30."""


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


@dataclass(slots=True)
class Statistics:
    """Solver statistics, added up over restarts; of a run under way, the driver brings them up to date as it goes.

    Attributes
    ----------
    steps, residual_evaluations, jacobian_evaluations, guard_evaluations : int
        Work counters.
    error_test_failures, convergence_failures, restarts : int
        What went wrong, or had to start again at order one.
    wall_time : float
        Wall time in the solver [s].
    backend : str
        The driver that ran: ``native`` or ``sksundae``.
    skipped : dict
        What the scene did not need, by name.
    flight_steps : int
        Steps in which no pair was in contact.
    ending : Ending
        How the driver ended.
    fold_gap : float, optional
        Gap at which the elastic contact folds, if that was the ending [m].
    method : str
        The formulas that the run began with: ``adams`` (and IDA's own where these are better), or ``bdf``, IDA's own.
    """

    steps: int = 0
    residual_evaluations: int = 0
    jacobian_evaluations: int = 0
    error_test_failures: int = 0
    convergence_failures: int = 0
    restarts: int = 0
    guard_evaluations: int = 0
    wall_time: float = 0.0
    backend: str = ""
    skipped: dict[str, int] = field(default_factory=dict)
    flight_steps: int = 0
    ending: Ending = Ending.FINISHED
    fold_gap: float | None = None
    method: str = ""

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


@dataclass(frozen=True, slots=True)
class Ledger:
    """Where the energy of a run came from and went, kept by the engine at every step [J].

    Attributes
    ----------
    time : float
        Simulated time up to which it is kept [s].
    drive_work : float
        Done by the torque on the pinion.
    radius_work : float
        Work of the changing radius: what pairs in contact store more because the radii of curvature change along the
        path of contact. The model has no force for that, so that nothing else pays for it.
    model_change : float
        By how much the stored energy jumped when the elastic contact model took over from the asperity model.
    drag_loss, dry_loss, damping_loss : float
        Taken by the drag and the dry resistance at the gear, and by the mesh's viscous damping.
    adhesion_loss : float
        Lost to adhesion: 0.93550 times pull-off load times stretch limit for each asperity that joined.
    stored_change, kinetic_change : float
        Energy stored in contacts and energy of motion at the end, less those at the start.
    throughput : float
        What the residual is measured by: the kinetic energy at the start, and all works, losses and changes of the
        kinetic energy, step by step and without regard to sign.
    """

    time: float
    drive_work: float
    radius_work: float
    model_change: float
    drag_loss: float
    dry_loss: float
    damping_loss: float
    adhesion_loss: float
    stored_change: float
    kinetic_change: float
    throughput: float

    @property
    def residual(self) -> float:
        """What does not add up [J]."""
        given = self.drive_work + self.radius_work + self.model_change
        lost = self.drag_loss + self.dry_loss + self.damping_loss + self.adhesion_loss
        return given - lost - self.stored_change - self.kinetic_change

    @property
    def imbalance(self) -> float:
        """Size of the residual over the throughput [1]; 0 of a run in which no energy has moved."""
        return abs(self.residual) / self.throughput if self.throughput > 0.0 else 0.0

    def bound(self, rtol: float, *, roller: bool) -> float:
        """What the residual stays below in a sound run [J].

        Parameters
        ----------
        rtol : float
            Relative tolerance of the run.
        roller : bool
            Whether it was a roller's.

        Returns
        -------
        float
            `ROLLER_BOUND` or `GEAR_BOUND`, times rtol, times the throughput.
        """
        return (ROLLER_BOUND if roller else GEAR_BOUND) * rtol * self.throughput


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
    checkpoint : ndarray of 8-byte words, optional
        All that it takes to go on from the end of this block; present at checkpoints and at the end. Only the engine
        knows what the words mean, and checks them when it is to go on from there.
    ledger : Ledger, optional
        The energy ledger at the end of this block; missing where a block ends in the middle of a step.
    """

    rows: NDArray[np.float64]
    events: NDArray[np.float64]
    time: float
    checkpoint: Words | None = None
    ledger: Ledger | None = None


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
    ledger : Ledger, optional
        The energy ledger; None if the run produced nothing.
    """

    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    events: Events
    statistics: Statistics
    status: str
    message: str
    reached: float | None = None
    ledger: Ledger | None = None
