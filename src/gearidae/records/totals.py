"""Totals of a run: its energy balance and its extremes, which the solver keeps at its own steps."""

from __future__ import annotations

import math
import sys
from array import array
from dataclasses import dataclass, field

RUN_PARTS = (0.05, 0.5, 0.95)
"""Where the parts of a run begin over which speeds are judged, as shares of it: start-up, half, last twentieth."""
GEAR_BOUND = 10.0
"""Largest error of a gear pair's energies because of errors of the motion, in tolerances of the energy exchanged: the
error of a step is a fraction of the tolerance, and errors and energies add up over the steps alike."""
TORQUE_BOUND = 0.1
"""Largest error of the balance because of torques that depend on the speed, in tolerances of
`EnergyBalance.torque_work`: errors of the speed have either sign. The largest measured is a seventh of this."""
ROLLER_BOUND = 100.0
"""`GEAR_BOUND` of a roller, whose whole energy goes through the many steps of one impact; the largest measured is
30."""
QUADRATURE_BOUND = 3.0
"""Largest error of the quadratures over their estimate, which is a mean over the positions of an interval."""
TABLE_BOUND = 1e-10
"""Smallest tolerance that improves the balance: stored energy and force have separate tables. Over an impact
of a roller at a tolerance of 1e-12 they differ by a seventh of this."""
ROUNDING_BOUND = 1e3 * sys.float_info.epsilon
"""Rounding errors in sums over the steps of a run, over the sum of the magnitudes."""
TRAVEL_BOUND = 10.0 * sys.float_info.epsilon
"""Rounding errors of a travel over the pitch within which it is counted."""


@dataclass(frozen=True, slots=True)
class EnergyBalance:
    """Energy balance of a run, updated by the engine at every step [J].

    Attributes
    ----------
    time : float
        Simulated time up to which the balance is kept [s].
    drive_work : float
        Work of the torque on the pinion.
    radius_work : float
        Increase of the energy stored in contacts because the radii of curvature change along the
        path of contact. The model has no force that does this work.
    model_change : float
        Jump of the stored energy at the change from the asperity model to the elastic contact model.
    drag_loss, dry_loss, damping_loss : float
        Losses by both drags and by the dry resistance at the gear, and by the viscous damping of the mesh.
    adhesion_loss : float
        Loss by adhesion: 0.93550 times pull-off load times stretch limit for each asperity that joined.
    stored_change, kinetic_change : float
        Energy stored in contacts and kinetic energy, at the end minus at the start.
    throughput : float
        The kinetic energy at the start, plus the magnitudes of all works, losses and changes of the kinetic energy,
        step by step.
    quadrature_error : float
        Sum of the magnitudes of the estimated errors of all quadratures of works and losses, interval
        by interval, from the size of the correction of the rule.
    largest : float
        Energy with a tolerance of its own even if little is exchanged: the largest kinetic energy,
        and the magnitudes of the energy stored at the start and of `model_change`.
    pitch_work : float
        Work of the reference load on both gears over one base pitch. Travels are counted within a pitch, so that their
        rounding errors are those of a number of this size, however small the energies are; 0 for a roller.
    speed_work : float
        Kinetic energy of the speed to which the tolerance refers, with the largest momenta: speeds have
        absolute tolerances, which are a large energy for a gear that is much heavier than the other. 0 for a roller.
    torque_work : float
        Work of speed-dependent torques for a difference of the speed. A drive that holds
        its speed stiffly turns errors of the speed into work. 0 for a roller.
    drive_friction_loss, coast_friction_loss : float
        Losses by the friction of either flank.
    pinion_hub_loss, gear_hub_loss : float
        Losses by the friction of either hub.
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
    drive_friction_loss: float = 0.0
    coast_friction_loss: float = 0.0
    pinion_hub_loss: float = 0.0
    gear_hub_loss: float = 0.0

    @property
    def friction_loss(self) -> float:
        """Losses by friction of flanks and hubs [J]."""
        flanks = self.drive_friction_loss + self.coast_friction_loss
        return flanks + self.pinion_hub_loss + self.gear_hub_loss

    @property
    def residual(self) -> float:
        """Works minus losses and changes of the energies [J]."""
        given = self.drive_work + self.radius_work + self.model_change
        lost = self.drag_loss + self.dry_loss + self.damping_loss + self.adhesion_loss + self.friction_loss
        return given - lost - self.stored_change - self.kinetic_change

    @property
    def imbalance(self) -> float:
        """Magnitude of the residual over the throughput [1]; 0 for a run without exchange of energy."""
        return abs(self.residual) / self.throughput if self.throughput > 0.0 else 0.0

    def bound(self, rtol: float, *, roller: bool) -> float:
        r"""Bound of the residual of a correct run [J].

        .. math::

            (a \max(\mathrm{rtol}, a_t) + a_r)\, E + a_w\,\mathrm{rtol}\, W + a_q D + a_p P

        with E the energy exchanged: `throughput`, `largest`, `adhesion_loss`, the magnitude of `stored_change` and
        `speed_work`; W, `torque_work`; D, `quadrature_error`; and P, `pitch_work`. The
        first two terms are for errors of the motion: speeds and gaps have the tolerance rtol in each step, and the
        tables of force and energy agree no better than :math:`a_t`. The others are for the quadratures of the balance
        and for rounding.

        Parameters
        ----------
        rtol : float
            Relative tolerance of the run.
        roller : bool
            Whether the scene is a roller.

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
    """Extremes of a run, updated by the engine at its own steps and at extrema located between them.

    They do not depend on the samples. A missing number is NaN: the gear's speeds for a roller,
    a part of the run that has not been reached, the sticking time of a gear that does not stick.

    Attributes
    ----------
    min_gear_speed, max_gear_speed : float
        Extremes of the gear's speed [rad/s].
    settled_gear_speed : float
        Mean of the gear's speed after the start-up, the first twentieth of the run [rad/s].
    settled_spread : float
        Largest minus smallest speed after the start-up [rad/s].
    speed_fall, speed_rise : float
        Largest fall from an earlier maximum, and largest rise from an earlier minimum, after the start-up [rad/s].
    late_gear_speed, late_spread : float
        Mean and spread over the second half of the run [rad/s].
    last_min_gear_speed : float
        Smallest speed in the last twentieth of the run [rad/s].
    reversals : int
        Number of falls of the gear's speed to zero.
    stick_time : float
        First zero of the speed from which the gear stands until the end [s], see `gearidae.records.standing`; 0 of a
        gear that has never left half a pitch from a start at rest. NaN if it does not stand.
    stick_exits : int
        Mesh exits until the gear came to stand, or went back; all of them if it did neither.
    advance, free_advance : float
        Farthest distances of the gear and of free gears from there [pitches]; of a gear that does not stand, from the
        first zero within half a pitch of all that came later. NaN without one.
    driven_time : float
        Time since then for which the drive exceeded the dry load [s].
    held_torque : float
        Largest torque of the drive at the gear beyond the dry load since then [N m].
    holding : int
        What holds a gear that stands, see `gearidae.records.standing.Holding`.
    turned_back, free_turned_back : float
        Pitches by which the gear, and free gears, have turned back, if its last movement of more than half a pitch was
        back, and this throughout the last period of the slowest harmonic.
    back_time : float
        Zero of the speed from which the gear has gone back [s]; NaN if it has not.
    standstills : int
        Number of standstills, with that at the end.
    standing_time, standing_rest_time : float
        Time of all standstills, and that for which dry friction held all of the gear there [s].
    start_time : float
        End of the last standstill that has ended [s]; 0 without one, NaN if the gear has never left half a pitch.
    breakaway_torque : float
        Torque of the drive on the pinion then [N m].
    followed_time : float
        Time since the start of the chain of runs up to which all this holds [s].
    standstill_list : array of float
        Standstills in the order of time, `gearidae.records.standing.COLUMNS` of each; of more than 64 the longest.
    turn_backs : int
        Number of times that adhesion of the drive flank has turned the gear back there, since dry resistance last held
        it; 0 unless it has stuck.
    time_adhering : float
        Time for which adhesion has held the gear, there and elsewhere: from one turning back to the next within half a
        pitch, and to the end of the run [s].
    mesh_exits : int
        Pairs of the drive flank that have left the path of contact.
    largest_mesh_force, smallest_mesh_force : float
        Extremes of the force along the line of action, or on a roller [N].
    largest_mesh_force_time, smallest_mesh_force_time : float
        Times of these extremes [s].
    smallest_separation : float
        Smallest distance of the flanks [m], with the deflection of elastic bodies.
    final_speed : float
        Speed of the gear [rad/s] or the roller [m/s] at the end of the data.
    asperity_onsets, asperity_detachments : int
        Asperities of a population that have joined, and detached.
    exposures : array of float
        Exposures of the flanks, in the order flank, tooth of the pinion, quantity, place: for each
        material asperities joined over those of a unit contact length, for each the energy they lost [J], sliding work
        [J], largest force over contact length [N], and where flanks have friction its work [J]. Empty if
        ``run.exposures`` is 0.
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
    advance: float = math.nan
    free_advance: float = math.nan
    driven_time: float = math.nan
    held_torque: float = math.nan
    holding: int = 0
    turned_back: float = math.nan
    free_turned_back: float = math.nan
    back_time: float = math.nan
    standstills: int = 0
    standing_time: float = math.nan
    standing_rest_time: float = math.nan
    start_time: float = math.nan
    breakaway_torque: float = math.nan
    followed_time: float = math.nan
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
    standstill_list: array[float] = field(default_factory=lambda: array("d"))
