r"""Asperity contacts that closing pairs have made, and the energy lost by them, tooth by tooth and place by place.

A contact of length :math:`\ell` that closes from one turning point to the next makes :math:`\int \ell\, d\Psi` contacts
of each material, with :math:`\Psi` those per length. The energy balance follows how much less that is than the length
times the rise of :math:`\Psi` (the lag, `gearidae.engine.followers.joining`): of rigid bodies with hysteresis and
uniform coverage, contacts are added up at turning points, and where a contact leaves a place. Of others, the lag of
each material is not known: there they are added up as often as sliding work is, with the mean length.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.elastic.energy import nodes_number
from gearidae.engine.followers.exposures.bins import ROWS, bin_at, share_at_edge
from gearidae.engine.formulas.interpolation import cubic
from gearidae.engine.model.state import MATERIALS, Floats, Model
from gearidae.engine.pairs.tooth_pairs import contact_length


@compiled
def adds_often(m: Model) -> bool:
    """Whether contacts are added up wherever sliding work is, as the lag of each material is not known."""
    often = m.scene.nodes > 0 or m.scene.by_place != 0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        often |= own.force_scale > 0.0 and own.stretch_limit == 0.0
    return often


@compiled
def begin_contacts(m: Model, y: Floats, k: int, inside: float, gap: float) -> None:
    """Begin with what a pair has in contact at a start."""
    own = m.work.exposing.pair[k]
    missing = _note_numbers(m, y, k, gap)
    for material in range(MATERIALS):
        own.front[material] = own.number[material]
        own.added[material] = (contact_length(m, inside) - missing) * (
            own.number[material] - own.base[material]
        )


@compiled
def turn_to_closing(m: Model, y: Floats, k: int, gap: float) -> None:
    """Begin again where a contact turns round from opening to closing, before its history takes that."""
    own = m.work.exposing.pair[k]
    own.turned = 1
    for material in range(MATERIALS):
        law = m.scene.material[material]
        if law.force_scale > 0.0 and (law.stretch_limit == 0.0 or m.scene.nodes > 0):
            own.front[material] = _front(m, y, k, gap, material)


@compiled(inline=True)
def joins_here(m: Model, k: int, inside: float, gap: float) -> bool:
    """Whether a contact that may be closing is to be added up: it has left its place, or the lag is not known."""
    if m.state.history[k].direction > 0.0:
        return False
    often = m.work.exposing.often != 0
    return (often or bin_at(m, inside) != m.work.exposing.pair[k].bin) and joins(m, k, gap)


@compiled(inline=True)
def joins(m: Model, k: int, gap: float) -> bool:
    """Whether asperities of a closing contact join: below what has joined before."""
    h, found = m.state.history[k], m.scene.nodes > 0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        found |= own.force_scale > 0.0 and (gap < h.joined[material] or own.stretch_limit == 0.0)
    return found


@compiled
def join(m: Model, t: float, y: Floats, k: int, inside: float, gap: tuple[float, float]) -> None:
    """Add the contacts that a pair has made since that was last done, up to a gap, given with its rate."""
    own, often = m.work.exposing.pair[k], m.work.exposing.often != 0
    missing = _note_numbers(m, y, k, gap[0])
    here, length = bin_at(m, inside), contact_length(m, inside)
    mean = 0.5 * (length + contact_length(m, own.position)) if often else length - missing
    for material in range(MATERIALS):
        if own.turned != 0 and m.scene.material[material].stretch_limit > 0.0 and m.scene.nodes == 0:
            own.front[material], own.added[material] = own.base[material], 0.0
        rise = own.number[material] - own.front[material]
        if rise <= 0.0:
            continue
        more = mean * rise
        if not often:
            total = mean * (own.number[material] - own.base[material])
            more = max(total - own.added[material], 0.0)
            own.added[material] = total
        if here == own.bin:
            _add(m, k, material, here, more)
        else:
            _divide(m, t, y, k, material, (inside, gap[0], gap[1]), more)
        own.front[material] = own.number[material]
    own.turned = 0


@compiled(inline=True)
def _note_numbers(m: Model, y: Floats, k: int, gap: float) -> float:
    """Note what a pair has in contact at a gap, and had at its last turning point.

    Returns
    -------
    float
        By how much shorter the contact was on average when its contacts were made, from the lag of rigid bodies.
    """
    own, h, lost = m.work.exposing.pair[k], m.state.history[k], 0.0
    for material in range(MATERIALS):
        law = m.scene.material[material]
        own.number[material] = own.base[material] = 0.0
        if law.force_scale <= 0.0:
            continue
        own.number[material] = _front(m, y, k, gap, material)
        if law.stretch_limit > 0.0 and m.scene.nodes == 0:
            own.base[material] = -h.adhered_energy[material] / law.joining_energy
            lost += law.joining_energy * law.force_scale * (own.number[material] - own.base[material])
    return h.lag / lost if lost > 0.0 else 0.0


@compiled(inline=True)
def _front(m: Model, y: Floats, k: int, gap: float, material: int) -> float:
    """Asperities of a material in contact per length, over their density."""
    own = m.scene.material[material]
    if m.scene.nodes > 0:
        return nodes_number(m, k, y, gap, material)
    height = joined_height(m.state.history[k].joined[material], gap, own.stretch_limit)
    return loading_value(m.tables, own.number_at, height + own.gap_offset)[0]


@compiled
def _divide(
    m: Model, t: float, y: Floats, k: int, material: int, there: tuple[float, float, float], more: float
) -> None:
    """Divide what a pair has made between the places that it has passed, by its gap on the way.

    Parameters
    ----------
    m, t, y, k, material
        As for `join`.
    there : tuple of float
        Place, gap and gap rate at that time.
    more : float
        What it has made.
    """
    own, (inside, gap, rate) = m.work.exposing.pair[k], there
    last, first = own.number[material], own.front[material]
    here, step, before = own.bin, 1 if inside > own.position else -1, first
    while here != bin_at(m, inside):
        share = share_at_edge(m, here, own.position, inside)
        front = first + share * (last - first)
        if m.scene.nodes == 0:  # of elastic contacts the deflection on the way is not known
            passing = cubic(share, t - own.time, own.gap, own.gap_rate, gap, rate)
            front = min(max(_front(m, y, k, passing, material), before), last)
        _add(m, k, material, here, more * (front - before) / (last - first))
        here, before = here + step, front
    _add(m, k, material, here, more * (last - before) / (last - first))


@compiled(inline=True)
def _add(m: Model, k: int, material: int, here: int, more: float) -> None:
    """Add contacts of a material to a place, and what they have lost."""
    row, law = m.work.exposing.pair[k].row, m.scene.material[material]
    m.rows[row + (ROWS.contacts + material) * m.scene.bins + here] += more
    if law.stretch_limit > 0.0:
        m.rows[row + (ROWS.adhesion + material) * m.scene.bins + here] += (
            law.joining_energy * law.force_scale * more
        )
