"""Layout of a force law's table: a flat array that compiled code can carry about.

A header of `HEADER` numbers, then the loading branch, and for laws with hysteresis the fully stretched branch and
either the partly stretched one (`MODE_TABLE`) or the data to integrate it on demand (`MODE_INTEGRATED`): the
density of heights and the load of one asperity. Lengths are in roughnesses.
"""

from __future__ import annotations

from typing import Final, Literal, TypeAlias

from gearidae.asperities.ranges import GAP_HIGH, GAP_LOW, STRETCH_HIGH

__all__ = [
    "ASPERITY_PIECES",
    "DEGREE",
    "GAP_HIGH",
    "GAP_LOW",
    "HEADER",
    "H_ABOVE",
    "H_BEFORE",
    "H_BELOW",
    "H_COUNT",
    "H_END",
    "H_KINK",
    "H_LOW",
    "H_MODE",
    "H_PARTIAL",
    "H_PIECES",
    "H_PSI",
    "H_STRETCH",
    "KNOTS_PER_SIGMA",
    "MODE_INTEGRATED",
    "MODE_TABLE",
    "N_LOADING",
    "STRETCH_HIGH",
    "Kernel",
]

Kernel: TypeAlias = Literal["line", "plane"]
"""Force on a parabolic gap, or pressure between planes: loads are integrated against psi or the normal density."""

KNOTS_PER_SIGMA: Final = 8
DEGREE: Final = 7  # of all pieces
ASPERITY_PIECES: Final = 32  # of one asperity's load, where the partly stretched branch is integrated

H_STRETCH: Final = 0  # stretch limit D = detach - join; 0 where the surface has no stretch worth a branch
H_MODE: Final = 1
H_LOW: Final = 2  # first knot in joined height, and number of pieces from there
H_COUNT: Final = 3
H_END: Final = 4  # offset of t(Z, D)
H_PARTIAL: Final = (
    5  # offset of t(Z, S), and its number of pieces in v; or of one asperity's load and of its pieces
)
H_PIECES: Final = 6
H_PSI: Final = 7  # offset of psi, with its own first knot in front
H_BEFORE: Final = 8  # pieces below the kink of one asperity's load, and its v,
H_KINK: Final = 9
H_BELOW: Final = 10  # and how many pieces there are in a unit of v below it, and above
H_ABOVE: Final = 11
HEADER: Final = 12  # the loading branch follows at once

# Modes of the partly stretched branch; 0 where loading and unloading agree.
MODE_TABLE: Final = 1
MODE_INTEGRATED: Final = 2
N_LOADING: Final = round((GAP_HIGH - GAP_LOW) * KNOTS_PER_SIGMA)
