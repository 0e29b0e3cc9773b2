"""What the flanks have been exposed to: the sums of a tooth of one flank, rows of a table over the bins, by name."""

from __future__ import annotations

from typing import NamedTuple, Self


class ExposureRows(NamedTuple):
    """Which row is what.

    Attributes
    ----------
    contacts, adhesion : int
        First of the rows of asperities that have come into contact, and of the energy that they have lost by it; there
        is one for each material.
    sliding, pressure : int
        Row of the sliding work, and of the largest pressure.
    friction : int
        Row of the work of friction, the last one; only where flanks have friction.
    """

    contacts: int
    adhesion: int
    sliding: int
    pressure: int
    friction: int

    @classmethod
    def of(cls, materials: int) -> Self:
        """Rows where so many materials may share the interface."""
        return cls(0, materials, 2 * materials, 2 * materials + 1, 2 * materials + 2)

    def per_tooth(self, *, rubs: bool) -> int:
        """Rows of a tooth whose flanks have friction, or have none."""
        return self.friction + int(rubs)
