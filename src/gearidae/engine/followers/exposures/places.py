"""Places along the path of contact, into which the exposures of a tooth are divided."""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model

__all__ = ["place_at", "share_at_edge", "way_to_edge"]


@compiled(inline=True)
def place_at(m: Model, inside: float) -> int:
    """Index of the place along the path of contact, whose end belongs to the last one."""
    return min(int(m.scene.places_per_pitch * inside), m.scene.places - 1)


@compiled(inline=True)
def share_at_edge(m: Model, at: int, start: float, end: float) -> float:
    """Share of the way from one point of the path to another at which a contact leaves a place, given by its index."""
    edge = (at + 1 if end > start else at) / m.scene.places_per_pitch
    return (edge - start) / (end - start)


@compiled(inline=True)
def way_to_edge(m: Model, k: int, inside: float, turn: float) -> float:
    """Way to the end of the place that a pair is in, in places; infinite where the path of contact ends there.

    Parameters
    ----------
    m : Model
    k : int
        Index of the pair's history, whose pressure has been looked at there.
    inside : float
        Place on the path of contact, in pitches.
    turn : float
        Direction in which the phase goes, by its sign.
    """
    edge = m.work.exposing.pair[k].seen_at
    if (turn > 0.0) == (k < m.scene.slots):
        edge += 1
    if edge == 0 or edge == m.scene.places:
        return math.inf
    return abs(edge - m.scene.places_per_pitch * inside)
