"""Limit of the friction of an elastic contact whose materials have different coefficients."""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled_once
from gearidae.engine.compiling import ELASTIC
from gearidae.engine.elastic.node_rows import (
    first_unknown,
    node_profile,
    node_weights,
    point_weights,
    to_points,
)
from gearidae.engine.elastic.nodes import add_stretched, is_stretched
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.coverage import limit_of_loading, noted_shares
from gearidae.engine.pairs.tooth_pairs import PairState


@compiled_once(ELASTIC, makes_arrays=True)
def limit_of_nodes(
    m: Model, t: float, y: Floats, pair: PairState, length: float, follow: Floats
) -> tuple[float, float]:
    """Limit of one pair at given deflections and its slope in the pair's gap, scaled.

    Each node and each stretched point counts with the coefficients of its materials; see
    `gearidae.engine.elastic.nodes.force_of_nodes`.

    Parameters
    ----------
    follow : ndarray, shape (nodes,)
        Slopes of the deflections in the pair's gap.
    """
    k, gap = pair.k, pair.gap
    first, shares, friction = first_unknown(m, k), noted_shares(m, k), m.scene.friction
    profile, weights, finer = node_profile(m), node_weights(m), point_weights(m)
    limit = slope = 0.0
    for i in range(m.scene.nodes):
        value, by_gap = limit_of_loading(m, gap + profile[i] + y[first + i], shares)
        limit += weights[i] * value
        slope += weights[i] * by_gap * (1.0 + follow[i])
    if pair.known and is_stretched(m, k, pair.rate):
        added, stiff, moved = np.zeros(m.scene.points), np.zeros(m.scene.points), np.zeros(m.scene.points)
        scales = friction.scale[0] * shares[0], friction.scale[1] * shares[1], friction.scale[2] * shares[2]
        add_stretched(m, k, t, y, (gap, pair.rate), scales, (added, stiff))
        to_points(m, follow, moved)
        for i in range(m.scene.points):
            limit += finer[i] * added[i]
            slope += finer[i] * stiff[i] * (1.0 + moved[i])
    return limit * length, slope * length
