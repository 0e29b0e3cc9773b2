"""Plain records that the engine hands up: samples, events and what the solver did."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ELASTIC_COLUMNS",
    "GEAR_BOUND",
    "GEAR_COLUMNS",
    "ROLLER_BOUND",
    "ROLLER_COLUMNS",
    "EventKind",
    "Events",
    "Extremes",
    "Flank",
    "Ledger",
    "Solution",
    "Statistics",
    "sampled_columns",
]

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
ELASTIC_COLUMNS = ("min_separation",)
"""What is sampled of elastic contacts besides, last."""


GEAR_BOUND = 10.0
"""Residual of a gear pair's energy ledger over rtol and throughput, at most; the largest of the tests' cases is 0.5."""
ROLLER_BOUND = 100.0
"""The same of a roller, all of whose energy goes through one impact; the largest is 30."""


def sampled_columns(*, roller: bool, elastic: bool) -> tuple[str, ...]:
    """Names of what is sampled of a scene of gears or a roller, whose contact model is `elastic` or not."""
    return (ROLLER_COLUMNS if roller else GEAR_COLUMNS) + (ELASTIC_COLUMNS if elastic else ())


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


@dataclass(frozen=True, slots=True)
class Extremes:
    """What a run has been through, kept by the engine at its own steps and at extrema located between them.

    Nothing here depends on how a run is sampled. What a run has no number for is NaN: the gear's speeds of a roller,
    a part of the run that has not been reached, the time at which a gear sticks that does not.

    Attributes
    ----------
    min_gear_speed, max_gear_speed : float
        Extremes of the gear's speed [rad/s].
    settled_gear_speed : float
        Its mean once the start-up, the first twentieth of the run, is over [rad/s].
    settled_spread : float
        Its largest less its smallest from then on [rad/s].
    speed_fall, speed_rise : float
        How far it fell below what it had reached since, and rose above what it had fallen to [rad/s].
    late_gear_speed, late_spread : float
        Mean and spread over the second half of the run [rad/s].
    last_min_gear_speed : float
        Smallest in the last twentieth of the run [rad/s].
    reversals : int
        How often the gear's speed has fallen to zero.
    stick_time : float
        When its speed first fell to zero where it still is, to half a pitch [s]; 0 if it never rose above zero.
    stick_exits : int
        Mesh exits until then; all of them if it has not come to stand.
    turned_back : float
        How far it has been turned back since, in pitches; 0 if it has not.
    mesh_exits : int
        Pairs of the drive flank that have left the path of contact.
    largest_mesh_force, smallest_mesh_force : float
        Extremes of the force along the line of action, or on a roller [N].
    largest_mesh_force_time, smallest_mesh_force_time : float
        When [s].
    smallest_separation : float
        Smallest distance of the flanks [m], of elastic ones with their deflection.
    final_speed : float
        Speed of the gear [rad/s] or the roller [m/s] where the run stands.
    """

    min_gear_speed: float
    max_gear_speed: float
    settled_gear_speed: float
    settled_spread: float
    speed_fall: float
    speed_rise: float
    late_gear_speed: float
    late_spread: float
    last_min_gear_speed: float
    reversals: int
    stick_time: float
    stick_exits: int
    turned_back: float
    mesh_exits: int
    largest_mesh_force: float
    largest_mesh_force_time: float
    smallest_mesh_force: float
    smallest_mesh_force_time: float
    smallest_separation: float
    final_speed: float


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
    extremes : Extremes, optional
        Likewise.
    """

    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    events: Events
    statistics: Statistics
    status: str
    message: str
    reached: float | None = None
    ledger: Ledger | None = None
    extremes: Extremes | None = None
