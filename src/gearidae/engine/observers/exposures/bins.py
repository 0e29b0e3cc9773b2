"""Bins along the path of contact, `place` in a dataset, into which the exposures of a tooth are divided."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.model.state import MATERIALS, Floats, Model
from gearidae.records import ExposureRows

ROWS: Final = ExposureRows.of(MATERIALS)
"""Of the exposures of a tooth, each over all bins."""


def exposures_of(m: Model) -> Floats:
    """Return the exposures of the flanks among a model's rows; writable."""
    return m.rows[m.scene.exposures_at : m.scene.exposures_at + m.scene.exposures]


def exposure_table(m: Model) -> Floats:
    """Return them by tooth of both flanks, quantity and bin; writable."""
    return exposures_of(m).reshape(-1, int(m.scene.exposure_rows), int(m.scene.bins))


@compiled(inline=True)
def bin_at(m: Model, inside: float) -> int:
    """Bin of a position along the path of contact, whose end belongs to the last one."""
    return min(int(m.scene.bins_per_pitch * inside), m.scene.bins - 1)


@compiled
def row_of(m: Model, flank: int, pair: int) -> int:
    """Where the exposures of the pinion's tooth of a pair begin among the rows."""
    teeth = int(m.scene.pinion_teeth)
    tooth = (pair + int(m.state.whole_pitches)) % teeth
    return m.scene.exposures_at + (flank * teeth + tooth) * m.scene.exposure_rows * m.scene.bins


@compiled(inline=True)
def share_at_edge(m: Model, here: int, start: float, end: float) -> float:
    """Share of the way from one point of the path to another at which a contact leaves a bin, given by its index."""
    edge = (here + 1 if end > start else here) / m.scene.bins_per_pitch
    return (edge - start) / (end - start)


@compiled(inline=True)
def way_to_edge(m: Model, k: int, inside: float, phase_speed: float) -> float:
    """Way to the end of the bin that a pair is in, in bins; infinite where the path of contact ends there.

    Parameters
    ----------
    k : int
        Index of the pair's history, whose pressure has been looked at there.
    inside : float
        Position on the path of contact, in pitches.
    phase_speed : float
        Direction in which the phase goes, by its sign.
    """
    edge = m.work.exposing.pair[k].seen_bin
    if (phase_speed > 0.0) == (k < m.scene.slots):
        edge += 1
    if edge == 0 or edge == m.scene.bins:
        return math.inf
    return abs(edge - m.scene.bins_per_pitch * inside)
