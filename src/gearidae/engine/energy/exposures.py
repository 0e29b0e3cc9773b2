r"""What the flanks are exposed to, tooth by tooth and place by place, kept at the solver's own steps.

For both flanks of every tooth of the pinion and every place along the path of contact four sums are kept, in `rows`:

- asperities that have come into contact, :math:`\int \ell\, d\Psi` for each material. What a contact has joined at an
  accepted time is :math:`\Psi(\zeta)`, with the play operator's joined height :math:`\zeta` there; all turning points
  are accepted times, so that nothing is missed between them;
- the energy that they have lost by it, in the proportion of the energy balance (where shares change with tooth and
  place, as if the material covered everything);
- sliding work :math:`\int W |v_s| dt` of contacts that push, :math:`v_s` being the sum of both gears' angular speeds
  times the distance from the pitch point. It is integrated over the intervals of the energy balance;
- the largest pressure, :math:`W / (L \sqrt{2 R \sigma})`, at the ends of these intervals and at turning points.

What falls into an interval in which a contact passes from one place to the next is divided in proportion. Contacts on
the tip relief count at the end of the path.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.calls import node_force, nodes_number
from gearidae.engine.energy.quadrature import integral
from gearidae.engine.model.coverage import note_shares, shares_of
from gearidae.engine.model.state import GEARS, MATERIALS, PHASE, Floats, Model, U, V, W
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
    "expose_turning",
    "follow_exposures",
]

QUANTITIES = 2 * MATERIALS + 2
"""Sums of a place: contacts and adhesion work of each material, sliding work, largest pressure."""
SEEN = 2
"""A pair that was near at the end of the last interval; one less while the next is looked at."""
PARTS = 16
"""Parts of an interval in which a contact begins or ceases to push."""
SLIDING, PRESSURE = 2 * MATERIALS, 2 * MATERIALS + 1


@compiled
def begin_exposures(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note what is in contact at a start; nothing is exposed yet."""
    if m.scene.places == 0:
        return
    m.work.exposure_time = t
    m.work.exposure_begun = 1
    for k in range(m.scene.histories):
        m.work.exposed[k].known = 0
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair == pair:
            own = m.work.exposed[k]
            for material in range(MATERIALS):
                own.front[material] = 0.0
            own.power = own.power_rate = 0.0
            _follow_pair(m, 0.0, t, y, yp, coast, pair, k)


@compiled
def follow_exposures(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Add what the flanks have been exposed to since the last interval, up to an accepted time.

    Parameters
    ----------
    m : Model
        With the histories before the event at this time, if there is one.
    t : float
        Time over tau.
    y, yp : ndarray
        State there and its rate.
    """
    h = t - m.work.exposure_time
    if m.scene.kind != GEARS or m.work.exposure_begun == 0 or h <= 0.0:
        return
    m.work.exposure_time = t
    for k in range(m.scene.histories):
        m.work.exposed[k].known = max(
            m.work.exposed[k].known - 1, 0
        )  # what is not near any more is forgotten
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair == pair:
            _follow_pair(m, h, t, y, yp, coast, pair, k)


@compiled
def expose_turning(m: Model, t: float, y: Floats, coast: int, pair: int, k: int) -> None:
    """Add what a contact has joined by its turning point, or note what is left of it, before the history takes that."""
    own = m.work.exposed[k]
    if own.known != SEEN or own.pair != pair:
        return
    gap, _, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    if gap < m.scene.cutoff:
        length = contact_length(m, inside)
        _join(m, y, coast, pair, k, gap, inside, 0.5 * (length + contact_length(m, own.place)))
        force, _ = _force(m, t, y, coast, pair, k)
        _note_pressure(m, coast, pair, inside, force / length)


@compiled
def close_exposures_at(place: int, t: float, y: Floats, yp: Floats) -> None:
    """`follow_exposures` of the model at a place, from `gearidae.engine.sundials.memory.Located`."""
    m = model_at(place)
    follow_exposures(m, t, y, yp)


@compiled
def _follow_pair(m: Model, h: float, t: float, y: Floats, yp: Floats, coast: int, pair: int, k: int) -> None:
    """Follow one pair over an interval, or begin with it if that has no length."""
    own = m.work.exposed[k]
    gap, _, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    booked = h > 0.0
    if gap >= m.scene.cutoff:
        own.known = 0
        return
    if booked and (own.known != 1 or own.pair != pair):  # it has come near since: nothing was joined
        for material in range(MATERIALS):
            own.front[material] = 0.0
        own.power = own.power_rate = 0.0
        own.place = inside
    if not booked:
        own.place = inside
    own.known, own.pair = SEEN, pair
    length = contact_length(m, inside)
    if booked:
        _join(m, y, coast, pair, k, gap, inside, 0.5 * (length + contact_length(m, own.place)))
    else:
        _note_front(m, y, k, gap)
    force, force_rate = _force(m, t, y, coast, pair, k)
    speed, speed_rate = _sliding_speed(m, coast, y, yp, inside)
    power = force * abs(speed)
    power_rate = force_rate * abs(speed) + (force * speed_rate if speed > 0.0 else -force * speed_rate)
    if booked:
        work = _pushing(h, own.power, own.power_rate, power, power_rate)
        if work != 0.0:
            _spread(m, _row(m, coast, pair, SLIDING), own.place, inside, work)
    _note_pressure(m, coast, pair, inside, force / length)
    own.place, own.power, own.power_rate = inside, power, power_rate


@compiled
def _pushing(h: float, power0: float, rate0: float, power1: float, rate1: float) -> float:
    """Sliding work over an interval of a contact while it pushes: of the power's cubic, what is above zero."""
    if power0 > 0.0 and power1 > 0.0:
        return max(integral(h, power0, power1, rate0, rate1), 0.0)
    if power0 <= 0.0 and power1 <= 0.0 and not (rate0 > 0.0 and rate1 < 0.0):
        return 0.0
    rise, slope0, slope1 = power1 - power0, h * rate0, h * rate1
    a, b = slope0 + slope1 - 2.0 * rise, 3.0 * rise - 2.0 * slope0 - slope1
    total = 0.0
    for part in range(PARTS):
        s = (part + 0.5) / PARTS
        total += max(power0 + s * (slope0 + s * (b + s * a)), 0.0)
    return h * total / PARTS


@compiled
def _force(m: Model, t: float, y: Floats, coast: int, pair: int, k: int) -> tuple[float, float]:
    """Force of a pair and its rate along the gap."""
    gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    if m.scene.nodes > 0:
        note_shares(m, k, coast, pair, inside)
        force, stiffness = node_force(m, k, True, t, y, gap, rate, contact_length(m, inside))
    else:
        force, stiffness = pair_force(m, k, True, t, gap, rate, inside, shares_of(m, k, coast, pair, inside))
    return force, stiffness * rate


@compiled
def _front(m: Model, y: Floats, k: int, gap: float, material: int) -> float:
    """Asperities of a material in contact per length, over their density."""
    own = m.scene.material[material]
    if m.scene.nodes > 0:
        return nodes_number(m, k, y, gap, material)
    height = joined_height(m.state.history[k].joined[material], gap, own.stretch_limit)
    return loading_value(m.tables, own.number_at, height + own.gap_offset)[0]


@compiled
def _note_front(m: Model, y: Floats, k: int, gap: float) -> None:
    """Note what is in contact."""
    for material in range(MATERIALS):
        if m.scene.material[material].force_scale > 0.0:
            m.work.exposed[k].front[material] = _front(m, y, k, gap, material)


@compiled
def _join(
    m: Model, y: Floats, coast: int, pair: int, k: int, gap: float, inside: float, length: float
) -> None:
    """Add what has come into contact since that was last noted."""
    own = m.work.exposed[k]
    for material in range(MATERIALS):
        law = m.scene.material[material]
        if law.force_scale <= 0.0:
            continue
        front = _front(m, y, k, gap, material)
        more = length * (front - own.front[material])
        own.front[material] = front
        if more > 0.0:
            _spread(m, _row(m, coast, pair, material), own.place, inside, more)
            if law.stretch_limit > 0.0:
                lost = law.joining_energy * law.force_scale * more
                _spread(m, _row(m, coast, pair, MATERIALS + material), own.place, inside, lost)


@compiled
def _sliding_speed(m: Model, coast: int, y: Floats, yp: Floats, inside: float) -> tuple[float, float]:
    """Sliding speed of a contact, in the unit of speed, and its rate."""
    s = m.scene
    turn, turn_rate = y[V] + y[W], yp[V] + yp[W]
    if s.error_count != 0:
        turn /= 1.0 - static_error(m, y[U], y[PHASE])[2]
    unit = s.length_unit
    together = unit * (turn / s.pinion_radius + y[W] / s.gear_radius)
    together_rate = unit * (turn_rate / s.pinion_radius + yp[W] / s.gear_radius)
    away = (inside - 0.5 * (s.coast_phase - 0.5)) / s.phase_rate
    moving = y[W] if coast == 0 else -y[W]
    return together * away, together_rate * away + together * moving


@compiled
def _row(m: Model, coast: int, pair: int, quantity: int) -> int:
    """Where a quantity of the pair's tooth begins among the rows."""
    teeth = int(m.scene.pinion_teeth)
    tooth = (pair + int(m.state.turns)) % teeth
    return m.scene.exposures_at + ((coast * teeth + tooth) * QUANTITIES + quantity) * m.scene.places


@compiled
def _spread(m: Model, row: int, before: float, after: float, amount: float) -> None:
    """Add an amount to the places that a contact has passed, in proportion to the way in each."""
    places = m.scene.places
    low = places * min(before, after) / m.scene.contact_ratio
    high = places * max(before, after) / m.scene.contact_ratio
    first, last = min(int(low), places - 1), min(int(high), places - 1)
    if first == last:
        m.rows[row + first] += amount
        return
    for place in range(first, last + 1):
        way = min(high, place + 1.0) - max(low, float(place))
        m.rows[row + place] += amount * way / (high - low)


@compiled
def _note_pressure(m: Model, coast: int, pair: int, inside: float, pressure: float) -> None:
    """Note the pressure of a contact where it is the largest so far."""
    place = min(int(m.scene.places * inside / m.scene.contact_ratio), m.scene.places - 1)
    at = _row(m, coast, pair, PRESSURE) + place
    m.rows[at] = max(m.rows[at], pressure)
