r"""The energy balance of a run, kept at every accepted step without evaluating a force.

The works of drive, drag, laws of the shafts and mesh damping need torques and speeds. The work of a constant torque
is exactly torque times angle, and so is that of the drag at a mean speed; the rest is integrated with the powers and
their rates at both ends (corrected trapezoidal rule, an error of fifth order in the length). Drag and damping vary most
and cost least to evaluate, so they are integrated over every step, with the travels too (an error of seventh order).
The others are integrated over several steps at once; a turning point in between is no kink of their powers.

What the contacts store is a function of the gaps and of the joined heights (`gearidae.contact.kernels.energy`). A
pair on a
contact of length :math:`\ell = \sqrt{R/p_b}` stores :math:`\ell\,(A(g) + \sum e_m)` and pushes with W. Its rate is

.. math::

    \frac{d}{dt}(\ell U) = -W \dot g + U \dot\ell - \dot Q,

with Q the energy that asperities lose by joining. The middle term is there because the radius of curvature R changes
along the path of contact, and with it the number of asperities in touch, while the force along the line of action
does no work for that: the model has no force for it (Teodorescu et al. 2009, Eqs. 4-6 and 13). It is named here, the
work of the changing radius, and integrated like the others. So

    drive + radius = drag + friction + damping + adhesion + losses of laws + stored + kinetic

but for the errors of integration, which is what the balance's residual measures.

In a closing contact, asperities come into contact until its turning point. Their loss is added there, in closed form,
:math:`\ell\,|E(0)|\,(\Psi(g) - \Psi(\zeta))` for each material; until then it counts as stored.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine import adams
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.cutoff import cutoff_guard, watches_cutoff
from gearidae.engine.events.mesh_marks import crossed_mark
from gearidae.engine.events.pair_events import newly_stretched
from gearidae.engine.events.sliding import friction_guard
from gearidae.engine.laws.pairs import LOSING, book_losses_of_mesh, radius_power, stored_energy
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import DRIVE, LOAD, MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.kinetic import energy_of_speeds, kinetic_energy
from gearidae.engine.observers import adhesion_loss
from gearidae.engine.observers.orbit_work import begin_orbit, book_orbit
from gearidae.engine.pairs.mesh_error import pinion_acceleration, speed_and_error
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.engine.pairs.tooth_pairs import (
    flank_of_history,
    gap_and_rate,
    in_flight,
    list_known,
)
from gearidae.formulas.quadrature import (
    Ends,
    error_estimate,
    integral,
    torque_work,
)
from gearidae.laws.frictions import begin_friction, book_friction, book_stop, resists
from gearidae.laws.shafts import book_losses, driving_along, driving_force, is_constant, stored_by_laws

ORDER: Final = 4
"""Order of the quadrature."""


@compiled
def open_balance(address: int, y: Floats) -> None:
    """Note the energies at the start; the kinetic energy counts as exchanged, as speeds have absolute tolerances."""
    m = model_at(address)
    e = m.state.energy
    e.start_stored = stored_energy(m, y)[0]
    e.start_shafts = _stored_in_shafts(m, y)
    e.start_kinetic = e.throughput = e.peak_kinetic = kinetic_energy(m, y)


@compiled
def _stored_in_shafts(m: Model, y: Floats) -> float:
    """Energy that laws of both shafts store."""
    energy = 0.0
    for shaft in range(2):
        if m.scene.torque[shaft].acts != 0:
            energy = stored_by_laws(m, shaft, torque_angle(m, shaft, y[U], y[PHASE]), energy)
    return energy


@compiled
def carry_balance(old: Model, old_y: Floats, m: Model, y: Floats) -> None:
    """Add the stored energy of another model of the same scene minus that of the old one to ``model_change``."""
    if m.scene.follow.balance == 0:
        return
    m.state.energy.model_change += stored_energy(m, y)[0] - stored_energy(old, old_y)[0]


@compiled_once(SOLVER)
def begin(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Begin a quadrature at a start, where speeds and torques may jump."""
    q = m.work.quadrature
    follow_orbit(m, t)
    q.steps = 0
    q.length_work = 0.0
    q.time = t
    q.kinetic = kinetic_energy(m, y)
    q.gear_travel, q.gear_speed, q.gear_acceleration = y[PHASE] / m.scene.phase_rate, y[W], yp[W]
    _note_resistance(m, t, q.gear_travel, y, yp)
    if m.scene.orbit != 0.0:
        begin_orbit(m, t, y, yp)
    q.pinion_travel, q.pinion_speed, q.pinion_acceleration = _pinion(m, y, yp)
    angle = torque_angle(m, DRIVE, y[U], y[PHASE])
    q.drive, q.drive_rate = driving_along(m, DRIVE, t, angle, q.pinion_speed, q.pinion_acceleration)
    if resists(m, DRIVE):
        begin_friction(m, DRIVE, t, angle, q.pinion_speed, q.pinion_acceleration)
    if resists(m, LOAD):
        begin_friction(m, LOAD, t, torque_angle(m, LOAD, y[U], y[PHASE]), y[W], yp[W])
    _sample_radius_power(m, t, y)


@compiled(inline=True)
def step(
    m: Model, t: float, y: Floats, yp: Floats, at: tuple[bool, bool], between: tuple[Floats, Floats]
) -> bool:
    """Add works and losses up to an accepted time; histories and mesh marks must still be those before it.

    A turning point needs no sample. In free flight, where only torques and drag are integrated, formulas of high
    order take steps that are too long for the quadrature; these steps are divided.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there and its rate.
    at : tuple of bool
        Whether a stop or a root of the guard is there, and whether it is a root.
    between : tuple of two ndarrays, shape (n,)
        Work space.

    Returns
    -------
    bool
        Whether an interval of the quadrature ends there.
    """
    if at[1] and _can_wait(m, t, y):
        return False
    a, parts, start = m.work.adams, 1, m.work.resistance.time
    if a.order_used > ORDER and in_flight(m):
        parts = m.scene.flight_parts
        start = max(start, a.time - a.last_step)
    for part in range(1, parts):
        time = start + (t - start) * part / parts
        adams.between(a, time, between[0], between[1])
        _accumulate(m, time, between[0], between[1], True)
    _accumulate(m, t, y, yp, at[0] or m.state.bound_exceeded != 0)
    return bool(m.work.quadrature.time == t)


@compiled
def _can_wait(m: Model, t: float, y: Floats) -> bool:
    """Whether no sample is needed at a root, before its events are dealt with.

    That is so where pairs touch, part or turn round and nothing else happens: up to their third derivative the
    powers know nothing of it.
    """
    if m.scene.nodes > 0 or m.state.bound_exceeded != 0:
        return False
    if m.scene.population.flanks != 0 or m.scene.friction.any_friction != 0:  # forces jump
        return False
    if m.scene.guarded != 0 or m.scene.law_switches != 0:  # torques do
        return False
    if watches_cutoff(m) and cutoff_guard(m, y) <= 0.0:
        return False
    if in_flight(m) or t - m.work.quadrature.time > m.scene.quadrature_time:
        return False
    if crossed_mark(m, y) or (m.scene.friction.may_stick != 0 and friction_guard(m, t, y) <= 0.0):
        return False
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        gap, _ = gap_and_rate(m, flank_of_history(m, k), m.state.history[k].pair, y)
        for material in range(MATERIALS):
            if newly_stretched(m, k, material, gap):
                return False
    return True


@compiled
def resume(m: Model, t: float, y: Floats, crossed: bool, joined: bool) -> None:
    """Go on after events at a root, with histories and mesh marks behind them.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State, which a gear that comes to rest has changed.
    crossed : bool
        Whether the phase has crossed a mark of the mesh, where the power of the changing radius jumps.
    joined : bool
        Whether an adhesion loss has been added, where that of elastic contacts jumps.
    """
    q = m.work.quadrature
    if resists(m, LOAD) and q.time == t:
        book_stop(m, LOAD, q.kinetic - kinetic_energy(m, y))
    if crossed or (joined and m.scene.nodes > 0):
        _sample_radius_power(m, t, y)


@compiled_once(SOLVER)
def finish(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Bring all sums up to an accepted time, after its event."""
    _accumulate(m, t, y, yp, True)


@compiled(inline=True)
def _sample_radius_power(m: Model, t: float, y: Floats) -> None:
    """Look at the power of the changing radius and at its rate."""
    q = m.work.quadrature
    q.radius_power, q.radius_power_rate = radius_power(m, t, y, q.gear_acceleration)


@compiled(inline=True)
def _accumulate(m: Model, t: float, y: Floats, yp: Floats, now: bool) -> None:
    """Add all works and losses up to a time, `now` or once so many steps have been taken."""
    q = m.work.quadrature
    follow_orbit(m, t)
    _accumulate_losses(m, t, y, yp)
    q.steps += 1
    h = t - q.time
    if h == 0.0 or not (now or in_flight(m) or _closes_interval(m, h)):
        return
    q.steps = 0
    q.time = t
    w, w_rate = y[W], yp[W]
    adhesion_loss.step(m, t, y, w_rate)
    gear = y[PHASE] / m.scene.phase_rate
    speed, exchange, error = _accumulate_drive(m, h, t, y, yp)
    if resists(m, LOAD):
        angle = torque_angle(m, LOAD, y[U], y[PHASE])
        speeds = Ends(q.gear_speed, q.gear_acceleration, w, w_rate)
        exchange, error = book_friction(m, LOAD, h, t, angle, gear - q.gear_travel, speeds, (exchange, error))
    q.gear_travel, q.gear_speed, q.gear_acceleration = gear, w, w_rate
    power, rate = radius_power(m, t, y, w_rate)
    radius = integral(h, q.radius_power, power, q.radius_power_rate, rate) + q.length_work
    e = m.state.energy
    e.quadrature_error += error + error_estimate(h, q.radius_power, power, q.radius_power_rate, rate)
    q.length_work = 0.0
    q.radius_power, q.radius_power_rate = power, rate
    e.radius_work += radius
    _accumulate_kinetic(m, energy_of_speeds(m, speed, w), exchange + abs(radius))


@compiled(inline=True)
def _accumulate_kinetic(m: Model, kinetic: float, exchanged: float) -> None:
    """Note the kinetic energy at the end of an interval, and what has been exchanged in it besides its change."""
    e, q = m.state.energy, m.work.quadrature
    e.throughput += exchanged + abs(kinetic - q.kinetic)
    e.peak_kinetic = max(e.peak_kinetic, kinetic)
    q.kinetic = kinetic


@compiled(inline=True)
def _accumulate_drive(m: Model, h: float, t: float, y: Floats, yp: Floats) -> tuple[float, float, float]:
    """Add the work of the drive, and the losses on the pinion's shaft.

    Returns
    -------
    speed : float
        Of the pinion.
    exchange, error : float
        Magnitude of work and losses, and its error estimate.
    """
    q = m.work.quadrature
    pinion, speed, acceleration = _pinion(m, y, yp)
    travel, angle = pinion - q.pinion_travel, torque_angle(m, DRIVE, y[U], y[PHASE])
    speeds = Ends(q.pinion_speed, q.pinion_acceleration, speed, acceleration)
    force, rate = driving_along(m, DRIVE, t, angle, speed, acceleration)
    work, error = torque_work(h, travel, Ends(q.drive, q.drive_rate, force, rate), speeds)
    exchange = abs(work)
    if resists(m, DRIVE):
        exchange, error = book_friction(m, DRIVE, h, t, angle, travel, speeds, (exchange, error))
    q.drive, q.drive_rate = force, rate
    q.pinion_travel, q.pinion_speed, q.pinion_acceleration = pinion, speed, acceleration
    m.state.energy.drive_work += work
    return speed, exchange, error


@compiled(inline=True)
def _closes_interval(m: Model, h: float) -> bool:
    """Whether to close the quadrature interval: after fewer steps, the larger the error is estimated."""
    steps, most = m.work.quadrature.steps, m.scene.balance_error * m.state.energy.throughput
    error = m.state.energy.quadrature_error
    if steps >= m.scene.quadrature_steps or h > m.scene.quadrature_time or error > most:
        return True
    return bool(3.0 * error > most and 2 * steps >= m.scene.quadrature_steps)


@compiled(inline=True)
def _accumulate_losses(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Add the losses of laws of the shafts and of the mesh, over every step."""
    r = m.work.resistance
    h = t - r.time
    if h == 0.0:
        return
    gear, w, w_rate = y[PHASE] / m.scene.phase_rate, y[W], yp[W]
    e, speeds = m.state.energy, Ends(r.gear_speed, r.gear_acceleration, w, w_rate)
    taken = 0.0
    if m.scene.torque[LOAD].acts != 0:
        taken = book_losses(m, LOAD, h, torque_angle(m, LOAD, y[U], y[PHASE]), gear - r.gear_travel, speeds)
    if m.scene.torque[DRIVE].acts != 0:
        travel, speed, acceleration = _pinion(m, y, yp)
        ends = Ends(r.pinion_speed, r.pinion_acceleration, speed, acceleration)
        angle = torque_angle(m, DRIVE, y[U], y[PHASE])
        taken += book_losses(m, DRIVE, h, angle, travel - r.pinion_travel, ends)
    if m.scene.pair_laws & LOSING != 0:
        taken = book_losses_of_mesh(m, h, y, yp, taken)
    _note_resistance(m, t, gear, y, yp)
    if m.scene.orbit != 0.0:
        taken += book_orbit(m, t, y, yp)
    e.throughput += taken


@compiled(inline=True)
def _note_resistance(m: Model, t: float, gear: float, y: Floats, yp: Floats) -> None:
    """Note travels, speeds and accelerations of gear and mesh, and of a pinion on which laws act."""
    r = m.work.resistance
    r.time, r.gear_travel = t, gear
    r.gear_speed, r.gear_acceleration = y[W], yp[W]
    r.mesh_travel, r.mesh_speed, r.mesh_acceleration = y[U], y[V], yp[V]
    if m.scene.torque[DRIVE].acts != 0:
        r.pinion_travel, r.pinion_speed, r.pinion_acceleration = _pinion(m, y, yp)


@compiled
def note_changes(m: Model, y: Floats) -> tuple[float, float]:
    """Note the changes of the energies at a state, and return what adhesion loss and radius work have pending there."""
    e, now = m.state.energy, m.work.energy_now
    (stored, pending), adhesion_lag = stored_energy(m, y), adhesion_loss.total_adhesion_lag(m)
    now.stored_change = stored - pending - e.start_stored
    now.shaft_change = _stored_in_shafts(m, y) - e.start_shafts
    now.kinetic_change = kinetic_energy(m, y) - e.start_kinetic
    return pending - adhesion_lag, -adhesion_lag if m.scene.curvature_force == 0 else 0.0


@compiled
def note_present(m: Model, t: float, y: Floats) -> None:
    """Add to the sums, for a look at them, what contacts have pending, and note the present energies.

    Parameters
    ----------
    t : float
        Time over tau, to which the sums have been brought.
    y : ndarray, shape (n,)
        State there.
    """
    e, now, (adhesion, radius) = m.state.energy, m.work.energy_now, note_changes(m, y)
    e.adhesion_loss += adhesion
    e.radius_work += radius
    e.quadrature_error += e.loss_error
    now.largest = e.peak_kinetic + abs(e.start_stored) + abs(e.start_shafts) + abs(e.model_change)
    if m.scene.gear_inverse_mass != 0.0:  # a gear that is held has neither travel nor speed
        pinion, gear, twice = m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass, 2.0 * e.peak_kinetic
        # torques that are integrated over travels are at most the unit of force; springs store by the angle alone
        now.pitch_work = 2.0 / m.scene.phase_rate
        now.speed_work = math.sqrt(twice / pinion) + math.sqrt(twice / gear)
        top_speed = math.sqrt(twice / (1.0 / pinion + 1.0 / gear))
        now.torque_work = _torque_slopes(m, t, y) * top_speed * t


@compiled
def _torque_slopes(m: Model, t: float, y: Floats) -> float:
    """By how much the torques differ, over their base radii, at speeds that differ by one."""
    total = 0.0
    for shaft in range(2):
        if not is_constant(m, shaft):
            speed = y[W] if shaft == LOAD else speed_and_error(m, y)[0]
            angle = torque_angle(m, shaft, y[U], y[PHASE])
            faster = driving_force(m, shaft, t, angle, speed + 1.0)
            total += abs(faster - driving_force(m, shaft, t, angle, speed))
    return total


@compiled
def _pinion(m: Model, y: Floats, yp: Floats) -> tuple[float, float, float]:
    """Travel of the pinion's base circle, its rate and the rate of that."""
    speed, e = speed_and_error(m, y)
    travel = y[U] + y[PHASE] / m.scene.phase_rate + e.value
    return travel, speed, pinion_acceleration(e, speed, y[W], yp[V], yp[W])
