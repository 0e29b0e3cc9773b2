r"""What the flanks are exposed to, tooth by tooth and place by place, kept at the solver's own steps.

For both flanks of every tooth of the pinion and every place along the path of contact four sums are kept, in `rows`:

- asperities that have come into contact, :math:`\int \ell\, d\Psi` for each material. What a contact has joined at an
  accepted time is :math:`\Psi(\zeta)`, with the play operator's joined height :math:`\zeta` there; all turning points
  are accepted times, so that nothing is missed between them;
- the energy that they have lost by it, in the proportion of the energy balance (where shares change with tooth and
  place, as if the material covered everything);
- sliding work :math:`\int W |v_s| dt` of contacts that push, :math:`v_s` being the sum of both gears' angular speeds
  times the distance from the pitch point. It is integrated over some steps at once; the forces are those of Newton's
  iteration (`gearidae.engine.energy.noted_force`);
- the largest pressure, :math:`W / (L \sqrt{2 R \sigma})`, at the same times, at turning points, and where a contact
  passes from one place to the next.

An elastic contact is looked at as often as the energy balance closes an interval. What falls into a step in which a
contact passes from one place to the next is divided in proportion. Contacts on the tip relief count at the end of the
path.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.calls import node_force, nodes_number
from gearidae.engine.energy.noted_force import begin_notes, note_force
from gearidae.engine.energy.places import divide, note_pressure, place_at, spread
from gearidae.engine.energy.quadrature import integral
from gearidae.engine.extremes.interpolation import cubic
from gearidae.engine.model.coverage import note_shares, shares_of
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.model.tooth_pairs import (
    contact_length,
    history_of,
    pair_at,
    pair_force,
    pair_gap,
    pairs_near,
    static_error,
)
from gearidae.engine.sundials.memory import model_at

__all__ = [
    "PRESSURE",
    "QUANTITIES",
    "begin_exposures",
    "close_exposures_at",
    "expose_step",
    "expose_turning",
    "follow_exposures",
]

QUANTITIES = 2 * MATERIALS + 2
"""Sums of a place: contacts and adhesion work of each material, sliding work, largest pressure."""
MOST_STEPS = 6
"""Accepted steps over which sliding work is integrated at once."""
ADHESIVE_STEPS = 2
"""The same where adhesion matters: the slope of a force jumps where asperities are stretched to the limit."""
ADHESIVE = 0.1
"""Power of a pair that pulls, over that of the pair that pushes most, from which on adhesion matters."""
FADING = 0.9
"""Of the largest power from one of these times to the next."""
PARTS = 16
"""Parts of an interval in which a contact begins or ceases to push."""
SLIDING, PRESSURE = 2 * MATERIALS, 2 * MATERIALS + 1


@compiled
def begin_exposures(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note what is in contact at a start; nothing is exposed yet."""
    if m.scene.places == 0:
        return
    m.work.exposing.time, m.work.exposing.begun = t, 1
    _wait(m, 1)
    for k in range(m.scene.histories):
        m.work.exposing.pair[k].known = 0
    _note_forces(m, t, y)
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        k = noted.history
        _begin_pair(m, t, k, noted.pair, noted.place)
        for material in range(MATERIALS):
            if m.scene.material[material].force_scale > 0.0:
                m.work.exposing.pair[k].front[material] = _front(m, y, k, noted.gap, material)
        sliding = _sliding(m, y, yp[V], yp[W])
        _slide(m, t, k, sliding, noted.place, (noted.force, noted.slope * noted.gap_rate))


@compiled
def follow_exposures(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Add what the flanks have been exposed to since the last call, up to an accepted time.

    Parameters
    ----------
    m : Model
        With the histories before the event at this time, if there is one.
    t : float
        Time over tau.
    y, yp : ndarray
        State there and its rate.
    """
    exposing = m.work.exposing
    before = exposing.time
    if exposing.begun == 0 or t <= before:
        return
    if m.work.notes.time != t or m.scene.nodes > 0:
        _note_forces(m, t, y)
    sliding = _sliding(m, y, yp[V], yp[W])
    moved, steps, level = y[U] - m.work.notes.travel, MOST_STEPS, 0.0
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        k = noted.history
        own = m.work.exposing.pair[k]
        if own.known == 0 or own.pair != noted.pair or own.time < before:  # it has come near since
            if m.state.history[k].pair != noted.pair:
                continue
            _begin_pair(m, before, k, noted.pair, noted.place)
        widened = -moved if k < m.scene.slots else moved
        gap = noted.gap + widened
        if m.state.history[k].direction <= 0.0 and _joins(m, k, gap):
            _join(m, y, k, gap, noted.place)
        force = noted.force + noted.slope * widened
        _slide(m, t, k, sliding, noted.place, (force, noted.slope * noted.gap_rate))
        level = max(level, abs(own.power))
        if own.adhesive != 0 or own.pull < -ADHESIVE * exposing.level:
            steps = ADHESIVE_STEPS
    exposing.time, exposing.level = t, max(level, FADING * exposing.level)
    _wait(m, steps)


@compiled(inline=True)
def expose_step(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Count an accepted step of rigid bodies, and follow the exposures where as many as wanted have been made."""
    exposing = m.work.exposing
    exposing.steps += 1
    if exposing.steps >= exposing.wanted:
        follow_exposures(m, t, y, yp)
    m.work.notes.wanted = 1 if exposing.steps + 1 >= exposing.wanted else 0


@compiled(inline=True)
def _wait(m: Model, steps: int) -> None:
    """Want to follow the exposures after some steps, and have the forces noted in the last of them."""
    m.work.exposing.steps, m.work.exposing.wanted = 0, steps
    m.work.notes.wanted = (
        1 if steps == 1 and m.scene.nodes == 0 else 0
    )  # those of elastic contacts are evaluated


@compiled
def expose_turning(m: Model, t: float, y: Floats, coast: int, pair: int, k: int) -> None:
    """Add what a contact has been exposed to up to its turning point, before the history takes that.

    The pressure is largest where the gap is least.
    """
    own = m.work.exposing.pair[k]
    if own.known == 0 or own.pair != pair or own.time < m.work.exposing.time:
        return
    gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    if gap >= m.scene.cutoff:
        return
    if m.state.history[k].direction > 0.0:
        own.turned = 1
        for material in range(MATERIALS):
            law = m.scene.material[material]
            if law.force_scale > 0.0 and (law.stretch_limit == 0.0 or m.scene.nodes > 0):
                own.front[material] = _front(m, y, k, gap, material)
        return
    _join(m, y, k, gap, inside)
    own.adhesive = 1 if own.pull < -ADHESIVE * m.work.exposing.level else 0
    own.pull = 0.0
    at = place_at(m, inside)
    if own.adhesive != 0 or gap < own.lowest or at != own.at:
        own.lowest = min(own.lowest, gap)
        if m.scene.nodes == 0:
            rate = 0.0  # but for rounding, which is not to send the history through this point
        force, _ = _force(m, t, y, (coast, pair, k), (gap, rate, inside))
        if own.adhesive != 0:  # the slope of the force has a jump here
            point = m.work.track.point[m.work.track.last]
            _slide(m, t, k, _sliding(m, y, point.travel_bend, point.speed_rate), inside, (force, 0.0))
        elif force > 0.0:
            note_pressure(m, own.row + PRESSURE * m.scene.places + at, inside, force)


@compiled
def close_exposures_at(place: int, t: float, y: Floats, yp: Floats) -> None:
    """`follow_exposures` of the model at a place, from `gearidae.engine.sundials.memory.Located`."""
    m = model_at(place)
    follow_exposures(m, t, y, yp)


@compiled
def _begin_pair(m: Model, t: float, k: int, pair: int, inside: float) -> None:
    """Begin with a pair in which nothing is in contact."""
    own = m.work.exposing.pair[k]
    own.known, own.pair, own.time = 1, pair, t
    own.place, own.at = inside, place_at(m, inside)
    own.turned, own.adhesive, own.lowest = 0, 0, m.scene.cutoff
    own.power = own.power_rate = own.pull = own.force = own.force_rate = 0.0
    for material in range(MATERIALS):
        own.front[material] = 0.0
    coast = 0 if k < m.scene.slots else 1
    teeth = int(m.scene.pinion_teeth)
    tooth = (pair + int(m.state.turns)) % teeth
    own.row = m.scene.exposures_at + (coast * teeth + tooth) * QUANTITIES * m.scene.places


@compiled
def _note_forces(m: Model, t: float, y: Floats) -> None:
    """Evaluate the forces of all pairs that are near, where the last step did not end."""
    begin_notes(m, t, y[U])
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
        if gap < m.scene.cutoff and m.state.history[k].pair == pair:
            force = _force(m, t, y, (coast, pair, k), (gap, rate, inside))
            note_force(m, k, pair, inside, (gap, rate), force)


@compiled
def _force(
    m: Model, t: float, y: Floats, which: tuple[int, int, int], at: tuple[float, float, float]
) -> tuple[float, float]:
    """Force of a pair, given by flank, number and history, with a gap, a gap rate and a place; slope in the gap."""
    (coast, pair, k), (gap, rate, inside) = which, at
    if m.scene.nodes > 0:
        note_shares(m, k, coast, pair, inside)
        return node_force(m, k, True, t, y, gap, rate, contact_length(m, inside))
    return pair_force(m, k, True, t, gap, rate, inside, shares_of(m, k, coast, pair, inside))


@compiled(inline=True)
def _sliding(m: Model, y: Floats, v_rate: float, w_rate: float) -> tuple[float, float, float]:
    """Sliding speed a pitch from the pitch point, its rate, and how fast a contact moves along the path."""
    s = m.scene
    turn, turn_rate = y[V] + y[W], v_rate + w_rate
    if s.error_count != 0:
        turn /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    speed = s.sliding_pinion * turn + s.sliding_gear * y[W]
    return speed, s.sliding_pinion * turn_rate + s.sliding_gear * w_rate, s.phase_rate * y[W]


@compiled(inline=True)
def _slide(
    m: Model,
    t: float,
    k: int,
    sliding: tuple[float, float, float],
    inside: float,
    force: tuple[float, float],
) -> None:
    """Add the sliding work of a pair up to a time, note its pressure, and go on from there.

    Parameters
    ----------
    m : Model
    t : float
        Time over tau.
    k : int
        Index of the pair's history.
    sliding : tuple of float
        See `_sliding`.
    inside : float
        Place on the path of contact, in pitches.
    force : tuple of float
        And its rate.
    """
    own, away = m.work.exposing.pair[k], inside - m.scene.pitch_point
    speed, speed_rate = sliding[0] * away, sliding[1] * away
    if 0.0 < inside < m.scene.contact_ratio:
        speed_rate += sliding[0] * (sliding[2] if k < m.scene.slots else -sliding[2])
    if speed < 0.0:
        speed, speed_rate = -speed, -speed_rate
    power, power_rate = force[0] * speed, force[1] * speed + force[0] * speed_rate
    at, third = place_at(m, inside), (t - own.time) / 3.0
    # between ends that pull the power's cubic may rise above zero, but not above its control points
    rises = (
        own.power_rate > 0.0 > power_rate
        and max(own.power + third * own.power_rate, power - third * power_rate) > 0.0
    )
    if power > 0.0 or own.power > 0.0 or rises:
        work = _pushing(t - own.time, own.power, own.power_rate, power, power_rate)
        row = own.row + SLIDING * m.scene.places
        if at == own.at:
            m.rows[row + at] += work
        else:
            divide(m, row, own.place, inside, work)
        if force[0] > 0.0:
            note_pressure(m, own.row + PRESSURE * m.scene.places + at, inside, force[0])
    if at != own.at:
        if own.force > 0.0 or force[0] > 0.0:
            _note_crossings(m, t, k, inside, force)
        own.lowest = m.scene.cutoff  # another place
    own.time, own.place, own.at, own.power, own.power_rate = t, inside, at, power, power_rate
    own.force, own.force_rate = force
    own.pull = min(own.pull, power)


@compiled
def _note_crossings(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure where a pair has passed from one place to the next, on the cubic of its force.

    Parameters
    ----------
    m, t, k, inside, force
        As for `_slide`.
    """
    own, scale = m.work.exposing.pair[k], m.scene.places_per_pitch
    at, row = place_at(m, inside), own.row + PRESSURE * m.scene.places
    for place in range(min(own.at, at) + 1, max(own.at, at) + 1):
        edge = place / scale
        share = (edge - own.place) / (inside - own.place)
        pressing = cubic(share, t - own.time, own.force, own.force_rate, force[0], force[1])
        if pressing > 0.0:
            note_pressure(m, row + place - 1, edge, pressing)
            note_pressure(m, row + place, edge, pressing)


@compiled(inline=True)
def _pushing(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Sliding work over an interval of a contact while it pushes."""
    if power0 >= 0.0 and power1 >= 0.0:
        return max(integral(h, power0, power1, rate0, rate1), 0.0)
    return _pushing_partly(h, power0, rate0, power1, rate1)


@compiled
def _pushing_partly(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Do the same where it begins or ceases to push: of the power's cubic, what is above zero."""
    rise, slope0, slope1 = power1 - power0, h * rate0, h * rate1
    a, b = slope0 + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope0 - slope1
    total = 0.0
    for part in range(PARTS):
        s = (part + 0.5) / PARTS
        total += max(power0 + s * (slope0 + s * (b + s * a)), 0.0)
    return h * total / PARTS


@compiled
def _front(m: Model, y: Floats, k: int, gap: float, material: int) -> float:
    """Asperities of a material in contact per length, over their density."""
    own = m.scene.material[material]
    if m.scene.nodes > 0:
        return nodes_number(m, k, y, gap, material)
    height = joined_height(m.state.history[k].joined[material], gap, own.stretch_limit)
    return loading_value(m.tables, own.number_at, height + own.gap_offset)[0]


@compiled(inline=True)
def _joins(m: Model, k: int, gap: float) -> bool:
    """Whether asperities of a closing contact join: below what has joined before."""
    h, joins = m.state.history[k], m.scene.nodes > 0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        joins |= own.force_scale > 0.0 and (gap < h.joined[material] or own.stretch_limit == 0.0)
    return joins


@compiled
def _join(m: Model, y: Floats, k: int, gap: float, inside: float) -> None:
    """Add what has come into contact since that was last noted."""
    own, h = m.work.exposing.pair[k], m.state.history[k]
    for material in range(MATERIALS):
        law = m.scene.material[material]
        if law.force_scale <= 0.0:
            continue
        if own.turned != 0 and law.stretch_limit > 0.0 and m.scene.nodes == 0:  # what is left of the contact
            own.front[material] = -h.adhered_energy[material] / law.joining_energy
        front = _front(m, y, k, gap, material)
        joined = front - own.front[material]
        if joined <= 0.0:
            continue
        own.front[material] = front
        more = 0.5 * (contact_length(m, inside) + contact_length(m, own.place)) * joined
        spread(m, own.row + material * m.scene.places, own.place, inside, more)
        if law.stretch_limit > 0.0:
            lost = law.joining_energy * law.force_scale * more
            spread(m, own.row + (MATERIALS + material) * m.scene.places, own.place, inside, lost)
    own.turned = 0
