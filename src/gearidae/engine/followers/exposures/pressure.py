"""Largest pressure of a pair in each place along the path of contact, from one look at its force to the next."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap
from gearidae.engine.followers.exposures.bins import ROWS, bin_at
from gearidae.engine.formulas.interpolation import cubic
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.tooth_pairs import contact_length


@compiled(inline=True)
def see_pressure(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure of a pair, and that where it has passed from one place to the next since the last look.

    Parameters
    ----------
    t : float
        Time over tau.
    k : int
        Index of the pair's history.
    inside : float
        Place on the path of contact, in pitches.
    force : tuple of float
        Force there, with its rate.
    """
    own, here = m.work.exposing.pair[k], bin_at(m, inside)
    if force[0] > 0.0:
        note_pressure(m, k, here, inside, force[0])
    if m.scene.population.flanks != 0 and t > own.seen_time and own.force_rate > 0.0 > force[1]:
        # its turning points are no events
        peak = extreme_gap(t - own.seen_time, own.force, own.force_rate, force[0], force[1])
        if peak > 0.0 and here == own.seen_bin:
            note_pressure(m, k, here, inside, peak)
    if here != own.seen_bin:
        if own.force > 0.0 or force[0] > 0.0:
            _note_crossings(m, t, k, inside, force)
        own.lowest = m.scene.cutoff  # another place
    own.seen_time, own.seen_position, own.seen_bin = t, inside, here
    own.force, own.force_rate = force


@compiled(inline=True)
def note_pressure(m: Model, k: int, here: int, inside: float, force: float) -> None:
    """Note the pressure of a contact in a place, where it is the largest so far."""
    row = m.work.exposing.pair[k].row + ROWS.pressure * m.scene.bins + here
    radius = m.scene.start_radius + inside
    # of squares: a root only where there is something to note
    if force * force > m.rows[row] * m.rows[row] * (radius - radius * radius * m.scene.sum_curvature):
        m.rows[row] = force / contact_length(m, inside)


@compiled
def _note_crossings(m: Model, t: float, k: int, inside: float, force: tuple[float, float]) -> None:
    """Note the pressure where a pair has passed from one place to the next, on the cubic of its force.

    Parameters
    ----------
    m, t, k, inside, force
        As for `see_pressure`.
    """
    own, here = m.work.exposing.pair[k], bin_at(m, inside)
    for place in range(min(own.seen_bin, here) + 1, max(own.seen_bin, here) + 1):
        edge = place / m.scene.bins_per_pitch
        share = (edge - own.seen_position) / (inside - own.seen_position)
        pressing = cubic(share, t - own.seen_time, own.force, own.force_rate, force[0], force[1])
        if pressing > 0.0:
            note_pressure(m, k, place - 1, edge, pressing)
            note_pressure(m, k, place, edge, pressing)
