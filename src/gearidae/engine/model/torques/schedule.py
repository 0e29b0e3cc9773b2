"""Schedule of a torque: linear between its knots, constant outside them.

The current segment is part of the state and not searched: it changes at knots only, so that a step never sees two of
them.
"""

from __future__ import annotations

from collections.abc import Iterable

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model

__all__ = ["enter_segment", "pack_schedule", "schedule_rate", "schedule_value"]


def pack_schedule(
    schedule: Iterable[tuple[float, float]], time_unit: float, torque_unit: float
) -> list[float]:
    """Lay a schedule out as the functions below read it.

    Parameters
    ----------
    schedule : iterable of (time, value)
        [s], [N m].
    time_unit, torque_unit : float
        tau [s] and F R [N m].
    """
    return [x for t, value in schedule for x in (t / time_unit, value / torque_unit)]


@compiled(inline=True)
def schedule_value(m: Model, shaft: int, t: float, value: float) -> float:
    """Add the schedule at a time to a value."""
    own = m.scene.torque[shaft]
    knots = own.knot_count
    if knots > 0:
        k, j = own.knots_at, m.state.segment[shaft]
        if j == 0:
            value += m.tables[k + 1]
        elif j == knots:
            value += m.tables[k + 2 * knots - 1]
        else:
            k += 2 * j
            share = (t - m.tables[k - 2]) / (m.tables[k] - m.tables[k - 2])
            value += m.tables[k - 1] + share * (m.tables[k + 1] - m.tables[k - 1])
    return value


@compiled
def schedule_rate(m: Model, shaft: int) -> float:
    """Rate of change of the schedule."""
    own = m.scene.torque[shaft]
    k, j = own.knots_at, m.state.segment[shaft]
    if not 0 < j < own.knot_count:
        return 0.0
    k += 2 * j
    return (m.tables[k + 1] - m.tables[k - 1]) / (m.tables[k] - m.tables[k - 2])


@compiled
def enter_segment(m: Model, shaft: int, t: float) -> None:
    """Enter the segment that begins at a knot, if this schedule has one at this time."""
    own = m.scene.torque[shaft]
    while (
        m.state.segment[shaft] < own.knot_count and m.tables[own.knots_at + 2 * m.state.segment[shaft]] <= t
    ):
        m.state.segment[shaft] += 1
