r"""The energy ledger of a run, kept at every accepted step without evaluating a force.

The works of drive, drag, dry resistance and mesh damping need torques and speeds only. A torque that is constant
does exactly torque times angle, and the drag of a mean speed likewise; the rest is integrated with the powers and their
rates at both ends (corrected trapezoidal rule, an error of fifth order in the length). Drag and damping vary most and
cost least to look at, so they are integrated step by step. The others are over several steps at once, and a pair that
turns round in between is no corner to them.

What the contacts store is a function of the gaps and of the joined heights (`gearidae.contact.kernels.energy`). A
pair on a
footprint of length :math:`\ell = \sqrt{R/p_b}` stores :math:`\ell\,(A(g) + \sum e_m)` and pushes with W. Its rate is

.. math::

    \frac{d}{dt}(\ell U) = -W \dot g + U \dot\ell - \dot Q,

with Q the energy that asperities lose by joining. The middle term is there because the radius of curvature R changes
along the path of contact, and with it the number of asperities in touch, while the force along the line of action
does no work for that: the model has no force for it (Teodorescu et al. 2009, Eqs. 4-6 and 13). It is named here, the
work of the changing radius, and integrated like the others. So

    drive + radius = drag + dry + damping + adhesion + stored + kinetic

but for the errors of integration, which is what the ledger's residual measures.

A contact that closes joins asperities all the way to its turning point. Their loss is booked there, in closed form,
:math:`\ell\,|E(0)|\,(\Psi(g) - \Psi(\zeta))` for each material; until then it counts as stored.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.contact.kernels.energy import stretched_energy
from gearidae.contact.kernels.law import B_PIECES, branch_length, branch_value, loading_value, set_branch
from gearidae.engine.elastic.calls import nodes_joining_loss, nodes_length_force, nodes_stored
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import (
    energy_branch,
    first_pair,
    footprint,
    history_slot,
    in_flight,
    last_pair,
    material_stretch,
    pair_gap,
    static_error,
)
from gearidae.engine.model.torque import torque_force, torque_rate

__all__ = [
    "book_joining",
    "carry_ledger",
    "enter",
    "follow",
    "kinetic_energy",
    "open_ledger",
    "see_radius",
    "stored_energy",
]

Floats = NDArray[np.float64]


@compiled
def kinetic_energy(d: Floats, y: Floats) -> float:
    """Kinetic energy of both gears, or of the roller, scaled."""
    if d[at.KIND] == at.ROLLER:
        return 0.5 * y[at.V] * y[at.V] / d[at.GEAR_SHARE]
    pinion = y[at.V] + y[at.W]
    if d[at.ERROR_ORDERS] != 0.0:
        pinion /= 1.0 - static_error(d, y[at.U], y[at.PHASE])[2]
    return 0.5 * pinion * pinion / d[at.PINION_SHARE] + 0.5 * y[at.W] * y[at.W] / d[at.GEAR_SHARE]


# -- what contacts store ---------------------------------------------------------------------------------------------


@compiled
def _joined_energy(d: Floats, slot: int, gap: float) -> tuple[float, float]:
    """What joined asperities of a pair store beyond the loading branch per length, and its slope in the gap."""
    energy = slope = 0.0
    for material in range(2):
        limit = material_stretch(d, material)
        if limit == 0.0:
            continue
        scale = d[at.MATERIALS + at.MATERIAL * material + at.M_FORCE]
        stretch = gap - d[slot + at.JOINED + material]
        if stretch <= 0.0:
            energy += scale * d[slot + at.BOOKED + material]
            continue
        table = d[int(d[at.ENERGIES + at.ENERGY * material + at.E_TABLE]) :]
        joined = d[slot + at.JOINED + material]
        if stretch < limit and d[at.BRANCH] > 0.0 and branch_length(table) > 0:
            branch = d[energy_branch(d, slot, material) :]
            if branch[B_PIECES] == 0.0:
                set_branch(table, joined, branch)
            e, de = branch_value(branch, stretch)
        else:
            e, de = stretched_energy(table, d[slot + at.BOOKED + material], gap, joined)
        energy += scale * e
        slope += scale * de
    return energy, slope


@compiled
def stored_energy(d: Floats, y: Floats) -> tuple[float, float]:
    """What all contacts store, and the part of it that asperities joined since the last turning point have lost.

    Parameters
    ----------
    d : ndarray
        The scene with the histories as they are at `y`, see `layout`.
    y : ndarray
        State.

    Returns
    -------
    stored, pending : float
        Scaled; the true stored energy is their difference.
    """
    stored = pending = 0.0
    roller = d[at.KIND] == at.ROLLER
    for coast in range(1 if roller else 2):
        first = last = 0
        if not roller:
            first, last = first_pair(d, coast, y[at.PHASE]), last_pair(d, coast, y[at.PHASE])
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            gap, rate, length = y[at.U], y[at.V], 1.0
            if not roller:
                gap, rate, _, inside = pair_gap(d, coast, pair, y[at.U], y[at.V], y[at.PHASE], y[at.W])
                length = footprint(d, inside)
            if gap >= d[at.CUTOFF] or d[slot + at.PAIR] != pair:
                continue
            if d[at.NODES] > 0.0:
                stored += length * nodes_stored(d, slot, d[at.LAST_TIME], y, gap, rate, length)
                pending += length * nodes_joining_loss(d, slot, y, gap)
                continue
            energy, _ = _joined_energy(d, slot, gap)
            stored += length * (loading_value(d, int(d[at.POTENTIAL_AT]), gap)[0] + energy)
            pending += length * _joining_loss(d, slot, gap)
    return stored, pending


@compiled
def open_ledger(d: Floats, y: Floats) -> None:
    """Note with what a run begins; speeds are held to tolerances of their own, however little they change."""
    d[at.SUMS : at.SUMS_END] = 0.0
    d[at.START_STORED] = stored_energy(d, y)[0]
    d[at.START_KINETIC] = d[at.THROUGHPUT] = kinetic_energy(d, y)


@compiled(makes_arrays=True)
def carry_ledger(old: Floats, old_y: Floats, d: Floats, y: Floats) -> None:
    """Go on with a ledger in another model of the same scene, whose contacts store something else."""
    d[at.SUMS : at.LEDGER_END] = old[at.SUMS : at.LEDGER_END]
    d[at.MODEL_CHANGE] += stored_energy(d, y)[0] - stored_energy(old, old_y)[0]


@compiled
def book_joining(d: Floats, y: Floats, coast: int, pair: int, slot: int, gap: float) -> None:
    """Book what a pair's asperities have lost by joining, before a closing contact's turning point is noted."""
    length = 1.0
    if d[at.KIND] == at.GEARS:
        length = footprint(d, pair_gap(d, coast, pair, y[at.U], y[at.V], y[at.PHASE], y[at.W])[3])
    if d[at.NODES] > 0.0:
        d[at.ADHESION_LOSS] += length * nodes_joining_loss(d, slot, y, gap)
        return
    loss = _joining_loss(d, slot, gap)
    d[at.ADHESION_LOSS] += length * loss
    if d[at.KIND] == at.GEARS:
        _book_before(d, coast, pair, loss, length)


@compiled
def _book_before(d: Floats, coast: int, pair: int, loss: float, length: float) -> None:
    """Let the power of the changing radius go on without a step where a loss per length has been booked.

    From then on it lacks the loss times the rate of the length. It is taken out where the quadrature began, too, and
    what that leaves out until now is the loss times what the length has changed by.
    """
    first, last = _pairs_on_path(d, coast)
    if d[at.NEAR + coast] == 0.0 or not first <= pair <= last:
        return
    before = d[at.WAS_GEAR] * d[at.PHASE_RATE]
    was, rate, bend = _length(d, coast, pair, before, d[at.WAS_W], d[at.WAS_W_RATE])
    d[at.WAS_RADIUS] -= loss * rate
    d[at.WAS_RADIUS_RATE] -= loss * bend
    d[at.WAS_BOOKED] += loss * (length - was)


@compiled
def _joining_loss(d: Floats, slot: int, gap: float) -> float:
    """What the asperities that a closing contact has joined since its last turning point have lost, per length."""
    loss = 0.0
    number = loading_value(d, int(d[at.NUMBER_AT]), gap)[0]
    for material in range(2):
        if material_stretch(d, material) > 0.0 and gap < d[slot + at.JOINED + material]:
            joining = d[at.ENERGIES + at.ENERGY * material + at.E_JOINING]
            scale = d[at.MATERIALS + at.MATERIAL * material + at.M_FORCE]
            loss += scale * (joining * number + d[slot + at.BOOKED + material])
    return loss


@compiled
def _radius_power(d: Floats, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    elastic = d[at.NODES] > 0.0
    for coast in range(2):
        if d[at.NEAR + coast] == 0.0:
            continue
        sign = 1.0 - 2.0 * coast
        gap = d[at.HALF_BACKLASH] - sign * y[at.U]
        if gap >= d[at.CUTOFF]:
            continue
        potential, push = loading_value(d, int(d[at.POTENTIAL_AT]), gap)
        first, last = _pairs_on_path(d, coast)
        for pair in range(first, last + 1):
            slot = history_slot(d, coast, pair)
            if d[slot + at.PAIR] != pair:
                continue
            length, length_rate, bend = _length(d, coast, pair, y[at.PHASE], y[at.W], w_rate)
            if elastic:
                pull, change = nodes_length_force(d, slot, t, y, gap, -sign * y[at.V], length)
            else:
                pull, slope = _joined_energy(d, slot, gap)
                pull += potential
                change = -(slope + push) * sign * y[at.V]
            power += pull * length_rate
            rate += change * length_rate + pull * bend
    return power, rate


@compiled
def _pairs_on_path(d: Floats, coast: int) -> tuple[int, int]:
    """First and last number of a flank's pairs on the path of contact.

    The last two mesh marks tell, so that a step that ends at a mark sees the side it comes from.
    """
    between = 0.5 * (d[at.MARK_LOW] + d[at.MARK_HIGH])
    lowest = between - d[at.COAST_PHASE] if coast else between - d[at.PATH]
    return math.ceil(lowest), math.floor(lowest + d[at.PATH])


@compiled
def _length(
    d: Floats, coast: int, pair: int, phase: float, w: float, w_rate: float
) -> tuple[float, float, float]:
    """Length of the footprint of a pair on the path of contact, its rate and the rate of that."""
    sign = d[at.PHASE_RATE] * (1.0 - 2.0 * coast)
    curvature = d[at.SUM_CURVATURE]
    # l^2 = r - c r^2 with r the pinion's radius of curvature
    radius = d[at.START_RADIUS] + (d[at.COAST_PHASE] + pair - phase if coast else phase - pair)
    length = math.sqrt(radius - radius * radius * curvature)
    half = 0.5 - radius * curvature
    along = sign * w
    rate = half * along / length
    return length, rate, (half * sign * w_rate - curvature * along * along - rate * rate) / length


# -- from one accepted time to the next ------------------------------------------------------------------------------


@compiled
def enter(d: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Begin a quadrature at a start, where speeds and torques may jump."""
    d[at.LEDGER_STEPS] = d[at.WAS_BOOKED] = 0.0
    d[at.LEDGER_TIME] = t
    d[at.WAS_KINETIC] = kinetic_energy(d, y)
    if d[at.KIND] == at.ROLLER:
        return
    d[at.WAS_GEAR], d[at.WAS_W], d[at.WAS_W_RATE] = y[at.PHASE] / d[at.PHASE_RATE], y[at.W], yp[at.W]
    _see_resistance(d, t, d[at.WAS_GEAR], y, yp)
    d[at.WAS_PINION], d[at.WAS_SPEED], d[at.WAS_GAIN] = _pinion(d, y, yp)
    d[at.WAS_DRIVE], d[at.WAS_DRIVE_RATE] = _torque(d, int(d[at.DRIVE_AT]), t)
    d[at.WAS_LOAD], d[at.WAS_LOAD_RATE] = _torque(d, int(d[at.LOAD_AT]), t)
    see_radius(d, t, y)


@compiled
def see_radius(d: Floats, t: float, y: Floats) -> None:
    """Look again at the power of the changing radius, which jumps at a mesh mark.

    Of an elastic contact it jumps where a joining loss is booked, too.
    """
    d[at.WAS_RADIUS], d[at.WAS_RADIUS_RATE] = _radius_power(d, t, y, d[at.WAS_W_RATE])


@compiled(inline=True)
def follow(d: Floats, t: float, y: Floats, yp: Floats, now: bool) -> None:
    """Book what has been done up to an accepted time; histories and mesh marks must still be those before it.

    Parameters
    ----------
    d : ndarray
        The scene, see `layout`.
    t : float
        Time over tau that has been accepted.
    y, yp : ndarray
        State there and its rate.
    now : bool
        Whether it cannot wait until enough steps have gathered, see `layout.LEDGER_STRIDE`.
    """
    if d[at.KIND] == at.GEARS:
        _resist(d, t, y, yp)
    d[at.LEDGER_STEPS] += 1.0
    h = t - d[at.LEDGER_TIME]
    if h == 0.0 or not (now or in_flight(d) or _gathered(d, h)):
        return
    d[at.LEDGER_STEPS] = 0.0
    d[at.LEDGER_TIME] = t
    if d[at.KIND] == at.ROLLER:
        kinetic = kinetic_energy(d, y)
        d[at.THROUGHPUT] += abs(kinetic - d[at.WAS_KINETIC])
        d[at.WAS_KINETIC] = kinetic
        return
    pinion, speed, gain = _pinion(d, y, yp)
    force, rate = _torque(d, int(d[at.DRIVE_AT]), t)
    drive, doubt = _torque_work(
        h,
        pinion - d[at.WAS_PINION],
        d[at.WAS_DRIVE],
        d[at.WAS_DRIVE_RATE],
        d[at.WAS_SPEED],
        d[at.WAS_GAIN],
        force,
        rate,
        speed,
        gain,
    )
    d[at.WAS_DRIVE], d[at.WAS_DRIVE_RATE] = force, rate
    d[at.WAS_PINION], d[at.WAS_SPEED], d[at.WAS_GAIN] = pinion, speed, gain
    d[at.DRIVE_WORK] += drive
    exchange = abs(drive)

    w, w_rate = y[at.W], yp[at.W]
    gear = y[at.PHASE] / d[at.PHASE_RATE]
    if d[at.DRY] != 0.0:
        force, rate = _torque(d, int(d[at.LOAD_AT]), t)
        travel = gear - d[at.WAS_GEAR]
        if min(force, d[at.WAS_LOAD]) < 0.0:  # a dry resistance never pushes: what is left of a straight line
            most = max(force, d[at.WAS_LOAD], 0.0)
            dry = 0.5 * most * most / abs(force - d[at.WAS_LOAD]) * travel if most > 0.0 else 0.0
            doubt += abs(dry)
        else:
            dry, more = _torque_work(
                h,
                travel,
                d[at.WAS_LOAD],
                d[at.WAS_LOAD_RATE],
                d[at.WAS_W],
                d[at.WAS_W_RATE],
                force,
                rate,
                w,
                w_rate,
            )
            doubt += more
        d[at.WAS_LOAD], d[at.WAS_LOAD_RATE] = force, rate
        d[at.DRY_LOSS] += d[at.SLIP] * dry
        exchange += abs(d[at.SLIP] * dry)
    d[at.WAS_GEAR], d[at.WAS_W], d[at.WAS_W_RATE] = gear, w, w_rate

    power, rate = _radius_power(d, t, y, w_rate)
    radius = _integral(h, d[at.WAS_RADIUS], power, d[at.WAS_RADIUS_RATE], rate) + d[at.WAS_BOOKED]
    d[at.DOUBT] += doubt + _doubt(h, d[at.WAS_RADIUS], power, d[at.WAS_RADIUS_RATE], rate)
    d[at.WAS_BOOKED] = 0.0
    d[at.WAS_RADIUS], d[at.WAS_RADIUS_RATE] = power, rate
    d[at.RADIUS_WORK] += radius
    kinetic = 0.5 * speed * speed / d[at.PINION_SHARE] + 0.5 * w * w / d[at.GEAR_SHARE]
    d[at.THROUGHPUT] += exchange + abs(radius) + abs(kinetic - d[at.WAS_KINETIC])
    d[at.WAS_KINETIC] = kinetic


@compiled(inline=True)
def _gathered(d: Floats, h: float) -> bool:
    """Whether as many steps have been gathered since the last look as may be: fewer, the more is in doubt."""
    steps, most = d[at.LEDGER_STEPS], d[at.LEDGER_DOUBT] * d[at.THROUGHPUT]
    if steps >= d[at.LEDGER_STRIDE] or h > d[at.LEDGER_SPAN] or d[at.DOUBT] > most:
        return True
    return bool(3.0 * d[at.DOUBT] > most and 2.0 * steps >= d[at.LEDGER_STRIDE])


@compiled(inline=True)
def _resist(d: Floats, t: float, y: Floats, yp: Floats) -> None:
    """Book what drag and damping have taken: they cost next to nothing to look at, so that no step need be gathered."""
    h = t - d[at.RESIST_TIME]
    if h == 0.0:
        return
    gear, w, w_rate = y[at.PHASE] / d[at.PHASE_RATE], y[at.W], yp[at.W]
    taken = 0.0
    if d[at.DRAG] != 0.0:
        taken = d[at.DRAG] * _cubes(
            h, gear - d[at.RESIST_GEAR], d[at.RESIST_W], d[at.RESIST_W_RATE], w, w_rate
        )
        d[at.DRAG_LOSS] += taken
    if d[at.DAMPING] != 0.0:
        v, was = y[at.V], d[at.RESIST_V]
        rub = d[at.DAMPING] * _integral(
            h, was * was, v * v, 2.0 * was * d[at.RESIST_V_RATE], 2.0 * v * yp[at.V]
        )
        d[at.DAMPING_LOSS] += rub
        taken += rub
    _see_resistance(d, t, gear, y, yp)
    d[at.THROUGHPUT] += taken


@compiled(inline=True)
def _see_resistance(d: Floats, t: float, gear: float, y: Floats, yp: Floats) -> None:
    """Note what the powers of drag and damping are made of, with the gear's travel."""
    d[at.RESIST_TIME], d[at.RESIST_GEAR] = t, gear
    d[at.RESIST_W], d[at.RESIST_W_RATE] = y[at.W], yp[at.W]
    d[at.RESIST_V], d[at.RESIST_V_RATE] = y[at.V], yp[at.V]


@compiled
def _pinion(d: Floats, y: Floats, yp: Floats) -> tuple[float, float, float]:
    """Travel of the pinion's base circle, its rate and the rate of that."""
    travel = y[at.U] + y[at.PHASE] / d[at.PHASE_RATE]
    speed, gain = y[at.V] + y[at.W], yp[at.V] + yp[at.W]
    if d[at.ERROR_ORDERS] != 0.0:
        _, e, e1, e2 = static_error(d, y[at.U], y[at.PHASE])
        travel += e
        speed /= 1.0 - e1
        gain = (gain + e2 * speed * speed) / (1.0 - e1)
    return travel, speed, gain


@compiled
def _torque(d: Floats, law: int, t: float) -> tuple[float, float]:
    """A torque over its base radius, and its rate."""
    if d[law + at.LAW_HARMONICS] == 0.0 and d[law + at.LAW_POINTS] == 0.0:
        return d[law + at.LAW_CONSTANT], 0.0
    return torque_force(d, law, t), torque_rate(d, law, t)


@compiled
def _torque_work(
    h: float,
    travel: float,
    force0: float,
    rate0: float,
    speed0: float,
    gain0: float,
    force1: float,
    rate1: float,
    speed1: float,
    gain1: float,
) -> tuple[float, float]:
    """Work of a torque along a travel, and how far it may be out.

    The mean of the torque does its part exactly, and its change that at the mean speed nearly so; what is in doubt is
    the work at the speed's deviation.
    """
    work = 0.5 * (force0 + force1) * travel
    if rate0 == 0.0 and rate1 == 0.0:
        return work, 0.0
    mean, half = travel / h, 0.5 * (force1 - force0)
    a, b = speed0 - mean, speed1 - mean
    start, end = rate0 * a - half * gain0, rate1 * b + half * gain1
    slow = mean * _correction(h, rate0, rate1)
    return work + slow + _integral(h, -half * a, half * b, start, end), _doubt(
        h, half * a, half * b, start, end
    )


@compiled
def _doubt(h: float, f0: float, f1: float, rate0: float, rate1: float) -> float:
    """By how much the corrected trapezoidal rule may be out: its correction, times the share that this has in it."""
    correction = abs(_correction(h, rate0, rate1))
    if correction == 0.0:
        return 0.0
    return correction * correction / (correction + 0.5 * h * (abs(f0) + abs(f1)))


@compiled
def _integral(h: float, f0: float, f1: float, rate0: float, rate1: float) -> float:
    """Corrected trapezoidal rule: exact for cubics."""
    return 0.5 * h * (f0 + f1) + _correction(h, rate0, rate1)


@compiled
def _correction(h: float, rate0: float, rate1: float) -> float:
    """What the rates correct the trapezoidal rule by."""
    return h * h / 12.0 * (rate0 - rate1)


@compiled
def _cubes(h: float, travel: float, w0: float, rate0: float, w1: float, rate1: float) -> float:
    """Integral of the cube of a speed's magnitude.

    That of the speed itself is known, the travel: what is left to the quadrature is of second order in the speed's
    deviation from its mean.
    """
    mean = travel / h
    if mean * w0 <= 0.0 or mean * w1 <= 0.0:  # it has turned round
        q0, q1 = w0 * abs(w0), w1 * abs(w1)
        return _integral(h, q0 * w0, q1 * w1, 3.0 * q0 * rate0, 3.0 * q1 * rate1)
    a, b = w0 - mean, w1 - mean
    # of the cube of mean and deviation, the deviation itself leaves nothing
    rest = _integral(
        h,
        (3.0 * mean + a) * a * a,
        (3.0 * mean + b) * b * b,
        3.0 * (2.0 * mean + a) * a * rate0,
        3.0 * (2.0 * mean + b) * b * rate1,
    )
    return abs(mean * mean * travel + rest)
