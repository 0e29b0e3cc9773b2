"""Histories of an elastic contact's nodes and points: begun, followed to an accepted time, taken at a turning point."""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.history import joined_height
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.compiling import ELASTIC
from gearidae.engine.elastic.node_rows import (
    ADHERED_ENERGY,
    GAP,
    GAP_SHARE,
    JOINED,
    first_unknown,
    node_profile,
    point_gaps,
    row,
)
from gearidae.engine.model.state import MATERIALS, Floats, Model

_MOVED = 1e-5  # roughnesses; over less than this the share of a node in the motion is undefined
_LARGEST_SHARE = 4.0
"""Largest share of a node in the motion of its pair."""


@compiled_once(ELASTIC, makes_arrays=True)
def init_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """Start the histories along a contact: nothing is joined yet."""
    first, profile, before, share = first_unknown(m, k), node_profile(m), row(m, k, GAP), row(m, k, GAP_SHARE)
    for i in range(m.scene.nodes):
        before[i] = gap + profile[i] + y[first + i]
        share[i] = 1.0
    m.state.history[k].stretched = 0
    for material in range(MATERIALS):
        point_gaps(m, k, y, gap, row(m, k, JOINED + material))
        accumulate_points(m, k, material)


@compiled_once(ELASTIC, makes_arrays=True)
def follow_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """Note the nodes' gaps at an accepted time, before the pair's own, and how far they have moved with it."""
    first, profile, before, share = first_unknown(m, k), node_profile(m), row(m, k, GAP), row(m, k, GAP_SHARE)
    moved = gap - m.state.history[k].gap
    for i in range(m.scene.nodes):
        h = gap + profile[i] + y[first + i]
        if abs(moved) > _MOVED:
            share[i] = min(max((h - before[i]) / moved, 0.0), _LARGEST_SHARE)
        before[i] = h


@compiled_once(ELASTIC, makes_arrays=True)
def join_nodes(m: Model, k: int, y: Floats, gap: float) -> None:
    """Take the joined heights at a turning point."""
    points = m.scene.points
    gaps = np.empty(points)
    point_gaps(m, k, y, gap, gaps)
    m.state.history[k].stretched = 0
    for material in range(MATERIALS):
        limit, joined = m.scene.material[material].stretch_limit, row(m, k, JOINED + material)
        for i in range(points if limit > 0.0 else 0):
            joined[i] = joined_height(joined[i], gaps[i], limit)
            if gaps[i] > joined[i]:
                m.state.history[k].stretched = 1
        accumulate_points(m, k, material)


@compiled(makes_arrays=True)
def accumulate_points(m: Model, k: int, material: int) -> None:
    """Note the energy of what is joined at the points, which changes when the joined heights do."""
    joined, adhered_energy = row(m, k, JOINED + material), row(m, k, ADHERED_ENERGY + material)
    surface = m.scene.material[material]
    joining, offset = surface.joining_energy, surface.gap_offset
    for i in range(m.scene.points if joining != 0.0 else 0):
        adhered_energy[i] = -joining * loading_value(m.tables, surface.number_at, joined[i] + offset)[0]
