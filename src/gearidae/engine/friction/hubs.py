r"""Load of the hubs: the modulus of the vector sum of the mesh forces, on which the hubs' own friction depends.

Along and across the line of action of the drive flank the mesh forces add up to a vector that is linear in every
friction. Where a friction is not known beforehand, because its pair is held or hubs and pairs hold the train together,
it is linear in the load :math:`N` itself, so that :math:`N = |\mathbf u + N \mathbf v|`: a quadratic equation.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model

_TINY = 1e-300
_ROUNDING = 1e-12


class Mesh(NamedTuple):
    """Sums of the pairs' forces along the line of action and of their friction, of the drive and the coast flank."""

    drive: float
    coast: float
    drive_friction: float
    coast_friction: float


@compiled(inline=True)
def across(m: Model, coast: bool) -> tuple[float, float]:
    """Direction of the friction of a flank: components along and across the line of action of the drive flank."""
    if coast:
        return m.scene.friction.sine, -m.scene.friction.cosine
    return 0.0, 1.0


@compiled(inline=True)
def vector_sum(m: Model, mesh: Mesh) -> tuple[float, float]:
    """Components of the mesh forces along and across the line of action of the drive flank."""
    own = m.scene.friction
    along = mesh.drive - own.cosine * mesh.coast + own.sine * mesh.coast_friction
    return along, mesh.drive_friction - own.cosine * mesh.coast_friction - own.sine * mesh.coast


@compiled(inline=True)
def turning_load(m: Model, mesh: Mesh) -> tuple[float, float]:
    """Modulus of the vector sum, and the force along the line of action of the flank that has more of it.

    Where forces turn round together, the sum keeps to a line through zero and the modulus has a corner there: it goes
    on below zero, from the direction ``load_sign`` on. Where they turn round one by one, the sum passes beside zero.
    """
    own = m.scene.friction
    along, over = vector_sum(m, mesh)
    load = math.hypot(along, over)
    if abs(mesh.coast) > abs(mesh.drive):
        along, over = -own.cosine * along - own.sine * over, own.sine * along - own.cosine * over
    if m.state.load_sign * along < 0.0 and abs(over) <= (2.0 * own.even + _ROUNDING) * abs(along):
        load = -load
    return load, along


class Loads(NamedTuple):
    """Loads N that solve ``N = |u + N v|``.

    Attributes
    ----------
    near, far : float
        The smaller and the larger one; equal where there is only one.
    room : float
        Below zero if there is none; the load then is the one nearest to a solution. Infinite where there always is one.
    """

    near: float
    far: float
    room: float


@compiled(inline=True)
def consistent_loads(u: tuple[float, float], v: tuple[float, float]) -> Loads:
    """Solve ``N = |u + N v|``: one solution if v is shorter than 1, else two or none."""
    square = v[0] * v[0] + v[1] * v[1] - 1.0
    half = u[0] * v[0] + u[1] * v[1]
    whole = u[0] * u[0] + u[1] * u[1]
    root = math.sqrt(max(half * half - square * whole, 0.0))
    if square <= 0.0:
        near = whole / max(root - half, _TINY) if half <= 0.0 else (half + root) / max(-square, _TINY)
        return Loads(near, near, math.inf)
    near, far = whole / max(root + abs(half), _TINY), (root + abs(half)) / square
    return Loads(near, far, -half - math.sqrt(square * whole))
