"""What a run adds up to: its energy balance and its extremes, which the solver keeps at its own steps."""

from __future__ import annotations

import math
import sys
from array import array
from dataclasses import dataclass, field

__all__ = [
    "GEAR_BOUND",
    "QUADRATURE_BOUND",
    "ROLLER_BOUND",
    "ROUNDING_BOUND",
    "TABLE_BOUND",
    "TORQUE_BOUND",
    "TRAVEL_BOUND",
    "EnergyBalance",
    "Extremes",
]

GEAR_BOUND = 10.0
"""Tolerances by which a gear pair's motion may put its energies out, over the energy that has moved: errors of single
steps are a fraction of the tolerance, and add up from step to step as the energies do that they are compared with."""
TORQUE_BOUND = 0.1
"""Tolerances by which torques that depend on the speed may put the balance out, over `EnergyBalance.torque_work`:
errors of the speed have either sign. The largest measured is a seventh of this."""
ROLLER_BOUND = 100.0
"""The same of a roller, all of whose energy goes through the many steps of one impact; the largest measured is 30."""
QUADRATURE_BOUND = 3.0
"""Largest error of the quadratures over their estimate, which is a mean over where an interval lies."""
TABLE_BOUND = 1e-10
"""Tolerance below which the balance gets no better: the stored energy is tabulated apart from the force. Over an impact
of a roller at a tolerance of 1e-12 they differ by a seventh of this."""
ROUNDING_BOUND = 1e3 * sys.float_info.epsilon
"""Rounding errors in sums over the steps of a run, over the sum of their sizes."""
TRAVEL_BOUND = 10.0 * sys.float_info.epsilon
"""Rounding errors of a travel over the pitches that it is counted within."""


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
    torque_work : float
        Work along the way that torques which depend on the speed do on a difference of that speed. A drive that holds
        its speed stiffly turns errors of the speed into work. 0 of a roller.
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
    torque_work: float = 0.0

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

            (a \max(\mathrm{rtol}, a_t) + a_r)\, E + a_w\,\mathrm{rtol}\, W + a_q D + a_p P

        with E the energy that has moved: `throughput`, `largest`, `adhesion_loss` and the size of `stored_change`, with
        `speed_work`; W, `torque_work`; D, `quadrature_error`; and P, `pitch_work`. The
        first two terms are what errors of the motion leave: speeds and gaps are held to rtol, step by step, and the
        tables of force and energy agree no better than :math:`a_t`. The others are what the balance itself adds, by its
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
            With a `ROLLER_BOUND` or `GEAR_BOUND`, :math:`a_t` `TABLE_BOUND`, :math:`a_r` `ROUNDING_BOUND`, :math:`a_w`
            `TORQUE_BOUND`, :math:`a_q` `QUADRATURE_BOUND` and :math:`a_p` `TRAVEL_BOUND`.
        """
        of_motion = (ROLLER_BOUND if roller else GEAR_BOUND) * max(rtol, TABLE_BOUND) + ROUNDING_BOUND
        moved = (
            self.throughput + self.largest + self.adhesion_loss + abs(self.stored_change) + self.speed_work
        )
        of_motion_and_torque = of_motion * moved + TORQUE_BOUND * rtol * self.torque_work
        return (
            of_motion_and_torque + QUADRATURE_BOUND * self.quadrature_error + TRAVEL_BOUND * self.pitch_work
        )


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
    asperity_onsets, asperity_detachments : int
        Asperities of a population that have joined, and let go.
    exposures : array of float
        What the flanks have been exposed to, in the order flank, tooth of the pinion, quantity, place: for each
        material asperities joined over those of a unit contact length, for each the energy they lost [J], sliding work
        [J], largest force over contact length [N]. Empty if ``run.exposures`` is 0.
    """

    min_gear_speed: float = math.nan
    max_gear_speed: float = math.nan
    settled_gear_speed: float = math.nan
    settled_spread: float = math.nan
    speed_fall: float = math.nan
    speed_rise: float = math.nan
    late_gear_speed: float = math.nan
    late_spread: float = math.nan
    last_min_gear_speed: float = math.nan
    reversals: int = 0
    stick_time: float = math.nan
    stick_exits: int = 0
    turned_back: float = math.nan
    turn_backs: int = 0
    time_adhering: float = math.nan
    mesh_exits: int = 0
    largest_mesh_force: float = math.nan
    largest_mesh_force_time: float = math.nan
    smallest_mesh_force: float = math.nan
    smallest_mesh_force_time: float = math.nan
    smallest_separation: float = math.nan
    final_speed: float = math.nan
    asperity_onsets: int = 0
    asperity_detachments: int = 0
    exposures: array[float] = field(default_factory=lambda: array("d"))
