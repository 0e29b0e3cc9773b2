"""Plain records that cross floors: blocks of output, samples, events, endings, solver statistics, energy balance."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.columns import ELASTIC_SAMPLES, GEAR_SAMPLES, ROLLER_SAMPLES

__all__ = [
    "ELASTIC_COLUMNS",
    "GEAR_BOUND",
    "GEAR_COLUMNS",
    "QUADRATURE_BOUND",
    "ROLLER_BOUND",
    "ROLLER_COLUMNS",
    "ROUNDING_BOUND",
    "TABLE_BOUND",
    "TRAVEL_BOUND",
    "Block",
    "Ending",
    "EnergyBalance",
    "EventKind",
    "Events",
    "Extremes",
    "Flank",
    "Solution",
    "Statistics",
    "Words",
    "sampled_columns",
]

Words = NDArray[Any]
"""A vector of 8-byte words whose meaning only their maker knows."""

GEAR_COLUMNS = tuple(column.name for column in GEAR_SAMPLES)
ROLLER_COLUMNS = tuple(column.name for column in ROLLER_SAMPLES)
ELASTIC_COLUMNS = tuple(column.name for column in ELASTIC_SAMPLES)
"""What is sampled of elastic contacts besides, last."""


GEAR_BOUND = 10.0
"""Tolerances by which a gear pair's motion may put its energies out, over the energy that has moved: errors of single
steps are a fraction of the tolerance, and add up from step to step as the energies do that they are compared with."""
ROLLER_BOUND = 100.0
"""The same of a roller, all of whose energy goes through the many steps of one impact; the largest measured is 30."""
QUADRATURE_BOUND = 3.0
"""Largest error of the quadratures over their estimate, which is a mean over where an interval lies."""
TABLE_BOUND = 1e-10
"""Tolerance below which the balance gets no better: the stored energy is tabulated, and summed over the nodes of an
elastic contact, apart from the force. Over an impact of a roller they differ by 14 times this with nodes, by less than
0.1 without."""
ROUNDING_BOUND = 1e3 * sys.float_info.epsilon
"""Rounding errors in sums over the steps of a run, over the sum of their sizes."""
TRAVEL_BOUND = 10.0 * sys.float_info.epsilon
"""Rounding errors of a travel over the pitches that it is counted within."""


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
        "tooth-body deflection exceeds the limit of the asperity model; set contact.model to elastic",
    )
    TOO_DEEP = (
        "too_deep",
        "the teeth were pressed together by more than 39 roughnesses: use less speed or load, or a rougher surface",
    )
    STOPPED = ("stopped", "ended by on_block")
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
class EnergyBalance:
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
        Taken by both drags and the dry resistance at the gear, and by the mesh's viscous damping.
    adhesion_loss : float
        Lost to adhesion: 0.93550 times pull-off load times stretch limit for each asperity that joined.
    stored_change, kinetic_change : float
        Energy stored in contacts and energy of motion at the end, less those at the start.
    throughput : float
        The kinetic energy at the start, and all works, losses and changes of the kinetic energy, step by step and
        without regard to sign.
    quadrature_error : float
        Estimated errors of all quadratures, added up without regard to sign: those of the works and losses, interval
        by interval, from the size of the correction that the rule makes there.
    largest : float
        Energy that is held to a tolerance of its own even where little is exchanged: the largest kinetic energy there
        was, and the sizes of the energy stored at the start and of `model_change`.
    pitch_work : float
        Work of the reference load on both gears over one base pitch. Travels are counted within a pitch, so that their
        rounding errors cost this work times that of a double, however small the energies are; 0 of a roller.
    speed_work : float
        Kinetic energy that the speed to which the tolerance refers makes of the largest momenta: speeds are held to
        absolute tolerances, which of a gear that is very much heavier than the other are much energy. 0 of a roller.
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
    quadrature_error: float = 0.0
    largest: float = 0.0
    pitch_work: float = 0.0
    speed_work: float = 0.0

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
        r"""What the residual stays below in a sound run [J].

        .. math::

            (a \max(\mathrm{rtol}, a_t) + a_r)\, E + a_q D + a_p P

        with E the energy that has moved: `throughput`, `largest`, `adhesion_loss` and the size of `stored_change`, with
        `speed_work`; D, `quadrature_error`; and P, `pitch_work`. The
        first term is what errors of the motion leave: speeds and gaps are held to rtol, step by step, and the tables
        of force and energy agree no better than :math:`a_t`. The others are what the balance itself adds, by its
        quadratures and by rounding.

        Parameters
        ----------
        rtol : float
            Relative tolerance of the run.
        roller : bool
            Whether it was a roller's.

        Returns
        -------
        float
            With a `ROLLER_BOUND` or `GEAR_BOUND`, :math:`a_t` `TABLE_BOUND`, :math:`a_r` `ROUNDING_BOUND`, :math:`a_q`
            `QUADRATURE_BOUND` and :math:`a_p` `TRAVEL_BOUND`.
        """
        of_motion = (ROLLER_BOUND if roller else GEAR_BOUND) * max(rtol, TABLE_BOUND) + ROUNDING_BOUND
        moved = (
            self.throughput + self.largest + self.adhesion_loss + abs(self.stored_change) + self.speed_work
        )
        return of_motion * moved + QUADRATURE_BOUND * self.quadrature_error + TRAVEL_BOUND * self.pitch_work


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
    turn_backs : int
        How often the drive flank's adhesion has turned it back there; 0 unless it has come to stand.
    time_adhering : float
        How long adhesion has held it, there and elsewhere: from one turning back to the next within half a pitch, and
        to where the run stands [s].
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
    turn_backs: int
    time_adhering: float
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
