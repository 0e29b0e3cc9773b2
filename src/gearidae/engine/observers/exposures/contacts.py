r"""Asperity contacts that closing pairs have made, and the energy lost by them, tooth by tooth and bin by bin.

A contact of length :math:`\ell` that closes from one turning point to the next makes :math:`\int \ell\, d\Psi` contacts
of each material, with :math:`\Psi` those per length. The energy balance follows how much less that is than the length
times the rise of :math:`\Psi` (the lag, `gearidae.engine.observers.adhesion_loss`): of rigid bodies with hysteresis and
uniform coverage, contacts are added up at turning points, and where a contact leaves a bin. Of others, the lag of
each material is not known: there they are added up as often as sliding work is, with the mean length.

Asperities of a population each count in their bin of the flank, and lose when they join and when they detach, as in
the energy balance. The largest pressure of a pair is followed from one look at its force to the next.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import extreme_gap
from gearidae.engine.compiling import EXPOSURES
from gearidae.engine.laws.discrete import candidate_energy
from gearidae.engine.laws.pairs import asperities_in_contact
from gearidae.engine.model.state import MATERIALS, Floats, Model
from gearidae.engine.observers.exposures.bins import ROWS, bin_at, row_of, share_at_edge
from gearidae.engine.pairs.tooth_pairs import contact_length, list_known
from gearidae.engine.population.contact_point import pair_of, position_of_arc, spot_at
from gearidae.engine.population.layout import ARC, HEIGHT, K_MATERIAL, KIND, REMEMBERED, SIGN, column
from gearidae.formulas.interpolation import cubic


@compiled
def adds_often(m: Model) -> bool:
    """Whether contacts are added up wherever sliding work is, as the lag of each material is not known."""
    often = m.scene.nodes > 0 or m.scene.covered_by_position != 0
    for material in range(MATERIALS):
        surface = m.scene.material[material]
        often |= surface.force_scale > 0.0 and surface.stretch_limit == 0.0
    return often


@compiled
def begin_contacts(m: Model, y: Floats, k: int, inside: float, gap: float) -> None:
    """Begin with what a pair has in contact at a start."""
    exposure = m.work.exposing.pair[k]
    missing = _note_numbers(m, y, k, gap)
    for material in range(MATERIALS):
        exposure.front[material] = exposure.number[material]
        exposure.added[material] = (contact_length(m, inside) - missing) * (
            exposure.number[material] - exposure.base[material]
        )


@compiled
def turn_to_closing(m: Model, y: Floats, k: int, gap: float) -> None:
    """Begin again where a contact turns round from opening to closing, before its history takes that."""
    exposure = m.work.exposing.pair[k]
    exposure.turned = 1
    for material in range(MATERIALS):
        law = m.scene.material[material]
        if law.force_scale > 0.0 and (law.stretch_limit == 0.0 or m.scene.nodes > 0):
            exposure.front[material] = asperities_in_contact(m, k, y, gap, material)


@compiled(inline=True)
def joins_here(m: Model, k: int, inside: float, gap: float) -> bool:
    """Whether a contact that may be closing is to be added up: it has left its bin, or the lag is not known."""
    if m.state.history[k].direction > 0.0:
        return False
    often = m.work.exposing.often != 0
    return (often or bin_at(m, inside) != m.work.exposing.pair[k].bin) and joins(m, k, gap)


@compiled(inline=True)
def joins(m: Model, k: int, gap: float) -> bool:
    """Whether asperities of a closing contact join: below what has joined before."""
    h, joining = m.state.history[k], m.scene.nodes > 0
    for material in range(MATERIALS):
        surface = m.scene.material[material]
        joining |= surface.force_scale > 0.0 and (gap < h.joined[material] or surface.stretch_limit == 0.0)
    return joining


@compiled
def join(m: Model, t: float, y: Floats, k: int, inside: float, gap: tuple[float, float]) -> None:
    """Add the contacts that a pair has made since that was last done, up to a gap, given with its rate."""
    exposure, often = m.work.exposing.pair[k], m.work.exposing.often != 0
    missing = _note_numbers(m, y, k, gap[0])
    here, length = bin_at(m, inside), contact_length(m, inside)
    mean = 0.5 * (length + contact_length(m, exposure.position)) if often else length - missing
    for material in range(MATERIALS):
        if exposure.turned != 0 and m.scene.material[material].stretch_limit > 0.0 and m.scene.nodes == 0:
            exposure.front[material], exposure.added[material] = exposure.base[material], 0.0
        rise = exposure.number[material] - exposure.front[material]
        if rise <= 0.0:
            continue
        more = mean * rise
        if not often:
            total = mean * (exposure.number[material] - exposure.base[material])
            more = max(total - exposure.added[material], 0.0)
            exposure.added[material] = total
        if here == exposure.bin:
            _add(m, k, material, here, more)
        else:
            _divide(m, t, y, k, material, (inside, gap[0], gap[1]), more)
        exposure.front[material] = exposure.number[material]
    exposure.turned = 0


@compiled(inline=True)
def _note_numbers(m: Model, y: Floats, k: int, gap: float) -> float:
    """Note what a pair has in contact at a gap, and had at its last turning point.

    Returns
    -------
    float
        By how much shorter the contact was on average when its contacts were made, from the lag of rigid bodies.
    """
    exposure, h, lost = m.work.exposing.pair[k], m.state.history[k], 0.0
    for material in range(MATERIALS):
        law = m.scene.material[material]
        exposure.number[material] = exposure.base[material] = 0.0
        if law.force_scale <= 0.0:
            continue
        exposure.number[material] = asperities_in_contact(m, k, y, gap, material)
        if law.stretch_limit > 0.0 and m.scene.nodes == 0:
            exposure.base[material] = -h.adhered_energy[material] / law.joining_energy
            lost += (
                law.joining_energy * law.force_scale * (exposure.number[material] - exposure.base[material])
            )
    return h.adhesion_lag / lost if lost > 0.0 else 0.0


@compiled
def _divide(
    m: Model, t: float, y: Floats, k: int, material: int, there: tuple[float, float, float], more: float
) -> None:
    """Divide what a pair has made between the bins that it has passed, by its gap on the way.

    Parameters
    ----------
    m, t, y, k, material
        As for `join`.
    there : tuple of float
        Position, gap and gap rate at that time.
    more : float
        What it has made.
    """
    exposure, (inside, gap, rate) = m.work.exposing.pair[k], there
    last, first = exposure.number[material], exposure.front[material]
    here, step, before = exposure.bin, 1 if inside > exposure.position else -1, first
    while here != bin_at(m, inside):
        share = share_at_edge(m, here, exposure.position, inside)
        front = first + share * (last - first)
        if m.scene.nodes == 0:  # of elastic contacts the deflection on the way is not known
            passing = cubic(share, t - exposure.time, exposure.gap, exposure.gap_rate, gap, rate)
            front = min(max(asperities_in_contact(m, k, y, passing, material), before), last)
        _add(m, k, material, here, more * (front - before) / (last - first))
        here, before = here + step, front
    _add(m, k, material, here, more * (last - before) / (last - first))


@compiled(inline=True)
def _add(m: Model, k: int, material: int, here: int, more: float) -> None:
    """Add contacts of a material to a bin, and what they have lost."""
    row, law = m.work.exposing.pair[k].row, m.scene.material[material]
    m.rows[row + (ROWS.contacts + material) * m.scene.bins + here] += more
    if law.stretch_limit > 0.0:
        m.rows[row + (ROWS.adhesion + material) * m.scene.bins + here] += (
            law.joining_energy * law.force_scale * more
        )


@compiled(inline=True)
def see_pressure(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure of a pair, and that where it has passed from one bin to the next since the last look.

    Parameters
    ----------
    t : float
        Time over tau.
    k : int
        Index of the pair's history.
    inside : float
        Position on the path of contact, in pitches.
    force : tuple of float
        Force there, with its rate.
    """
    exposure, here = m.work.exposing.pair[k], bin_at(m, inside)
    if force[0] > 0.0:
        note_pressure(m, k, here, inside, force[0])
    if m.scene.population.flanks != 0 and t > exposure.seen_time and exposure.force_rate > 0.0 > force[1]:
        # its turning points are no events
        peak = extreme_gap(t - exposure.seen_time, exposure.force, exposure.force_rate, force[0], force[1])
        if peak > 0.0 and here == exposure.seen_bin:
            note_pressure(m, k, here, inside, peak)
    if here != exposure.seen_bin:
        if exposure.force > 0.0 or force[0] > 0.0:
            _note_crossings(m, t, k, inside, force)
        exposure.lowest = m.scene.cutoff  # another bin
    exposure.seen_time, exposure.seen_position, exposure.seen_bin = t, inside, here
    exposure.force, exposure.force_rate = force


@compiled(inline=True)
def note_pressure(m: Model, k: int, here: int, inside: float, force: float) -> None:
    """Note the pressure of a contact in a bin, where it is the largest so far."""
    row = m.work.exposing.pair[k].row + ROWS.pressure * m.scene.bins + here
    radius = m.scene.start_radius + inside
    # of squares: a root only where there is something to note
    if force * force > m.rows[row] * m.rows[row] * (radius - radius * radius * m.scene.sum_curvature):
        m.rows[row] = force / contact_length(m, inside)


@compiled
def _note_crossings(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure where a pair has passed from one bin to the next, on the cubic of its force.

    Parameters
    ----------
    m, t, k, inside, force
        As for `see_pressure`.
    """
    exposure, here = m.work.exposing.pair[k], bin_at(m, inside)
    for number in range(min(exposure.seen_bin, here) + 1, max(exposure.seen_bin, here) + 1):
        edge = number / m.scene.bins_per_pitch
        share = (edge - exposure.seen_position) / (inside - exposure.seen_position)
        pressing = cubic(
            share, t - exposure.seen_time, exposure.force, exposure.force_rate, force[0], force[1]
        )
        if pressing > 0.0:
            note_pressure(m, k, number - 1, edge, pressing)
            note_pressure(m, k, number, edge, pressing)


@compiled_once(EXPOSURES)
def add_asperity_switches(m: Model, y: Floats) -> None:
    """Add what has joined or detached at a root, after `switch_asperities` has found it and before it is recorded."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        contact, now = m.work.contact[k], pair_of(m, k, y)
        row = row_of(m, now.flank, now.number)
        at = spot_at(m, now.position, now.moves)
        half_curvature = 0.5 * m.scene.population.steepness / at.radius
        for n in range(contact.asperity_switches):
            j = int(m.rows[column(m, k, REMEMBERED) + n])
            arc, kind = m.rows[column(m, k, ARC) + j], int(m.rows[column(m, k, KIND) + j])
            x = arc - at.arc
            energy = candidate_energy(
                m, kind, m.rows[column(m, k, HEIGHT) + j] - now.gap - half_curvature * x * x
            )
            here = row + bin_at(m, position_of_arc(m, arc))
            material = int(m.tables[kind + K_MATERIAL])
            lost = here + (ROWS.adhesion + material) * m.scene.bins
            if m.rows[column(m, k, SIGN) + j] > 0.0:
                m.rows[here + (ROWS.contacts + material) * m.scene.bins] += 1.0
                m.rows[lost] -= energy
            else:
                m.rows[lost] += energy
