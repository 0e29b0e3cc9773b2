"""The samples of all runs of a sweep in the arrays of the dataset, filled as the runs end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearidae.records import Solution

_NO_TIMES = np.empty(0)
"""Shared by all runs."""


class SampleTable:
    """Samples of runs that share one time axis, each kept once.

    Parameters
    ----------
    names : sequence of str
        Sampled columns to keep.
    runs : int
        Number of runs.
    samples : int
        Samples of a run that reaches its end.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Times that the longest run has reached [s].
    """

    def __init__(self, names: Sequence[str], runs: int, samples: int) -> None:
        # pages of memory are taken up by the runs that fill them, not here
        self._columns = {name: np.empty((runs, samples)) for name in names}
        self._reached = np.zeros(runs, dtype=np.int64)
        self.time: NDArray[np.float64] = np.empty(0)

    def take(self, number: int, solution: Solution) -> Solution:
        """Take over the samples of run `number`; return the run without them."""
        self._reached[number] = len(solution.time)
        for name, table in self._columns.items():
            values = solution.samples.get(name)
            if values is not None:
                table[number, : len(values)] = values
        if len(solution.time) > len(self.time):
            self.time = solution.time
        reached = solution.reached
        if reached is None and len(solution.time):
            reached = float(solution.time[-1])
        return replace(solution, time=_NO_TIMES, samples={}, reached=reached)

    def columns(self) -> dict[str, NDArray[np.float64]]:
        """Return the tables, shape (runs, len(time)); NaN where a run did not get to."""
        length = len(self.time)
        for table in self._columns.values():
            for row, reached in zip(table, self._reached, strict=True):
                row[reached:] = np.nan
        if all(table.shape[1] == length for table in self._columns.values()):
            return self._columns
        return {name: np.ascontiguousarray(table[:, :length]) for name, table in self._columns.items()}
