"""Collecting the arrays of variable length that a model reads, with the index of each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearidae.engine.model.state import Floats


class Tables:
    """One flat array in the making.

    Attributes
    ----------
    size : int
        How many numbers have been added.
    """

    def __init__(self) -> None:
        self._parts: list[Floats] = []
        self.size = 0

    def add(self, numbers: Floats | Sequence[float]) -> int:
        """Append numbers, and return the index at which they begin."""
        part, start = np.asarray(numbers, np.float64), self.size
        self._parts.append(part)
        self.size += part.size
        return start

    def whole(self) -> Floats:
        """Return all that has been added."""
        return np.concatenate([np.zeros(0), *self._parts])
