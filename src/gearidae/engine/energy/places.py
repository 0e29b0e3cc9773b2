"""Places along the path of contact, into which the exposures of a tooth are divided."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model
from gearidae.engine.model.tooth_pairs import contact_length

__all__ = ["divide", "note_pressure", "place_at"]


@compiled(inline=True)
def place_at(m: Model, inside: float) -> int:
    """Index of the place along the path of contact, whose end belongs to the last one."""
    return min(int(m.scene.places_per_pitch * inside), m.scene.places - 1)


@compiled
def divide(m: Model, row: int, before: float, after: float, amount: float) -> None:
    """Divide an amount between places, by the way from one point of the path of contact to another."""
    places, scale = m.scene.places, m.scene.places_per_pitch
    low, high = scale * min(before, after), scale * max(before, after)
    for place in range(min(int(low), places - 1), min(int(high), places - 1) + 1):
        way = min(high, place + 1.0) - max(low, float(place))
        m.rows[row + place] += amount * way / (high - low)


@compiled(inline=True)
def note_pressure(m: Model, at: int, inside: float, force: float) -> None:
    """Note the pressure of a contact in its place, among the rows, where it is the largest so far."""
    radius = m.scene.start_radius + inside
    # of squares: a root only where there is something to note
    if force * force > m.rows[at] * m.rows[at] * (radius - radius * radius * m.scene.sum_curvature):
        m.rows[at] = force / contact_length(m, inside)
