"""How ``v = sqrt(1 - S/D)`` is divided into pieces, over which the branch of stretched asperities is a polynomial.

Pieces are of one length, unless the load of an asperity has a kink: then one of them ends there. Below it they are of
one length. Above it, where a tip has just begun to touch, the load grows with the power 3/2 of the way, and they grow
from the kink on like 1, 3, 5, ...
"""

from __future__ import annotations

import math
from typing import NamedTuple, Self

from gearidae.arrays import Floats
from gearidae.asperities import AsperityLaw
from gearidae.compiled import compiled
from gearidae.contact.kernels.layout import H_ABOVE, H_BEFORE, H_BELOW, H_KINK, H_PIECES

_NO_KINK = 2.0  # no v is as large
_LEAST_ABOVE = 4  # pieces above a kink: one alone would be off by 1e-7 where the kink is near joining


class Division(NamedTuple):
    """Pieces of v.

    Attributes
    ----------
    pieces, before : int
        All of them, and those below the kink.
    kink : float
        The v that has one; above 1 if there is none.
    """

    pieces: int
    before: int
    kink: float

    @classmethod
    def of(cls, law: AsperityLaw, pieces: int) -> Self:
        """Divide v for a law into so many pieces, in proportion on both sides of a kink."""
        if not law.kink < 1.0:
            return cls(pieces, pieces, _NO_KINK)
        return cls(pieces, max(min(round(pieces * law.kink), pieces - _LEAST_ABOVE), 1), law.kink)

    @classmethod
    def read(cls, table: Floats) -> Self:
        """Take the division from the header of a table."""
        return cls(int(table[H_PIECES]), int(table[H_BEFORE]), float(table[H_KINK]))

    @property
    def below(self) -> float:
        """Pieces in a unit of v below the kink."""
        return self.pieces if self.before == self.pieces else self.before / self.kink

    @property
    def above(self) -> float:
        """Square of the number of pieces above it over their length in v: one over the first piece's length."""
        return 0.0 if self.before == self.pieces else (self.pieces - self.before) ** 2 / (1.0 - self.kink)

    def scale(self, piece: int) -> float:
        """One over the length of a piece."""
        return self.below if piece < self.before else self.above / (2 * (piece - self.before) + 1)

    def at(self, piece: int, part: Floats | float) -> Floats | float:
        """Return v in a piece, where a part of it, 0 to 1, lies below."""
        if piece < self.before:
            return (piece + part) / self.below
        j = piece - self.before
        return self.kink + (j * j + (2 * j + 1) * part) / self.above

    def write(self, header: Floats) -> None:
        """Put the division into the header of a table."""
        header[[H_PIECES, H_BEFORE, H_KINK]] = self.pieces, self.before, self.kink
        header[[H_BELOW, H_ABOVE]] = self.below, self.above


@compiled(inline=True)
def position_of(table: Floats, v: float) -> tuple[float, float]:
    """Position of v among the pieces of a table, whose whole part is the piece, and one over the length of that."""
    if v < table[H_KINK]:
        return v * table[H_BELOW], table[H_BELOW]
    return position_above(table[H_BEFORE], table[H_PIECES], table[H_ABOVE], v - table[H_KINK])


@compiled
def position_above(before: float, pieces: float, above: float, beyond: float) -> tuple[float, float]:
    """Position of a v among the pieces above the kink, given its distance from it, and one over its piece's length."""
    x = beyond * above
    j = min(math.floor(math.sqrt(x)), pieces - before - 1.0)
    length = 2.0 * j + 1.0
    return before + j + (x - j * j) / length, above / length
