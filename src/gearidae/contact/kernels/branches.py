"""A branch: what stretched asperities add to the force at one joined height, worked out once for all stretches."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.contact.kernels.division import position_above
from gearidae.contact.kernels.evaluate import coefficients, power8, value_and_slope
from gearidae.contact.kernels.lanes import eight_powers
from gearidae.contact.kernels.layout import (
    DEGREE,
    H_ABOVE,
    H_BEFORE,
    H_BELOW,
    H_COUNT,
    H_END,
    H_KINK,
    H_LOW,
    H_MODE,
    H_PARTIAL,
    H_PIECES,
    H_STRETCH,
    KNOTS_PER_SIGMA,
    MODE_TABLE,
)

B_SHARE: Final = 0  # 1 / D
B_PIECES: Final = 1
B_END: Final = 2  # t at full stretch
B_BEFORE: Final = 3  # the division of v, as in the header of a table,
B_KINK: Final = 4
B_BELOW: Final = 5
B_ABOVE: Final = 6
B_JOINED: Final = 7  # the joined height that it is of
B_BODY: Final = 8  # then eight powers for each piece in v


@compiled
def branch_length(table: Floats) -> int:
    """Size of the array that `set_branch` fills; 0 where a surface keeps no branches."""
    if table[H_MODE] != MODE_TABLE:
        return 0
    return B_BODY + (DEGREE + 1) * int(table[H_PIECES])


@compiled
def set_branch(table: Floats, joined: float, branch: Floats) -> None:
    """Work out t(Z, S) at one joined height for all stretches S.

    Parameters
    ----------
    table : ndarray
        From `law_table`, of a surface whose partly stretched branch is tabulated.
    joined : float
        Z, height above which asperities are joined, over roughness [1].
    branch : ndarray, shape (branch_length(table),)
        Filled in.
    """
    pieces = int(table[H_PIECES])
    position = (joined - table[H_LOW]) * KNOTS_PER_SIGMA
    j = min(max(int(position), 0), int(table[H_COUNT]) - 1)
    u = position - j
    u2 = u * u
    u4 = u2 * u2
    decay = math.exp(-0.5 * joined * joined) if joined > 0.0 else 1.0
    branch[B_SHARE], branch[B_JOINED] = 1.0 / table[H_STRETCH], joined
    branch[B_PIECES], branch[B_BEFORE], branch[B_KINK] = table[H_PIECES], table[H_BEFORE], table[H_KINK]
    branch[B_BELOW], branch[B_ABOVE] = table[H_BELOW], table[H_ABOVE]
    branch[B_END] = decay * power8(table, np.uintp(int(table[H_END]) + 8 * j), u, u2, u4)
    start = int(table[H_PARTIAL]) + 8 * (DEGREE + 1) * j * pieces
    for piece in range(pieces):
        body = B_BODY + (DEGREE + 1) * piece
        c = eight_powers(table, np.uintp(start + 8 * (DEGREE + 1) * piece), u)
        for m in range(DEGREE + 1):
            branch[body + m] = decay * c[m]


@compiled
def branch_value(branch: Floats, stretch: float) -> tuple[float, float]:
    """t(Z, S) and its slope in S on a branch, 0 <= S <= D."""
    share = branch[B_SHARE]
    v = math.sqrt(max(1.0 - stretch * share, 0.0))
    scale = branch[B_BELOW]
    position = v * scale
    if v >= branch[B_KINK]:
        position, scale = position_above(
            branch[B_BEFORE], branch[B_PIECES], branch[B_ABOVE], v - branch[B_KINK]
        )
    piece = min(int(position), int(branch[B_PIECES]) - 1)
    r = 2.0 * (position - piece) - 1.0
    f, d = value_and_slope(coefficients(branch, np.uintp(B_BODY + (DEGREE + 1) * piece)), r)
    return branch[B_END] + v * v * f, -(f + v * scale * d) * share
