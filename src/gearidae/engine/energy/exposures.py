r"""What the flanks are exposed to, tooth by tooth and place by place, kept at the solver's own steps.

For both flanks of every tooth of the pinion and every place along the path of contact four sums are kept, in `rows`:

- asperities that have come into contact, :math:`\int \ell\, d\Psi` for each material. What a contact has joined at an
  accepted time is :math:`\Psi(\zeta)`, with the play operator's joined height :math:`\zeta` there; all turning points
  are accepted times, so that nothing is missed between them;
- the energy that they have lost by it, in the proportion of the energy balance (where shares change with tooth and
  place, as if the material covered everything);
- sliding work :math:`\int W |v_s| dt` of contacts that push, :math:`v_s` being the sum of both gears' angular speeds
  times the distance from the pitch point. It is integrated over one to six steps at once, the fewer the larger its
  error is estimated, and to every onset and separation; the forces are those of Newton's iteration
  (`gearidae.engine.energy.noted_force`);
- the largest pressure, :math:`W / (L \sqrt{2 R \sigma})`, at the same times, at turning points, and where a contact
  passes from one place to the next.

An elastic contact is looked at as often as the energy balance closes an interval. Where a contact passes from one place
to the next in such an interval, what it has joined is divided by its gap there, on the cubic of the gap; of elastic
contacts, and of sliding work, in proportion to the way. Contacts on the tip relief count at the end of the path.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.calls import node_force, nodes_number
from gearidae.engine.energy.noted_force import begin_notes, note_force
from gearidae.engine.energy.places import note_pressure, place_at
from gearidae.engine.energy.sliding import PRESSURE, add_sliding, sliding_speeds, speeds_here
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
)
from gearidae.engine.sundials.memory import model_at

__all__ = [
    "PRESSURE",
    "QUANTITIES",
    "begin_exposures",
    "close_exposures_at",
    "expose_step",
    "expose_touch",
    "expose_turning",
    "follow_exposures",
]

QUANTITIES = 2 * MATERIALS + 2
"""Sums of a place: contacts and adhesion work of each material, sliding work, largest pressure."""
MOST_STEPS = 6
"""Accepted steps over which sliding work is integrated at once, where its error estimate allows."""
ALLOWED = 1e-3
"""Error estimate of sliding work, over the work, from which on fewer steps are taken at once."""
MODEST = 1.0 / 16.0
"""Of that, up to which more are."""
FADING = 0.9
"""What is left of both from one interval to the next."""


@compiled
def begin_exposures(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note what is in contact at a start; nothing is exposed yet."""
    if m.scene.places == 0:
        return
    m.work.exposing.time, m.work.exposing.begun = t, 1
    m.work.exposing.work = m.work.exposing.error = 0.0
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
        sliding = sliding_speeds(m, y, yp[V], yp[W])
        push = noted.force, noted.slope * noted.gap_rate
        add_sliding(m, t, k, sliding, noted.place, (noted.gap, noted.gap_rate), push)


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
    sliding = sliding_speeds(m, y, yp[V], yp[W])
    moved = y[U] - m.work.notes.travel
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        k = noted.history
        if m.state.history[k].pair != noted.pair:
            continue
        _begin_new(m, k, noted.pair, noted.place)
        widened = -moved if k < m.scene.slots else moved
        gap = noted.gap + widened
        if m.state.history[k].direction <= 0.0 and _joins(m, k, gap):
            _join(m, t, y, k, noted.place, (gap, noted.gap_rate))
        push = noted.force + noted.slope * widened, noted.slope * noted.gap_rate
        add_sliding(m, t, k, sliding, noted.place, (gap, noted.gap_rate), push)
    exposing.time = t
    _wait(m, _steps_at_once(m))


@compiled(inline=True)
def _steps_at_once(m: Model) -> int:
    """Steps over which to integrate sliding work next, by its error estimate in the last intervals."""
    exposing = m.work.exposing
    exposing.work *= FADING
    exposing.error *= FADING
    allowed = ALLOWED * exposing.work
    if exposing.error > allowed:
        return max(exposing.wanted // 2, 1)
    if exposing.error > MODEST * allowed:
        return exposing.wanted
    return min(exposing.wanted + 1, MOST_STEPS)


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
    gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    if m.work.exposing.begun == 0 or gap >= m.scene.cutoff:
        return
    own = m.work.exposing.pair[k]
    _begin_new(m, k, pair, inside)
    if m.state.history[k].direction > 0.0:
        own.turned = 1
        for material in range(MATERIALS):
            law = m.scene.material[material]
            if law.force_scale > 0.0 and (law.stretch_limit == 0.0 or m.scene.nodes > 0):
                own.front[material] = _front(m, y, k, gap, material)
        return
    _join(m, t, y, k, inside, (gap, 0.0))
    at, closely = place_at(m, inside), m.work.exposing.wanted < MOST_STEPS
    if closely or gap < own.lowest or at != own.at:
        own.lowest = min(own.lowest, gap)
        if m.scene.nodes == 0:
            rate = 0.0  # but for rounding, which is not to send the history through this point
        force, _ = _force(m, t, y, (coast, pair, k), (gap, rate, inside))
        if closely:  # the slope of the force has a jump here
            add_sliding(m, t, k, speeds_here(m, y), inside, (gap, 0.0), (force, 0.0))
        elif force > 0.0:
            note_pressure(m, own.row + PRESSURE * m.scene.places + at, inside, force)


@compiled
def expose_touch(m: Model, t: float, y: Floats, coast: int, pair: int, k: int) -> None:
    """Add what a contact has been exposed to up to its onset or separation, and take single steps from there."""
    if m.work.exposing.begun == 0:
        return
    gap, rate, _, inside = pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])
    _begin_new(m, k, pair, inside)
    force, slope = _force(m, t, y, (coast, pair, k), (gap, rate, inside))
    add_sliding(m, t, k, speeds_here(m, y), inside, (gap, rate), (force, slope * rate))
    _wait(m, 1)


@compiled
def close_exposures_at(place: int, t: float, y: Floats, yp: Floats) -> None:
    """`follow_exposures` of the model at a place, from `gearidae.engine.sundials.memory.Located`."""
    m = model_at(place)
    follow_exposures(m, t, y, yp)


@compiled(inline=True)
def _begin_new(m: Model, k: int, pair: int, inside: float) -> None:
    """Begin with a pair that has come near since the exposures of all pairs were last added up."""
    own, before = m.work.exposing.pair[k], m.work.exposing.time
    if own.known == 0 or own.pair != pair or own.time < before:
        _begin_pair(m, before, k, pair, inside)


@compiled
def _begin_pair(m: Model, t: float, k: int, pair: int, inside: float) -> None:
    """Begin with a pair in which nothing is in contact."""
    own = m.work.exposing.pair[k]
    own.known, own.pair, own.time = 1, pair, t
    own.place, own.at = inside, place_at(m, inside)
    own.turned, own.lowest = 0, m.scene.cutoff
    own.power = own.power_rate = own.force = own.force_rate = own.gap_rate = 0.0
    own.gap = m.scene.cutoff
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
def _join(m: Model, t: float, y: Floats, k: int, inside: float, gap: tuple[float, float]) -> None:
    """Add what has come into contact since that was last noted, up to a gap, given with its rate."""
    own, h = m.work.exposing.pair[k], m.state.history[k]
    for material in range(MATERIALS):
        law = m.scene.material[material]
        if law.force_scale <= 0.0:
            continue
        if own.turned != 0 and law.stretch_limit > 0.0 and m.scene.nodes == 0:  # what is left of the contact
            own.front[material] = -h.adhered_energy[material] / law.joining_energy
        front = _front(m, y, k, gap[0], material)
        if front <= own.front[material]:
            continue
        length = 0.5 * (contact_length(m, inside) + contact_length(m, own.place))
        if place_at(m, inside) == own.at:
            _add_joined(m, k, material, own.at, length * (front - own.front[material]))
        else:
            _divide_joined(m, t, y, k, material, (inside, gap[0], gap[1]), (front, length))
        own.front[material] = front
    own.turned = 0


@compiled
def _divide_joined(
    m: Model,
    t: float,
    y: Floats,
    k: int,
    material: int,
    there: tuple[float, float, float],
    joined: tuple[float, float],
) -> None:
    """Divide what a pair has joined between the places that it has passed, by its gap on the way.

    Parameters
    ----------
    m, t, y, k, material
        As for `_join`.
    there : tuple of float
        Place, gap and gap rate at that time.
    joined : tuple of float
        Number of asperities in contact there, over their density, and the contact's length.
    """
    own, (inside, gap, rate), (last, length) = m.work.exposing.pair[k], there, joined
    at, first = own.at, own.front[material]
    step, before = 1 if inside > own.place else -1, first
    while at != place_at(m, inside):
        edge = (at + 1 if step > 0 else at) / m.scene.places_per_pitch
        share = (edge - own.place) / (inside - own.place)
        front = first + share * (last - first)
        if m.scene.nodes == 0:  # of elastic contacts the deflection on the way is not known
            passing = cubic(share, t - own.time, own.gap, own.gap_rate, gap, rate)
            front = min(max(_front(m, y, k, passing, material), before), last)
        _add_joined(m, k, material, at, length * (front - before))
        at, before = at + step, front
    _add_joined(m, k, material, at, length * (last - before))


@compiled(inline=True)
def _add_joined(m: Model, k: int, material: int, at: int, more: float) -> None:
    """Add asperity contacts of a material to a place, and what they have lost."""
    row, law = m.work.exposing.pair[k].row, m.scene.material[material]
    m.rows[row + material * m.scene.places + at] += more
    if law.stretch_limit > 0.0:
        m.rows[row + (MATERIALS + material) * m.scene.places + at] += (
            law.joining_energy * law.force_scale * more
        )
