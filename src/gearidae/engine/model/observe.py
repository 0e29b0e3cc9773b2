"""From scaled states to what is recorded, in SI units: the columns of `gearidae.records`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.model import layout as at
from gearidae.engine.model.residual import mesh_forces, roller_force
from gearidae.engine.model.tooth_pairs import first_pair, last_pair, pair_gap, static_error

__all__ = ["observe"]

Floats = NDArray[np.float64]


@compiled
def observe(d: Floats, t: float, y: Floats, row: Floats) -> None:
    """Write one sample.

    Parameters
    ----------
    d : ndarray
        The scene with the histories as they are at t, see `layout`.
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        Scaled state.
    row : ndarray, shape (9,) or (3,)
        `GEAR_COLUMNS` or `ROLLER_COLUMNS` in SI units.
    """
    length, speed = d[at.SIGMA], d[at.SIGMA] / d[at.TAU]
    u, v = y[at.U], y[at.V]
    if d[at.KIND] == at.ROLLER:
        force, _ = roller_force(d, t, y)
        row[0], row[1], row[2] = u * length, v * speed, force * d[at.FORCE]
        return
    phase, w = y[at.PHASE], y[at.W]
    force, relief, _, _, _, _ = mesh_forces(d, t, y)
    e1 = 0.0
    if d[at.ERROR_ORDERS] != 0.0:
        _, _, e1, _ = static_error(d, u, phase)
    radius = d[at.GEAR_RADIUS]
    row[0] = w * speed / radius
    row[1] = (v + w) * speed / (d[at.PINION_RADIUS] * (1.0 - e1))
    row[2] = (d[at.TURNS] + phase) * d[at.BASE_PITCH] / radius
    row[3] = u * length
    row[4] = force * d[at.FORCE]
    row[5] = radius * (force + relief) * d[at.FORCE]
    touching = 0.0
    for coast in range(2):
        smallest = math.inf
        for pair in range(first_pair(d, coast, phase), last_pair(d, coast, phase) + 1):
            gap, _, _, _ = pair_gap(d, coast, pair, u, v, phase, w)
            smallest = min(smallest, gap)
            if gap < d[at.ENGAGE]:
                touching += 1.0
        row[6 + coast] = smallest * length
    row[8] = touching
