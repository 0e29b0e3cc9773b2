r"""One asperity's load, its slope and its energy, tabulated from any asperity law and compiled.

In ``w = sqrt(displacement - start)`` a load is smooth from the displacement on at which its stable branch starts, in a
fold or a touch; where there is a kink on the way it starts anew. Over :math:`(1 + w)^3`, the energy over
:math:`(1 + w)^5`, it is a polynomial of degree seven in each of the pieces into which :math:`\log(1 + w/b)` is divided,
or w itself below a kink. The first pieces are short, as a touch may lie just beyond the fold. Tests bound the error by
1e-10 of the larger of load and pull-off, whatever the law.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.compiled import compiled
from gearidae.contact.kernels.evaluate import coefficients, power8, value_and_slope
from gearidae.contact.kernels.layout import DEGREE

A_FOLD: Final = 0  # displacement at detachment,
A_START: Final = 1  # and where the pieces in log(1 + w/b) begin: there, or at a kink
A_BELOW: Final = 2  # pieces below the kink, and in a unit of w there
A_SCALE: Final = 3
A_COUNT: Final = 4  # pieces above it
A_HEADER: Final = 5  # then powers of all pieces of the load, and of the energy

PER_UNIT: Final = 12.0
"""Pieces in a unit of log(1 + w/b)."""
NEAR: Final = 0.02  # b
BELOW: Final = 12
"""Pieces below a kink."""


def asperity_table(law: AsperityLaw, highest: float) -> Floats:
    """Tabulate a law of one asperity.

    Parameters
    ----------
    law : AsperityLaw
        In units of a length that adhesion or roughness sets.
    highest : float
        Largest displacement, in the law's unit; beyond it the load goes on with the power 3/2.

    Returns
    -------
    ndarray
        For `asperity_value` and `asperity_energy`, which count the energy from free surfaces.
    """
    fold = -law.detach
    start = law.touch
    below = BELOW if start > fold else 0
    widest = math.sqrt(start - fold)
    scale = below / widest if below else 0.0
    count = math.ceil(PER_UNIT * math.log1p(math.sqrt(max(highest - start, 1.0)) / NEAR))
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_powers = np.linalg.inv(np.vander(nodes, increasing=True))
    parts = 0.5 * (nodes + 1.0)
    w_below = (np.arange(below)[:, None] + parts) / scale if below else np.empty((0, nodes.size))
    w_above = NEAR * np.expm1((np.arange(count)[:, None] + parts) / PER_UNIT)
    w = np.concatenate([w_below, w_above])
    displacement = np.concatenate([fold + w_below**2, start + w_above**2])
    load = law.load(displacement) / (1.0 + w) ** 3
    energy = (law.detachment_energy + law.energy(displacement)) / (1.0 + w) ** 5
    header = [fold, start, below, scale, count]
    return np.concatenate([header, (load @ to_powers.T).ravel(), (energy @ to_powers.T).ravel()])


@compiled(inline=True)
def _piece(table: Floats, at: int, displacement: float) -> tuple[float, int, float, float]:
    """Return w, the piece that it lies in, its position there, -1..1, and the rate of that with w."""
    above = displacement - table[at + A_START]
    below = int(table[at + A_BELOW])
    if above >= 0.0 or below == 0:
        w = math.sqrt(max(above, 0.0))
        position = PER_UNIT * math.log1p(w / NEAR)
        count = int(table[at + A_COUNT])
        if position >= count:
            return w, below + count - 1, 1.0, 0.0
        j = int(position)
        return w, below + j, 2.0 * (position - j) - 1.0, 2.0 * PER_UNIT / (NEAR + w)
    w = math.sqrt(max(displacement - table[at + A_FOLD], 0.0))
    position = w * table[at + A_SCALE]
    j = min(int(position), below - 1)
    return w, j, 2.0 * (position - j) - 1.0, 2.0 * table[at + A_SCALE]


@compiled(inline=True)
def asperity_value(table: Floats, at: int, displacement: float) -> tuple[float, float]:
    """Load of an asperity in contact and its slope; below detachment the load at the end of the branch, and no slope.

    Parameters
    ----------
    at : int
        Where the law's table begins in it, from `asperity_table`.
    displacement : float
        In the law's unit.
    """
    w, piece, r, rate = _piece(table, at, displacement)
    f, d = value_and_slope(coefficients(table, np.uintp(at + A_HEADER + (DEGREE + 1) * piece)), r)
    square = (1.0 + w) * (1.0 + w)
    load = square * (1.0 + w) * f
    if displacement <= table[at + A_FOLD] or w == 0.0:
        return load, 0.0
    return load, square * (3.0 * f + (1.0 + w) * rate * d) / (2.0 * w)


@compiled(inline=True)
def asperity_energy(table: Floats, at: int, displacement: float) -> float:
    """Energy that an asperity in contact stores, counted from free surfaces; parameters as for `asperity_value`."""
    w, piece, r, _ = _piece(table, at, displacement)
    pieces = int(table[at + A_BELOW] + table[at + A_COUNT])
    first, r2 = at + A_HEADER + (DEGREE + 1) * (pieces + piece), r * r
    f = power8(table, np.uintp(first), r, r2, r2 * r2)
    square = (1.0 + w) * (1.0 + w)
    return square * square * (1.0 + w) * f
